"""Errors and times of the solvers on the runs of `benchmarks.cases`."""

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.outcome import deviation
from benchmarks.peers import Solve
from benchmarks.reference import Reference
from gearmesh.model.problem import Problem

AIM = 1e-9
"""Error, in static deflections, at which solvers are compared."""
SHARE = 0.95
"""Share of the runs that have to be within it."""
SPARSE = slice(8, None, 16)
"""Frequencies of a sweep on which slow solvers are measured."""


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Errors of a solver over all runs that are not sensitive, in static deflections."""

    median: float
    most: float
    largest: float
    extrema_differ: int

    @property
    def reaches_aim(self) -> bool:
        """Whether enough runs are within the error aimed at."""
        return self.most <= AIM


def sparse(of_variants: dict[str, list]) -> dict[str, list]:
    """Thin sweeps, or lists that go with them, for slow solvers."""
    return {name: values[SPARSE] for name, values in of_variants.items()}


def measured(
    solve: Solve,
    setting: float,
    sweeps: dict[str, list[Problem]],
    references: dict[str, list[Reference]],
) -> tuple[Accuracy, float]:
    """Compare the runs of `sweeps` with their references; return also the CPU time of a run."""
    errors, extrema_differ, spent = [], 0, 0.0
    for name, problems in sweeps.items():
        start = time.process_time()
        outcomes = solve(problems, setting)
        spent += time.process_time() - start
        for outcome, reference in zip(outcomes, references[name], strict=True):
            if not reference.sensitive:
                apart = deviation(outcome, reference.outcome)
                errors.append(apart.error)
                extrema_differ += not apart.extrema_agree
    median, most, largest = np.quantile(errors, (0.5, SHARE, 1.0), method="higher")
    found = Accuracy(float(median), float(most), float(largest), extrema_differ)
    return found, spent / sum(map(len, sweeps.values()))


def seconds(solve: Solve, setting: float, calls: Sequence[Sequence[Problem]]) -> float:
    """CPU time of a run, averaged over all calls, whose outcomes are dropped one by one.

    CPU time, not time on the clock: what else the machine does then disturbs least.
    """
    start = time.process_time()
    for problems in calls:
        solve(problems, setting)
    return (time.process_time() - start) / sum(map(len, calls))


@dataclass(slots=True)
class Contest:
    """Solvers that are timed in turns, so that a slow minute of the machine meets all of them."""

    entries: dict[str, tuple[Solve, float, list[list[Problem]]]]
    """By name: solver, setting and the lists of runs that it is called with."""

    def medians(self, rounds: int) -> dict[str, float]:
        """Return the median over `rounds` of the seconds a run; all is compiled already."""
        found: dict[str, list[float]] = {name: [] for name in self.entries}
        for _ in range(rounds):
            for name, entry in self.entries.items():
                found[name].append(seconds(*entry))
        return {name: statistics.median(spent) for name, spent in found.items()}
