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
    TIME,
    TURN,
    VELOCITY,
)

_MARGIN = 0.25


def suspects(points: Sequence[Point]) -> list[tuple[int, set[str]]]:
    """Return every i such that a special point may lie between points i and i + 1.

    A piece of the branch is suspect if a test function changes sign in it. It is also suspect if a
    test function may cross 0 twice in it, that is, if its value at an end is less than `_MARGIN`
    times its change nearby. A function that rises or falls all along does not cross 0 twice; for
    multipliers, there must be no grazing nearby. All test functions are computed for all points at
    once, so only the suspect pieces need a closer look. The kinds that may lie there are returned
    with each i.
    """
    events = _of_track(points) if isinstance(points, Track) else _of_points(points)
    functions = np.concatenate([bifurcation_values(points), *events.heights, events.velocities])
    kinds = [
        *BIFURCATIONS,
        *(kind for kind, rows in zip(GRAZINGS, events.heights, strict=True) for _ in rows),
        *["switching"] * len(events.velocities),
    ]
    passes = events.beyond[:, 1:] != events.beyond[:, :-1]
    grazes = passes.any(axis=0)
    left, right = functions[:, :-1], functions[:, 1:]
    change = np.zeros((len(functions), len(points) + 1))  # nothing changes beyond the ends
    change[:, 1:-1] = right - left
    first = len(BIFURCATIONS)
    for rows, counts in zip(events.heights, events.counts, strict=True):
        change[first : first + len(rows), 1:-1][:, counts[1:] != counts[:-1]] = np.nan
        first += len(rows)
    with np.errstate(invalid="ignore"):
        size = np.abs(change)
        nearby = np.fmax(np.fmax(size[:, :-2], size[:, 2:]), size[:, 1:-1])
        near = np.fmin(np.abs(left), np.abs(right)) < _MARGIN * nearby
        goes_on = change[:, 1:] * change[:, :-1] > 0.0
        goes_on[: len(BIFURCATIONS), 1:-1] &= ~(grazes[1:] | grazes[:-1])
        near &= ~(goes_on[:, 1:] & goes_on[:, :-1])
        near |= (left * right <= 0.0) & ~np.isnan(change[:, 1:-1])
    found: dict[int, set[str]] = {}
    for i, k in np.argwhere(near.T).tolist():
        found.setdefault(i, set()).add(kinds[k])
    for i, k in np.argwhere(passes.T).tolist():
        found.setdefault(i, set()).add(GRAZINGS[k])
    return sorted(found.items())


class _Events(NamedTuple):
    """Functions that pass 0 where events appear or vanish.

    Attributes
    ----------
    heights : list of two ndarray, shape (k, n)
        The distances of extrema from the front end of their regime, and from the back end. A row
        follows the same extremum as long as their number stays.
    counts : ndarray of int, shape (2, n)
        How many extrema each orbit has in each of these arrays.
    velocities : ndarray, shape (m, n)
        The velocities where C(t) jumps. Such a velocity counts only if y'' changes sign at the
        jump, at this point or a neighbouring one; otherwise it is not-a-number.
    beyond : ndarray, shape (2, n)
        For the front end of the backlash and for the back end, a count that a grazing changes: of
        the passages of that end, or of the extrema beyond it.
    """

    heights: list[np.ndarray]
    counts: np.ndarray
    velocities: np.ndarray
    beyond: np.ndarray


def _of_points(points: Sequence[Point]) -> _Events:
    """Return the event functions of points."""
    both = [[extrema(point.motion) for point in points] for extrema in (FRONT, BACK)]
    counts = np.array([list(map(len, extrema)) for extrema in both])
    jumps = [point.motion.stiffness_jumps for point in points]
    fewest = min(map(len, jumps))
    events = np.array([one[:fewest] for one in jumps])
    turning = events[:, :, BEFORE] * events[:, :, AFTER] < 0.0
    return _Events(
        [_followed(*np.concatenate(one).T, n) for one, n in zip(both, counts, strict=True)],
        counts,
        _counting(events[:, :, VELOCITY].T, turning.T),
        np.array([[(one[:, 1] < 0.0).sum() for one in extrema] for extrema in both]),
    )


def _of_track(track: Track) -> _Events:
    """Return the event functions of points that compiled code found, all at once."""
    tracer, n = track.tracer, len(track)
    events = np.concatenate(track.events)
    point = np.repeat(np.arange(n), track.rows[:, curves.N_EVENTS].astype(int))
    kind, height = events[:, KIND], events[:, HEIGHT]
    turns, counts = events[kind == TURN], np.bincount(point[kind == TURN], minlength=n)
    heights = _followed(turns[:, TIME], turns[:, HEIGHT], np.sign(-turns[:, AFTER]), counts)
    levels = 0.0, -tracer.problem.backlash
    passages = [point[(kind == CROSSING) & (height == level)] for level in levels]
    jumping = (kind == SWITCH) & tracer.jumping[events[:, SEGMENT].astype(int)]
    jumps = events[jumping].reshape(n, -1, EVENT_SIZE).T
    return _Events(
        [heights - level for level in levels],
        np.array([counts, counts]),
        _counting(jumps[VELOCITY], jumps[BEFORE] * jumps[AFTER] < 0.0),
        np.array([np.bincount(one, minlength=n) for one in passages]),
    )


def _followed(
    times: np.ndarray, heights: np.ndarray, kinds: np.ndarray, counts: np.ndarray
) -> np.ndarray:
    """Return the heights of the extrema of successive orbits, each extremum in a row.

    Maxima and minima follow in turn. So where the first extremum is of another kind than that of
    the orbit before, one has passed the initial phase.

    Parameters
    ----------
    times, heights, kinds : ndarray, shape (m,)
        Of all extrema of all orbits, in the order of the orbits and of time.
    counts : ndarray of int, shape (n,)
        Number of extrema of each orbit.

    Returns
    -------
    ndarray, shape (k, n)
        Rows of orbits with fewer extrema end with not-a-number.
    """
    found = np.full((counts.max(), len(counts)), np.nan)
    if len(times):
        begins = np.cumsum(counts) - counts
        first = np.minimum(begins, len(times) - 1)
        passed = (np.diff(kinds[first]) != 0.0) * np.sign(np.diff(times[first])).astype(int)
        shifts = np.append(0, np.cumsum(passed)) - begins
        order = (np.arange(len(times)) + np.repeat(shifts, counts)) % np.repeat(counts, counts)
        found[order, np.repeat(np.arange(len(counts)), counts)] = heights
    return found


def _counting(velocities: np.ndarray, turning: np.ndarray) -> np.ndarray:
    """Return the velocities at jumps, shape (m, n), that count as `_Events` says."""
    beside = turning.copy()
    beside[:, 1:] |= turning[:, :-1]
    beside[:, :-1] |= turning[:, 1:]
    return np.where(beside, velocities, np.nan)
