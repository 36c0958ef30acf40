"""How long the command takes to start: a whole process, from the first time and from later ones."""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROUNDS = 7
_STUDY = Path(__file__).parents[1] / "config" / "paper.yaml"


def seconds() -> dict[str, float]:
    """Return the seconds of `gearmesh simulate` for one case: compiling, and compiled."""
    with tempfile.TemporaryDirectory(prefix="start-") as folder:
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(Path(folder) / "compiled")}
        command = [sys.executable, "-m", "gearmesh", "simulate", "--config", str(_STUDY)]
        command += ["--variant", "c-lubricant", "--nu", "0.66", "-o", str(Path(folder) / "case.nc")]
        spent = []
        for _ in range(1 + ROUNDS):
            start = time.perf_counter()
            subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
            spent.append(time.perf_counter() - start)
    return {"first": spent[0], "later": statistics.median(spent[1:])}
