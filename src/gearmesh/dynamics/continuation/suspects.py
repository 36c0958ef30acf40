"""The search for pieces of a branch that may hold special points.

The test functions are computed for all points at once. A few array operations then show which
pieces need a closer look.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gearmesh.dynamics.continuation.kinds import BIFURCATIONS, GRAZINGS
from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.test_functions import BACK, FRONT, bifurcation_values
from gearmesh.dynamics.continuation.tracing import Track
from gearmesh.dynamics.periodic.orbits import are_jumps
from gearmesh.solvers.reduced.derivatives.variational import (
    AFTER,
    BEFORE,
    CROSSING,
    HEIGHT,
    KIND,
    TURN,
    VELOCITY,
)

_MARGIN = 0.25


def suspects(points: Sequence[Point]) -> list[tuple[int, set[str]]]:
    """Return every i such that a special point may lie between points i and i + 1.

    A piece of the branch is suspect if a test function changes sign in it. It is also suspect if a
    test function may cross 0 twice in it, that is, if its value at an end is less than `_MARGIN`
    times its change nearby. All test functions are computed for all points at once, so only the
    suspect pieces need a closer look. The kinds that may lie there are returned with each i.
    """
    if isinstance(points, Track) and all(map(len, points.events)):
        events = _of_track(points)
    else:
        events = _of_points(points)
    functions = np.column_stack([*bifurcation_values(points), *events.heights, *events.velocities])
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


def _of_points(points: Sequence[Point]) -> _Events:
    """Return the event functions of points."""
    both = [[extrema(point.motion)[:, 1] for point in points] for extrema in (FRONT, BACK)]
    jumps = [point.motion.stiffness_jumps for point in points]
    fewest = min(map(len, jumps))
    events = np.array([one[:fewest] for one in jumps])
    turning = events[:, :, BEFORE] * events[:, :, AFTER] < 0.0
    return _Events(
        [np.array([np.abs(h).min(initial=np.inf) for h in heights]) for heights in both],
        _counting(events[:, :, VELOCITY], turning),
        np.array([sum((h < 0.0).sum() for h in heights) for heights in zip(*both, strict=True)]),
    )


def _of_track(track: Track) -> _Events:
    """Return the event functions of points that compiled code found, all at once."""
    events = np.concatenate(track.events)
    first = np.cumsum([0, *map(len, track.events[:-1])])
    kind, height = events[:, KIND], events[:, HEIGHT]
    jumps = events[are_jumps(events, track.tracer.stated[0])]
    heights = [
        np.minimum.reduceat(np.where(kind == TURN, np.abs(height - level), np.inf), first)
        for level in (0.0, -track.tracer.problem.backlash)
    ]
    velocities = jumps[:, VELOCITY].reshape(len(track), -1)
    turning = (jumps[:, BEFORE] * jumps[:, AFTER] < 0.0).reshape(velocities.shape)
    beyond = np.add.reduceat(kind == CROSSING, first, dtype=int)
    return _Events(heights, _counting(velocities, turning), beyond)


def _counting(velocities: np.ndarray, turning: np.ndarray) -> np.ndarray:
    """Return velocities at jumps, shape (n, m), as `_Events` describes them."""
    beside = turning.copy()
    beside[1:] |= turning[:-1]
    beside[:-1] |= turning[1:]
    return np.where(beside, velocities, np.nan).T
