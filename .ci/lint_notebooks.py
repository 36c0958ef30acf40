"""Check that the notebooks are committed without outputs; exits 1 and names those that are not."""

import json
import sys
from pathlib import Path


def has_outputs(path: Path) -> bool:
    """Return whether any code cell of a notebook keeps an output or a count."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    return any(cell["outputs"] or cell["execution_count"] for cell in code)


if __name__ == "__main__":
    notebooks = sorted(Path("notebooks").glob("*.ipynb"))
    kept = [str(path) for path in notebooks if has_outputs(path)]
    print("\n".join(f"{name}: has outputs" for name in kept) or "notebooks: no outputs")
    sys.exit(bool(kept))
