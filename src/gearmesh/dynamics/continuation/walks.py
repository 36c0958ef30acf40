"""Walks along a curve of orbits in both directions, and the reasons why they end."""

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from gearmesh.dynamics.continuation.curves import Curve
from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.test_functions import flip_test
from gearmesh.dynamics.continuation.tracing import backwards, chained, geometry
from gearmesh.dynamics.continuation.zeros import passages
from gearmesh.dynamics.periodic.shots import Motion, Shot
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.model.segments import edges
from gearmesh.solvers.reduced.derivatives.curves import FARTHEST, is_clear

Limits = tuple[tuple[float, float], ...]
"""Range of each parameter."""

LONGEST_STEP = 0.03
"""Longest step along a branch, in y_st and shares of the range of the parameter.

It grows in proportion to motions of more than `gearmesh.solvers.reduced.derivatives.curves.LARGE`.
"""

MOST_POINTS = 4000
"""Greatest number of points of a walk."""

LIMIT, CLOSED, HALVED, FAR, LONG = "limit", "closed", "half the period", "far", "too many points"
"""Ends of a branch: at a limit of the parameter; at its own first point; at a flip of an orbit of
half the period, behind which the same orbits follow half a period later; at motions larger than
`gearmesh.solvers.reduced.derivatives.curves.FARTHEST`; at the point `MOST_POINTS`."""

_FIRST_STEP = 0.25  # of the longest
_AT_LIMIT = 1e-9  # share of the range of the parameter
_SAME = 1e-7  # distance between two states that are the same
_PLACES = 64  # of an orbit, at which its distance from the ends of regimes is taken
_KEPT, _CHOSEN = 0.25, 0.5  # least distances from edges of a phase, as shares of the greatest
_OPPOSITE = 0.9  # cosine between vectors that point away from each other
_REACH = 0.3  # length of the branch of half the period on which its flip is searched for


@dataclass(frozen=True)
class Piece:
    """A piece of a branch with its states taken at one phase.

    The last point of a piece is the first of the next.
    """

    curve: Curve
    points: Sequence[Point]

    def reversed(self) -> "Piece":
        """Return the same piece, passed in the other direction."""
        return Piece(self.curve, backwards(self.points))


class Walk(NamedTuple):
    """A walk along a branch in one direction.

    Attributes
    ----------
    pieces : list of Piece
    reason : str
        Why it ends.
    flip : list of (str, Point)
        The flip of the orbit of half the period where it ends, if it ends there.
    """

    pieces: list[Piece]
    reason: str
    flip: list[tuple[str, Point]]


def walk(curve: Curve, start: Point, limits: Limits, longest: float) -> tuple[Walk, Walk]:
    """Walk from `start` against and along its tangent; on a closed curve both are the same walk."""
    ahead = _walk(curve, start, limits, longest)
    if ahead.reason == CLOSED:
        return ahead, ahead
    return _walk(curve, start.reversed(), limits, longest), ahead


def check_inside(name: str, value: float, low: float, high: float) -> None:
    """Raise `NoOrbit` if a curve would begin outside the range of a parameter."""
    if not low <= value <= high:
        raise NoOrbit(f"{name} = {value:.6g} of the orbit is outside {low:.6g} to {high:.6g}")


def clear_phase(orbit: Shot, over_nu: bool) -> float:
    """Return a mesh phase at which the orbit is far from the ends of its regimes.

    The phase of the orbit's state is kept if it is at least half as far from them as the best
    phase, or if mesh periods differ, because it fixes the angles of the shafts.

    Unless nu alone varies, the phase is also far from the edges of C(t) and gamma(t): these may
    move, and the state has a kink where one passes the phase.
    """
    phase = orbit.problem.initial_phase
    if orbit.repeats_after > 1:
        return phase
    if not _is_clear(orbit) or not (over_nu or _from_edges(orbit.problem, phase) > _KEPT):
        y = orbit.time_course(_PLACES).y
        away = np.minimum(np.abs(y), np.abs(y + orbit.backlash))
        phases = phase + np.arange(len(y)) / _PLACES
        if not over_nu:
            away[[not _from_edges(orbit.problem, one) > _CHOSEN for one in phases.tolist()]] = -1.0
        phase = phases[np.argmax(away)]
    return float(phase % 1.0)


def _is_clear(motion: Motion) -> bool:
    clear: bool = is_clear.py_func(motion.y, motion.y_max, motion.y_min, motion.backlash)  # type: ignore[attr-defined]
    return clear


