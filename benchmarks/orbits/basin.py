"""Basins of b-both at nu_s = 0.75, where two orbits are stable, by all methods."""

import time
from dataclasses import dataclass, replace

import numpy as np
from gearmesh.dynamics.attractors import Basins, basins

import gearmesh as gm
from benchmarks.orbits import settling
from gearmesh.model.problem import Problem
from gearmesh.model.variants import variant

VARIANT, NU, SIDE = "b-both", 0.75, 512
HEIGHTS, RATES = np.linspace(-3.0, 4.0, SIDE), np.linspace(-2.5, 2.5, SIDE)
N_HEYOKA, N_SCIPY = 512, 2
"""Starts of the slow methods, drawn at random from the grid."""


@dataclass(frozen=True, slots=True)
class Found:
    """What one method found in one round.

    Attributes
    ----------
    seconds : float
        CPU time of a start.
    starts, differ : int
        Number of starts, and of those that reach another attractor than with `gearmesh`.
    """

    seconds: float
    starts: int
    differ: int


def problem() -> Problem:
    """Return the problem; its initial state does not matter."""
    return gm.paper().problem(variant(VARIANT), NU)


def ours() -> tuple[Found, Basins]:
    """Find all basins."""
    start = time.process_time()
    found = basins(problem(), HEIGHTS, RATES)
    spent = time.process_time() - start
    return Found(spent / SIDE**2, SIDE**2, 0), found


def with_heyoka(known: Basins, seed: int) -> Found:
    """Follow a part of the starts in batches."""
    case, (states, labels), points = problem(), _drawn(known, seed, N_HEYOKA), _points(known)

    def arrived(_, after):
        return settling.nearest(after, points)[1] < settling.NEAR

    start = time.process_time()
    cases = [replace(case)] * len(states)
    ends = settling.in_batches(cases, states, settling.TOLERANCE, arrived)
    spent = time.process_time() - start
    return _compared(spent, ends, labels, points)


def with_scipy(known: Basins, seed: int) -> Found:
    """Follow a few starts one by one."""
    (states, labels), points = _drawn(known, seed, N_SCIPY), _points(known)
    start = time.process_time()
    ends = settling.one_by_one(problem(), states, points)
    spent = time.process_time() - start
    return _compared(spent, ends, labels, points)


def _points(known: Basins) -> list[np.ndarray]:
    return [attractor.orbit.state for attractor in known.attractors]


def _drawn(known: Basins, seed: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return states and labels of starts drawn from the grid."""
    drawn = np.random.default_rng(seed).choice(SIDE**2, count, replace=False)
    i, j = np.unravel_index(drawn, (SIDE, SIDE))
    rest = -2.0 / problem().bearing_stiffness
    fixed = np.full(count, rest), np.zeros(count)
    return np.column_stack([HEIGHTS[i], RATES[j], *fixed]), known.labels[0, i, j]


def _compared(spent: float, ends: np.ndarray, labels: np.ndarray, points) -> Found:
    reached, away = settling.nearest(ends, points)
    differ = (reached != labels) | (away > settling.NEAR)
    return Found(spent / len(ends), len(ends), int(differ.sum()))


METHODS = {
    "heyoka in batches, until near an orbit": with_heyoka,
    "SciPy DOP853, until near an orbit": with_scipy,
}
