"""`python -m benchmarks.orbits`: orbits and basins by all methods, and the table."""

import json
import statistics
import sys
from collections import defaultdict
from dataclasses import asdict
from pathlib import Path

from benchmarks import machine  # first, as it limits the threads
from benchmarks.orbits import basin, branch, table

ROUNDS = 5
SLOW_ROUNDS = 2
"""Of the methods that need minutes; they take their turns in the first rounds."""
SLOW = ("SciPy",)

RESULTS = Path(__file__).parent / "results.json"


def main() -> int:
    """Measure all methods in turns, so that a slow minute of the machine meets all."""
    machine.keep_one_core()
    curves, regions = defaultdict(list), defaultdict(list)
    for turn in range(ROUNDS + 1):
        found, known = branch.ours()
        curves[table.OURS].append(found)
        for name, method in _in_turn(branch.METHODS, turn):
            curves[name].append(method(known))
    for turn in range(ROUNDS + 1):
        found, known = basin.ours()
        regions[table.OURS].append(found)
        for name, method in _in_turn(basin.METHODS, turn):
            regions[name].append(method(known, turn))
    results = {
        "machine": machine.described(),
        "branch": {name: _summary(found) for name, found in curves.items()},
        "basin": {name: _summary(found) for name, found in regions.items()},
    }
    RESULTS.write_text(json.dumps(results, indent=1, ensure_ascii=False) + "\n")
    print(table.render(results))
    return 0


def _in_turn(methods, turn: int):
    return [
        (name, method)
        for name, method in methods.items()
        if turn <= SLOW_ROUNDS or not name.startswith(SLOW)
    ]


def _summary(found: list) -> dict:
    """Return the median time and the worst agreement; the first round compiles and is left out."""
    rounds = [asdict(one) for one in found[1:]]
    worst = {name: max(one[name] for one in rounds) for name in rounds[0]}
    return worst | {"seconds": statistics.median(one["seconds"] for one in rounds)}


if __name__ == "__main__":
    sys.exit(main())