def _from_edges(problem: Problem, phase: float) -> float:
    """Return how far a phase is from the edges of C(t) and gamma(t), from 0 to 1."""
    places = np.sort(np.array(edges(problem)) % 1.0)
    if not places.size:
        return 1.0
    widest = np.diff(places, append=places[0] + 1.0).max()
    away = np.abs((places - phase + 0.5) % 1.0 - 0.5)
    return float(2.0 * away.min() / widest)


def joined(back: Walk, ahead: Walk) -> list[Piece]:
    """Return the pieces of both walks in the direction of the second.

    The start of the walks is left out unless it is an end. It may be a special point, and such
    points are searched for between others.
    """
    if back is ahead:
        return ahead.pieces
    *pieces, last = [piece.reversed() for piece in reversed(back.pieces)]
    first, *others = ahead.pieces
    inside = len(last.points) > 1 and len(first.points) > 1
    points = chained(last.points[:-1], first.points[1:] if inside else first.points)
    return [*pieces, Piece(first.curve, points), *others]


def points_of(pieces: list[Piece]) -> list[Point]:
    """Return all points of successive pieces, each once."""
    return [pieces[0].points[0], *(point for piece in pieces for point in piece.points[1:])]


def _walk(curve: Curve, start: Point, limits: Limits, longest: float) -> Walk:
    """Follow the branch from `start`, along its tangent."""
    point, pieces = start, [Piece(curve, curve.track(start))]
    length, origin, turned = _FIRST_STEP * longest, None, False
    while sum(len(piece.points) for piece in pieces) < MOST_POINTS:
        if _leaves(curve, point, limits):
            return Walk(pieces, LIMIT, [])
        try:
            if not curve.stretches or not _is_clear(point.motion):
                phase = clear_phase(point.orbit, curve.stretches)
                if phase != curve.phase:
                    curve, point = curve.moved_to(phase, point)
                    pieces.append(Piece(curve, curve.track(point)))
            ahead, length = curve.ahead(point, length, longest, limits)
        except NoOrbit as error:
            flip = _flip_at_end(curve, point)
            return Walk(pieces, HALVED if flip else f"the branch ends: {error}", flip)
        ahead, reason = _up_to_end(curve, point, ahead, limits)
        points = chained(pieces[-1].points, ahead)
        first = len(points) - len(ahead) - 1
        if origin is None and ahead:  # a closed branch begins behind the start: see `joined`
            first, origin = first + 1, _Origin(curve, ahead[0])
        turned = turned or _turns(curve, points)
        closed = _closed(curve, points, first, origin) if origin and turned else None
        if closed is not None:
            pieces[-1] = Piece(curve, closed)
            pieces[0] = Piece(pieces[0].curve, pieces[0].points[1:])
            return Walk(pieces, CLOSED, [])
        pieces[-1] = Piece(curve, points)
        if reason:
            flip = _flip_at_end(curve, pieces[-1].points[-1]) if reason == HALVED else []
            return Walk(pieces, reason, flip)
        point = ahead[-1]
        if point.size > FARTHEST:
            return Walk(pieces, FAR, [])
    return Walk(pieces, LONG, [])


def _up_to_end(
    curve: Curve, point: Point, ahead: Sequence[Point], limits: Limits
) -> tuple[Sequence[Point], str]:
    """Return the points behind `point` up to the end of a walk, and why it ends, if it does.

    Only the last of the points may be outside the limits.
    """
    reason = ""
    if _halves(curve):
        sides = [_half_way(one) for one in (point, *ahead)]
        turned = [_are_opposite(*ends) for ends in pairwise(sides)]
        if any(turned):
            ahead, reason = ahead[: turned.index(True)], HALVED
    if ahead and not _is_inside(ahead[-1], limits):
        ahead, outside, reason = ahead[:-1], ahead[-1], LIMIT
        try:
            end = _at_limit(curve, ahead[-1] if ahead else point, outside, limits)
        except NoOrbit as error:
            return ahead, f"the branch ends: {error}"
        ahead = chained(ahead, end)
    return ahead, reason


def _is_inside(point: Point, limits: Limits) -> bool:
    return all(low <= one <= high for one, (low, high) in zip(point.values, limits, strict=True))


def _at_limit(curve: Curve, point: Point, outside: Point, limits: Limits) -> Sequence[Point]:
    """Return the point where a curve leaves the limits, or none if it is `point` itself."""
    for i, (low, high) in enumerate(limits):
        if not low <= outside.values[i] <= high:
            edge = low if outside.values[i] < low else high
            if abs(edge - point.values[i]) > _AT_LIMIT * curve.units[i]:
                found = passages(curve, point, outside, edge, curve.beside, i)
                return next(map(curve.track, found), [])
            break
    return []


