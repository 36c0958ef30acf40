"""Brute force: runs are followed until they repeat, or until they come near a known orbit.

heyoka moves as many runs side by side as a vector holds. A batch ends when all of its runs have.
"""

from collections.abc import Callable, Sequence

import numpy as np

from benchmarks.orbits import scipy_map
from benchmarks.peers.heyoka_batch import LANES, integrator
from benchmarks.reduced import pieces_of, terms
from gearmesh.model.problem import Problem

TOLERANCE = 1e-10
REPEATS = 1e-11
"""Change over a mesh period below which a motion counts as periodic. Its distance from the orbit is
some hundred times that, because motions of the bodies decay by less than a hundredth a period."""

NEAR = 1e-3
"""Distance from an orbit, in y_st, at which a run counts as arrived."""

MOST = 10_000
"""Mesh periods of a run that never ends."""


def in_batches(
    problems: Sequence[Problem],
    states: np.ndarray,
    tolerance: float,
    ended: Callable[[np.ndarray, np.ndarray], np.ndarray],
) -> np.ndarray:
    """Return the ends of runs that are followed until `ended`.

    Parameters
    ----------
    problems : sequence of Problem
        With the same damping terms and contact ratio.
    states : ndarray, shape (n, 4)
    tolerance : float
    ended : callable
        From states before and after a mesh period, shape (m, 4), to booleans.
    """
    found = []
    for first in range(0, len(problems), LANES):
        batch = list(problems[first : first + LANES])
        begin = states[first : first + LANES]
        missing = LANES - len(batch)
        begin = np.concatenate([begin, np.repeat(begin[-1:], missing, axis=0)])
        found.append(_batch(batch + batch[-1:] * missing, begin, tolerance, ended)[: len(batch)])
    return np.concatenate(found)


def _batch(problems, states, tolerance, ended):
    periods = np.array([problem.period for problem in problems])
    scale = np.column_stack([np.ones(LANES), periods, np.ones(LANES), periods])
    solver, cut = integrator(terms(problems[0]), tolerance), pieces_of(problems[0])
    solver.prepare(problems, cut, states * scale)
    for n in range(MOST):
        before = solver.state.T / scale
        solver.propagate_period(n, cut, solver.active.propagate_until)
        after = solver.state.T / scale
        if ended(before, after).all():
            break
    return after


def repeats(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return which motions are periodic."""
    return np.abs(after - before).max(axis=-1) < REPEATS


def nearest(states: np.ndarray, points: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return the nearest of several points to each state, and its distance."""
    away = np.array([np.abs(states - point).max(axis=-1) for point in points])
    return away.argmin(axis=0), away.min(axis=0)


def one_by_one(problem: Problem, states: np.ndarray, points: Sequence[np.ndarray]) -> np.ndarray:
    """Return the ends of runs with SciPy that are followed until they are near a point."""
    stroboscope, ends = scipy_map.Stroboscope(problem), []
    for state in states:
        for _ in range(MOST):
            state = stroboscope.move(state)
            if nearest(state, points)[1] < NEAR:
                break
        ends.append(state)
    return np.array(ends)
