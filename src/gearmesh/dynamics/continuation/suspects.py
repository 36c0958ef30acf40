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
from gearmesh.solvers.reduced.derivatives import curves
from gearmesh.solvers.reduced.derivatives.variational import (
    AFTER,
    BEFORE,
    CROSSING,
    EVENT_SIZE,
    HEIGHT,
    KIND,
    SEGMENT,
    SWITCH,
    TURN,
    VELOCITY,
)

_MARGIN = 0.25


def suspects(points: Sequence[Point]) -> list[tuple[int, set[str]]]:
    """Return every i such that a special point may lie between points i and i + 1.

    A piece of the branch is suspect if a test function changes sign in it. It is also suspect if a
    test function may cross 0 twice in it, that is, if its value at an end is less than `_MARGIN`
    times its change nearby. A function that rises or falls all along, without a grazing nearby,
    does not cross 0 twice. All test functions are computed for all points at once, so only the
    suspect pieces need a closer look. The kinds that may lie there are returned with each i.
    """
    if isinstance(points, Track) and all(map(len, points.events)):
        events = _of_track(points)
    else:
        events = _of_points(points)
    functions = np.concatenate([bifurcation_values(points), events.heights, events.velocities])
    each = len(events.heights) // len(GRAZINGS)
    kinds = [
        *BIFURCATIONS,
        *(kind for kind in GRAZINGS for _ in range(each)),
        *["switching"] * len(events.velocities),
    ]
    heights = slice(len(BIFURCATIONS), len(BIFURCATIONS) + len(events.heights))
    passes = events.beyond[:, 1:] != events.beyond[:, :-1]
    grazes = passes.any(axis=0)
    comparable = np.ones((len(functions), len(points) - 1), bool)
    comparable[heights] = events.extrema[1:] == events.extrema[:-1]
    left, right = functions[:, :-1], functions[:, 1:]
    change = np.zeros((len(functions), len(points) + 1))  # nothing changes beyond the ends
    with np.errstate(invalid="ignore"):
        change[:, 1:-1] = np.where(comparable, right - left, np.nan)
        size = np.abs(change)
        nearby = np.fmax(np.fmax(size[:, :-2], size[:, 2:]), size[:, 1:-1])
        near = np.fmin(np.abs(left), np.abs(right)) < _MARGIN * nearby
        goes_on = change[:, 1:] * change[:, :-1] > 0.0
        goes_on[heights] = False
        goes_on[:, 1:-1] &= ~(grazes[1:] | grazes[:-1])
        near &= ~(goes_on[:, 1:] & goes_on[:, :-1])
        near |= comparable & (left * right <= 0.0)
    near[heights] |= np.repeat(passes, each, axis=0)
    found: dict[int, set[str]] = {}
    for i, k in np.argwhere(near.T).tolist():
        found.setdefault(i, set()).add(kinds[k])
    return list(found.items())


class _Events(NamedTuple):
    """Functions that pass 0 where events appear or vanish.

    Attributes
    ----------
    heights : ndarray, shape (2 k, n)
        The distances of extrema from the front end of their regime, then from the back end: first
        the least one, then those of all extrema in their order in time. A pair of grazings may
        leave the least distance, and the regimes that are passed, as they were.
    extrema : ndarray of int, shape (n,)
        How many extrema each orbit has.
    velocities : ndarray, shape (m, n)
        The velocities where C(t) jumps. Such a velocity counts only if y'' changes sign at the
        jump, at this point or a neighbouring one; otherwise it is not-a-number.
    beyond : ndarray, shape (2, n)
        For the front end of the backlash and for the back end, a count that a grazing changes: of
        the passages of that end, or of the extrema beyond it.
    """

    heights: np.ndarray
    extrema: np.ndarray
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
        np.concatenate([_with_least(_side_by_side(heights)) for heights in both]),
        np.array([len(heights) for heights in both[0]]),
        _counting(events[:, :, VELOCITY].T, turning.T),
        np.array([[(h < 0.0).sum() for h in heights] for heights in both]),
    )


def _side_by_side(heights: list[np.ndarray]) -> np.ndarray:
    """Return the heights of each orbit in a column; not-a-number fills the shorter ones."""
    most = max(map(len, heights))
    return np.array([np.append(one, np.full(most - len(one), np.nan)) for one in heights]).T


def _with_least(heights: np.ndarray) -> np.ndarray:
    """Return heights, and above them the least distance from 0 in each column."""
    least = np.fmin.reduce(np.abs(heights), axis=0, initial=np.inf)
    return np.concatenate([least[None], heights])


def _of_track(track: Track) -> _Events:
    """Return the event functions of points that compiled code found, all at once."""
    tracer, counts = track.tracer, track.rows[:, curves.N_EVENTS].astype(int)
    events, first = np.concatenate(track.events), np.cumsum(counts) - counts
    kind, height = events[:, KIND], events[:, HEIGHT]
    levels = np.array([[0.0], [-tracer.problem.backlash]])
    turns, points = kind == TURN, np.repeat(np.arange(len(track)), counts)
    extrema = np.add.reduceat(turns, first, dtype=int)
    order = np.cumsum(turns) - np.repeat(np.cumsum(extrema) - extrema, counts) - 1
    heights = np.full((extrema.max(), len(track)), np.nan)
    heights[order[turns], points[turns]] = height[turns]
    passes = (kind == CROSSING) & (height == levels)
    jumping = (kind == SWITCH) & tracer.jumping[events[:, SEGMENT].astype(int)]
    jumps = events[jumping].reshape(len(track), -1, EVENT_SIZE).T
    return _Events(
        np.concatenate([_with_least(heights - level) for level in levels]),
        extrema,
        _counting(jumps[VELOCITY], jumps[BEFORE] * jumps[AFTER] < 0.0),
        np.add.reduceat(passes, first, axis=1, dtype=int),
    )


def _counting(velocities: np.ndarray, turning: np.ndarray) -> np.ndarray:
    """Return the velocities at jumps, shape (m, n), that count as `_Events` says."""
    beside = turning.copy()
    beside[:, 1:] |= turning[:, :-1]
    beside[:, :-1] |= turning[:, 1:]
    return np.where(beside, velocities, np.nan)
