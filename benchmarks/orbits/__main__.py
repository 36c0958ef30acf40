"""`python -m benchmarks.orbits`: orbits and basins by all methods, and the tables."""

import json
import statistics
import sys
from collections import defaultdict
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from pathlib import Path

from benchmarks import machine  # first, as it limits the threads
from benchmarks.orbits import basin, branch, grid, table

ROUNDS = 5
SLOW_ROUNDS = 2
"""Of the methods that need minutes; they take their turns in the first rounds."""
SLOW = ("SciPy", "heyoka in batches, brute force")

RESULTS = Path(__file__).parent / "results.json"


def main() -> int:
    """Measure all methods in turns, so that a slow minute of the machine meets all."""
    machine.keep_one_core()
    study, atlas = (grid.frequencies(name) for name in (grid.STUDY, grid.ATLAS))
    results = {
        "machine": machine.described(),
        "branch": _measured(branch.ours, branch.METHODS),
        "study": _measured(partial(branch.ours, study), branch.METHODS),
        "atlas": _measured(partial(branch.ours, atlas), branch.METHODS),
        "basin": _measured(basin.ours, basin.METHODS),
    }
    RESULTS.write_text(json.dumps(results, indent=1, ensure_ascii=False) + "\n")
    print(table.render(results))
    return 0


def _measured(ours: Callable, methods: dict[str, Callable]) -> dict[str, dict]:
    """Return the summary of each method; the others get what ours has found in their round."""
    found = defaultdict(list)
    for turn in range(ROUNDS + 1):
        mine, known = ours()
        found[table.OURS].append(mine)
        for name, method in methods.items():
            if turn <= SLOW_ROUNDS or not name.startswith(SLOW):
                found[name].append(method(known))
    return {name: _summary(rounds) for name, rounds in found.items()}


def _summary(found: list) -> dict:
    """Return the median time and the worst agreement; the first round compiles and is left out."""
    rounds = [asdict(one) for one in found[1:]]
    worst = {
        name: None if value is None else max(one[name] for one in rounds)
        for name, value in rounds[0].items()
    }
    return worst | {"seconds": statistics.median(one["seconds"] for one in rounds)}


if __name__ == "__main__":
    sys.exit(main())
