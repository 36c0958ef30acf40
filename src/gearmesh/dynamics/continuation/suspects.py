"""The search for pieces of a branch that may hold special points.

The test functions are computed for all points at once. A few array operations then show which
pieces need a closer look.
"""

from typing import NamedTuple

import numpy as np

from gearmesh.dynamics.continuation.curves import Point
from gearmesh.dynamics.continuation.kinds import BIFURCATIONS, GRAZINGS
from gearmesh.dynamics.continuation.special_points import (
    BACK,
    FRONT,
    bifurcation_tests,
    product_of_pairs,
)
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.derivatives.curves import DAMPING, JACOBIAN, TANGENT
from gearmesh.solvers.reduced.derivatives.deviations import DEVIATIONS, SIZE
from gearmesh.solvers.reduced.derivatives.period_map import segments_of
from gearmesh.solvers.reduced.derivatives.variational import (
    AFTER,
    BEFORE,
    CROSSING,
    HEIGHT,
    KIND,
    SEGMENT,
    SWITCH,
    TURN,
    VELOCITY,
)

_MARGIN = 0.25


def suspects(points: list[Point]) -> list[tuple[int, set[str]]]:
    """Return every i such that a special point may lie between points i and i + 1.

    A piece of the branch is suspect if a test function changes sign in it. It is also suspect if a
    test function may cross 0 twice in it, that is, if its value at an end is less than `_MARGIN`
    times its change nearby. All test functions are computed for all points at once, so only the
    suspect pieces need a closer look. The kinds that may lie there are returned with each i.
    """
    found = [point.found for point in points if point.found and len(point.found[1])]
    if len(found) == len(points):
        bifurcations = _of_rows(points, np.array([row for row, _ in found]))
        events = _of_events(points[0].orbit.problem, found)
    else:
        tests = [test for _, test in bifurcation_tests()]
        bifurcations = [np.array([test(point) for point in points]) for test in tests]
        events = _of_shots([point.orbit for point in points])
    functions = np.column_stack([*bifurcations, *events.heights, *events.velocities])
    kinds = np.array([*BIFURCATIONS, *GRAZINGS, *("switching" for _ in events.velocities)])
    with np.errstate(invalid="ignore"):
        change = np.abs(np.diff(functions, axis=0))
        nearby = change.copy()
        nearby[1:] = np.fmax(nearby[1:], change[:-1])
        nearby[:-1] = np.fmax(nearby[:-1], change[1:])
        size = np.abs(functions)
        near = (functions[1:] * functions[:-1] <= 0.0) | (
            np.fmin(size[1:], size[:-1]) < _MARGIN * nearby
        )
    near[:, np.isin(kinds, GRAZINGS)] |= (np.diff(events.beyond) != 0)[:, None]
    return [(int(i), set(kinds[near[i]])) for i in np.flatnonzero(near.any(axis=1))]


class _Events(NamedTuple):
    """Functions that pass 0 where events appear or vanish.

    Attributes
    ----------
    heights : list of two ndarray, shape (n,)
        The least distances between extrema of y and the ends of regimes, front and back.
    velocities : ndarray, shape (m, n)
        The velocities where C(t) jumps. Such a velocity counts only if y'' changes sign at the
        jump, at this point or a neighbouring one; otherwise it is not-a-number.
    beyond : ndarray, shape (n,)
        A number that changes with the regimes that an orbit passes.
    """

    heights: list[np.ndarray]
    velocities: np.ndarray
    beyond: np.ndarray


def _of_shots(orbits: list[Shot]) -> _Events:
    """Return the event functions of orbits from either solver."""
    both = [[extrema(orbit)[:, 1] for orbit in orbits] for extrema in (FRONT, BACK)]
    jumps = [orbit.stiffness_jumps for orbit in orbits]
    fewest = min(map(len, jumps))
    events = np.array([one[:fewest] for one in jumps])
    turning = events[:, :, BEFORE] * events[:, :, AFTER] < 0.0
    return _Events(
        [np.array([np.abs(h).min(initial=np.inf) for h in heights]) for heights in both],
        _counting(events[:, :, VELOCITY], turning),
        np.array([sum((h < 0.0).sum() for h in heights) for heights in zip(*both, strict=True)]),
    )


def _of_events(problem: Problem, found: list[tuple[np.ndarray, np.ndarray]]) -> _Events:
    """Return the event functions of points that compiled code found."""
    stiffness = segments_of(problem)[:, 1]
    events = np.concatenate([one for _, one in found])
    first = np.cumsum([0, *(len(one) for _, one in found[:-1])])
    kind, height = events[:, KIND], events[:, HEIGHT]
    jumps = (kind == SWITCH) & (stiffness != np.roll(stiffness, 1))[events[:, SEGMENT].astype(int)]
    heights = [
        np.minimum.reduceat(np.where(kind == TURN, np.abs(height - level), np.inf), first)
        for level in (0.0, -problem.backlash)
    ]
    velocities = events[jumps, VELOCITY].reshape(len(found), -1)
    turning = (events[jumps, BEFORE] * events[jumps, AFTER] < 0.0).reshape(velocities.shape)
    beyond = np.add.reduceat(kind == CROSSING, first, dtype=int)
    return _Events(heights, _counting(velocities, turning), beyond)


def _counting(velocities: np.ndarray, turning: np.ndarray) -> np.ndarray:
    """Return velocities at jumps, shape (n, m), as `_Events` describes them."""
    beside = turning.copy()
    beside[1:] |= turning[:-1]
    beside[:-1] |= turning[1:]
    return np.where(beside, velocities, np.nan).T


def _of_rows(points: list[Point], rows: np.ndarray) -> list[np.ndarray]:
    """Return the values of `bifurcation_tests` at points that compiled code found."""
    extended = rows[:, JACOBIAN:TANGENT].reshape(-1, SIZE, DEVIATIONS)
    jacobians = np.ascontiguousarray(extended[:, :, :SIZE])
    return [
        np.array([point.slope for point in points]),
        np.array([point.determinant for point in points]),
        np.linalg.det(jacobians + np.eye(SIZE)),
        np.where(rows[:, DAMPING] != 0.0, product_of_pairs(jacobians), np.nan),
    ]
