"""The search for pieces of a branch that may hold special points.

The test functions are computed for all points at once. A few array operations then show which
pieces need a closer look.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from gearmesh.dynamics.continuation.kinds import BIFURCATIONS, GRAZINGS
from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.test_functions import (
    BACK,
    FRONT,
    Function,
    Test,
    bifurcation_test,
    height_near,
    velocity_at,
)
from gearmesh.dynamics.continuation.tracing import Track, first_values, geometry
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
_AROUND = 2  # points on each side of a piece that help to locate roots in it


def suspects(points: Sequence[Point], bifurcating: np.ndarray) -> list[tuple[int, list[Test]]]:
    """Return every i such that a special point may lie between points i and i + 1, with its tests.

    A piece of the branch is suspect if a test function changes sign in it. It is also suspect if a
    test function may cross 0 twice in it, that is, if its value at an end is less than `_MARGIN`
    times its change nearby. A function that rises or falls all along does not cross 0 twice; for
    multipliers, there must be no grazing nearby. All test functions are computed for all points at
    once, so only the suspect pieces need a closer look.

    Parameters
    ----------
    points : sequence of Point, length n
    bifurcating : ndarray, shape (4, n)
        The values of `bifurcation_values` at the points.
    """
    events = _of_track(points) if isinstance(points, Track) else _of_points(points)
    parts = [bifurcating, *(extrema.heights for extrema in events.extrema), events.velocities]
    functions = np.concatenate(parts)
    grazing = [slice(*ends) for ends in pairwise(np.cumsum([len(part) for part in parts[:-1]]))]
    passes = events.beyond[:, 1:] != events.beyond[:, :-1]
    grazes = passes.any(axis=0)
    left, right = functions[:, :-1], functions[:, 1:]
    change = np.zeros((len(functions), len(points) + 1))  # nothing changes beyond the ends
    change[:, 1:-1] = right - left
    for rows, extrema in zip(grazing, events.extrema, strict=True):
        change[rows, 1:-1][:, extrema.counts[1:] != extrema.counts[:-1]] = np.nan
    with np.errstate(invalid="ignore"):
        size = np.abs(change)
        nearby = np.fmax(np.fmax(size[:, :-2], size[:, 2:]), size[:, 1:-1])
        near = np.fmin(np.abs(left), np.abs(right)) < _MARGIN * nearby
        goes_on = change[:, 1:] * change[:, :-1] > 0.0
        goes_on[: len(bifurcating), 1:-1] &= ~(grazes[1:] | grazes[:-1])
        near &= ~(goes_on[:, 1:] & goes_on[:, :-1])
        near |= (left * right <= 0.0) & ~np.isnan(change[:, 1:-1])
    for rows, passed in zip(grazing, passes, strict=True):
        # Where the number of extrema changes, no row may show which of them grazes.
        near[rows] |= passed & ~near[rows].any(axis=0)
    near &= ~np.isnan(left)
    sought = [(kind, 0) for kind in BIFURCATIONS]
    for kind, part in zip((*GRAZINGS, "switching"), parts[1:], strict=True):
        sought += [(kind, number) for number in range(len(part))]
    places, found = geometry(points)[0], dict[int, list[Test]]()
    for i, row in np.argwhere(near.T).tolist():
        around = slice(max(i - _AROUND, 0), i + 2 + _AROUND)
        known = ~np.isnan(functions[row, around])
        known[i - around.start :][:2] = False
        values = places[around][known], functions[row, around][known]
        kind, number = sought[row]
        found.setdefault(i, []).append(Test(kind, events.function(kind, number, i), values))
    return list(found.items())


class _Extrema(NamedTuple):
    """Extrema of successive orbits; a row follows one extremum as long as their number stays.

    Attributes
    ----------
    phases, heights, kinds : ndarray, shape (k, n)
        The phases are in mesh periods from the initial one, and the heights are distances from an
        end of the regime. Rows of orbits with fewer extrema end with not-a-number.
    counts : ndarray of int, shape (n,)
        How many extrema each orbit has.
    """

    phases: np.ndarray
    heights: np.ndarray
    kinds: np.ndarray
    counts: np.ndarray


class _Events(NamedTuple):
    """Functions that pass 0 where events appear or vanish.

    Attributes
    ----------
    extrema : list of two _Extrema
        With their distances from the front end of their regime, and from the back end.
    velocities : ndarray, shape (m, n)
        The velocities where C(t) jumps. Such a velocity counts only if y'' changes sign at the
        jump, at this point or a neighbouring one; otherwise it is not-a-number.
    beyond : ndarray, shape (2, n)
        For the front end of the backlash and for the back end, a count that a grazing changes: of
        the passages of that end, or of the extrema beyond it.
    """

    extrema: list[_Extrema]
    velocities: np.ndarray
    beyond: np.ndarray

    def function(self, kind: str, number: int, i: int) -> Function:
        """Return a test function of a kind that begins at point i."""
        if kind == "switching":
            return velocity_at(number)
        if kind not in GRAZINGS:
            return bifurcation_test(kind)
        end = GRAZINGS.index(kind)
        extrema = self.extrema[end]
        where = float(extrema.phases[number, i]), float(extrema.kinds[number, i])
        return height_near((FRONT, BACK)[end], *where)


def _of_points(points: Sequence[Point]) -> _Events:
    """Return the event functions of points."""
    both = [[extrema(point.motion) for point in points] for extrema in (FRONT, BACK)]
    jumps = [point.motion.stiffness_jumps for point in points]
    fewest = min(map(len, jumps))
    events = np.array([one[:fewest] for one in jumps])
    turning = events[:, :, BEFORE] * events[:, :, AFTER] < 0.0
    periods = np.array([point.motion.period for point in points])
    return _Events(
        [
            _followed(np.concatenate(extrema), np.array(list(map(len, extrema))), periods)
            for extrema in both
        ],
        _counting(events[:, :, VELOCITY].T, turning.T),
        np.array([[(one[:, 1] < 0.0).sum() for one in extrema] for extrema in both]),
    )


def _of_track(track: Track) -> _Events:
    """Return the event functions of points that compiled code found, all at once."""
    tracer, n = track.tracer, len(track)
    events = np.concatenate(track.events)
    point = np.repeat(np.arange(n), track.rows[:, curves.N_EVENTS].astype(int))
    kind, height = events[:, KIND], events[:, HEIGHT]
    turns = events[kind == TURN]
    extrema = np.stack([turns[:, TIME], turns[:, HEIGHT], -np.sign(turns[:, AFTER])], axis=1)
    counts = np.bincount(point[kind == TURN], minlength=n)
    front = _followed(extrema, counts, 2.0 * np.pi / first_values(track))
    backlash = tracer.problem.backlash
    passages = [point[(kind == CROSSING) & (height == level)] for level in (0.0, -backlash)]
    jumping = (kind == SWITCH) & tracer.jumping[events[:, SEGMENT].astype(int)]
    jumps = events[jumping].reshape(n, -1, EVENT_SIZE).T
    return _Events(
        [front, front._replace(heights=front.heights + backlash)],
        _counting(jumps[VELOCITY], jumps[BEFORE] * jumps[AFTER] < 0.0),
        np.array([np.bincount(one, minlength=n) for one in passages]),
    )


def _followed(extrema: np.ndarray, counts: np.ndarray, periods: np.ndarray) -> _Extrema:
    """Return the extrema of successive orbits, each in a row.

    Maxima and minima follow in turn. So where the first extremum is of another kind than that of
    the orbit before, one has passed the initial phase.

    Parameters
    ----------
    extrema : ndarray, shape (m, 3)
        Times, heights and kinds of all extrema, in the order of the orbits and of time.
    counts : ndarray of int, shape (n,)
        Number of extrema of each orbit.
    periods : ndarray, shape (n,)
        Mesh period of each orbit.
    """
    found = np.full((3, counts.max(), len(counts)), np.nan)
    if len(extrema):
        times, heights, kinds = extrema.T
        begins = np.cumsum(counts) - counts
        first = np.minimum(begins, len(times) - 1)
        passed = (kinds[first[1:]] != kinds[first[:-1]]) * np.sign(np.diff(times[first]))
        shifts = np.append(0, np.cumsum(passed.astype(int))) - begins
        point = np.repeat(np.arange(len(counts)), counts)
        order = (np.arange(len(times)) + shifts[point]) % counts[point]
        found[:, order, point] = times / periods[point], heights, kinds
    phases, heights, kinds = found
    return _Extrema(phases, heights, kinds, counts)


def _counting(velocities: np.ndarray, turning: np.ndarray) -> np.ndarray:
    """Return the velocities at jumps, shape (m, n), that count as `_Events` says."""
    beside = turning.copy()
    beside[:, 1:] |= turning[:, :-1]
    beside[:, :-1] |= turning[:, 1:]
    return np.where(beside, velocities, np.nan)
