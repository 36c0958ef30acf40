"""Brute force: runs are followed until they repeat, or until they are known to reach an orbit."""

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

MOST = 10_000
"""Mesh periods of a run that never ends."""

Ended = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""From states before and after a mesh period, shape (n, 4), to whether the runs are over."""


def in_batches(
    problems: Sequence[Problem], states: np.ndarray, tolerance: float, ended: Ended
) -> np.ndarray:
    """Return the ends of runs that heyoka follows, as many side by side as a vector holds.

    A batch ends when all of its runs are over. The runs have the same damping terms and switch at
    the same phases.
    """
    found = []
    for first in range(0, len(problems), LANES):
        batch = list(problems[first : first + LANES])
        begin = states[first : first + LANES]
        missing = LANES - len(batch)
        begin = np.concatenate([begin, np.repeat(begin[-1:], missing, axis=0)])
        found.append(_batch(batch + batch[-1:] * missing, begin, tolerance, ended)[: len(batch)])
    return np.concatenate(found)


def _batch(
    problems: list[Problem], states: np.ndarray, tolerance: float, ended: Ended
) -> np.ndarray:
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


def one_by_one(
    problems: Sequence[Problem], states: np.ndarray, tolerance: float, ended: Ended
) -> np.ndarray:
    """Return the ends of runs that SciPy follows."""
    ends = []
    for problem, state in zip(problems, states[:, None], strict=True):
        stroboscope = scipy_map.Stroboscope(problem, tolerance)
        for _ in range(MOST):
            before, state = state, stroboscope.move(state[0])[None]
            if ended(before, state).all():
                break
        ends.append(state[0])
    return np.array(ends)


def repeats(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return which motions are periodic."""
    return np.abs(after - before).max(axis=1) < REPEATS
