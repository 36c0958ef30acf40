"""Basins of b-both at nu_s = 0.75, where two orbits are stable, by all methods."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import gearmesh as gm
from benchmarks.orbits import settling
from gearmesh.dynamics.attraction.basins import Basins, basins
from gearmesh.dynamics.attraction.maps import map_of
from gearmesh.dynamics.attraction.regions import region_of
from gearmesh.dynamics.starts import initial_states
from gearmesh.model.problem import Problem
from gearmesh.model.variants import variant

VARIANT, NU, SIDE = "b-both", 0.75, 512
HEIGHTS, RATES = np.linspace(-3.0, 4.0, SIDE), np.linspace(-2.5, 2.5, SIDE)
N_HEYOKA, N_SCIPY = 512, 4
"""Number of starts of the slow methods. Each round draws new ones from the grid, at random."""
_RANDOM = np.random.default_rng(0)

NEAR = 1e-3
"""Distance from an orbit, in y_st, at which a run counts as arrived."""

Reached = Callable[[np.ndarray], np.ndarray]
"""From states, shape (n, 4), to the orbits that they are known to reach, -1 if not known yet."""


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


def ours() -> tuple[Found, Basins]:
    """Find all basins; the time counts the search for the orbits too."""
    start = time.process_time()
    found = basins(_problem(), HEIGHTS, RATES)
    spent = time.process_time() - start
    return Found(spent / SIDE**2, SIDE**2, 0), found


def with_heyoka(known: Basins) -> Found:
    """Follow a part of the starts in batches until they are near an orbit."""
    return _followed(settling.in_batches, N_HEYOKA, known, _near(known))


def with_heyoka_and_regions(known: Basins) -> Found:
    """Follow them until they are in the trapping regions that `gearmesh` uses."""
    return _followed(settling.in_batches, N_HEYOKA, known, _in_regions(known))


def with_scipy(known: Basins) -> Found:
    """Follow a few starts one by one until they are near an orbit."""
    return _followed(settling.one_by_one, N_SCIPY, known, _near(known))


def _followed(follow, count: int, known: Basins, reached: Reached) -> Found:
    drawn = _RANDOM.choice(SIDE**2, count, replace=False)
    states = initial_states(_problem(), HEIGHTS, RATES)[drawn]
    problems = [_problem()] * count
    start = time.process_time()
    ends = follow(problems, states, settling.TOLERANCE, lambda _, after: reached(after) >= 0)
    spent = time.process_time() - start
    differ = reached(ends) != known.labels.ravel()[drawn]
    return Found(spent / count, count, int(differ.sum()))


def _near(known: Basins) -> Reached:
    """Return the function that tells which orbit states are near."""
    points = [attractor.orbit.state for attractor in known.attractors]

    def reached(states: np.ndarray) -> np.ndarray:
        away = np.array([np.abs(states - point).max(axis=1) for point in points])
        return np.where(away.min(axis=0) < NEAR, away.argmin(axis=0), -1)

    return reached


def _in_regions(known: Basins) -> Reached:
    """Return the function that tells in which orbit's trapping region states are."""
    moved = map_of(_problem())
    regions = [region_of(moved, attractor.orbit) for attractor in known.attractors]

    def reached(states: np.ndarray) -> np.ndarray:
        inside = np.array([region.holds(states) for region in regions])
        return np.where(inside.any(axis=0), inside.argmax(axis=0), -1)

    return reached


def _problem() -> Problem:
    """Return the problem; its initial state does not matter."""
    return gm.paper().problem(variant(VARIANT), NU)


METHODS = {
    "heyoka in batches, until near an orbit": with_heyoka,
    "heyoka in batches, with gearmesh's regions": with_heyoka_and_regions,
    "SciPy DOP853, until near an orbit": with_scipy,
}