def _leaves(curve: Curve, point: Point, limits: Limits) -> bool:
    """Return whether the curve leaves the range of a parameter at a point."""
    slopes = point.tangent[-len(limits) :]
    ends = (high if slope > 0.0 else low for slope, (low, high) in zip(slopes, limits, strict=True))
    return any(
        abs(end - value) <= _AT_LIMIT * unit
        for end, value, unit in zip(ends, point.values, curve.units, strict=True)
    )


def _halves(curve: Curve) -> bool:
    """Return whether the curve may end at orbits of half the period."""
    return curve.periods % (2 * curve.like.repeats_after) == 0 and curve.condition is None


def _half_way(point: Point) -> np.ndarray:
    """Return the distance of an orbit from its initial state after half of its period."""
    orbit = point.orbit
    return orbit.shot(orbit.problem, orbit.state, orbit.periods // 2).defect


def _are_opposite(one: np.ndarray, other: np.ndarray) -> bool:
    """Return whether two vectors point in opposite directions; at a grazing they may only turn."""
    return bool(one @ other < -_OPPOSITE * np.linalg.norm(one) * np.linalg.norm(other))


def _flip_at_end(curve: Curve, point: Point) -> list[tuple[str, Point]]:
    """Return the flip of an orbit of half the period near a point, if there is one."""
    from scipy.optimize import brentq  # here, because it takes long to import

    if not _halves(curve):
        return []
    half = replace(curve, periods=curve.periods // 2)
    middle = point.orbit.state + 0.5 * _half_way(point)
    try:
        near = half.at(point.orbit.shot(point.orbit.problem, middle, half.periods), point.values)
        test = flip_test(near.orbit)
        for length in _REACH * np.array([0.01, -0.01, 0.1, -0.1, 1.0, -1.0]):
            if flip_test(half.step(near, length).orbit) * test <= 0.0:
                at = brentq(lambda s: flip_test(half.step(near, s).orbit), 0.0, length, xtol=1e-13)
                return [("flip", half.step(near, at))]
    except NoOrbit:
        pass
    return []


class _Origin:
    """The point at which a closed branch begins, in each of the mesh periods of its orbit."""

    def __init__(self, curve: Curve, point: Point) -> None:
        self.phase, self.point = curve.phase, point
        self.places = cache(self._places)

    def _places(self, periods: int, phase: float) -> np.ndarray:
        """Return the places of the orbit at a phase of each mesh period, shape (n, k + m)."""
        if periods == 1 and phase == self.phase:
            return self.point.place[None]
        orbit = self.point.orbit.at_phase(phase)
        states, step = [orbit.state], orbit.repeats_after
        for _ in range(step, periods, step):
            states.append(states[-1] + orbit.shot(orbit.problem, states[-1], step).defect)
        values = self.point.place[orbit.state.size :]
        return np.array([np.append(state, values) for state in states])


def _turns(curve: Curve, points: Sequence[Point]) -> bool:
    """Return whether the first parameter turns between points, as it does on a closed branch."""
    slopes = geometry(points)[1][:, -len(curve.units)]
    return bool(slopes.min() <= 0.0 <= slopes.max())


def _closed(
    curve: Curve, points: Sequence[Point], first: int, origin: _Origin
) -> Sequence[Point] | None:
    """Return the points up to where the curve meets its origin again, or None if it does not.

    Parameters
    ----------
    points : sequence of Point
        Successive points of the curve.
    first : int
        The point from which on the origin is looked for. It may be the origin itself.
    origin : _Origin
    """
    repeats = origin.places(curve.periods, curve.phase)
    places, tangents = geometry(points[first:])
    if len(places) < 2:
        return None
    apart, away = np.diff(places, axis=0)[:, None], repeats - places[:-1, None]
    lengths = np.sum(tangents[:-1, None] * apart, axis=2)
    along = np.sum(tangents[:-1, None] * away, axis=2)
    off = np.linalg.norm(away - along[..., None] / lengths[..., None] * apart, axis=2)
    near = (along > _SAME) & (along < lengths + 2.0 * _SAME) & (off < lengths)
    for i, j in np.argwhere(near).tolist():
        left, right = points[first + i], points[first + i + 1]
        with contextlib.suppress(NoOrbit):
            there = curve.between(left, right, left.tangent, along[i, j] / lengths[i, 0])
            if np.abs(there.place - repeats[j]).max() < _SAME:
                back = curve.point(repeats[j], left.tangent, left.tangent)
                return chained(points[: first + i + 1], curve.track(back))
    return None
