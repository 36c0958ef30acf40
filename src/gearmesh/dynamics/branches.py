"""Branches of orbits: how a periodic motion changes with a parameter, where it begins and ends."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from gearmesh.dynamics.continuation import Curve, Family, Point, at_phase, clear_phase
from gearmesh.dynamics.orbits import Orbit
from gearmesh.dynamics.special_points import SpecialPoint, flip_test, special_points
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.period_map import passage

LONGEST_STEP = 0.03
"""Longest step along a branch, in y_st and shares of the range of the parameter.

It grows in proportion to motions of more than `_LARGE`.
"""

FARTHEST = 100.0
"""Size of y, in y_st, at which a branch is not followed further."""

MOST_POINTS = 4000
"""Points after which a branch is given up."""

LIMIT, CLOSED, HALVED, FAR = "limit", "closed", "half the period", "far"
"""Ends of a branch: at a limit of the parameter, at its own start, at a flip of an orbit of half
the period, where the orbits of the branch come again one half of their period later, and at
motions larger than `FARTHEST`."""

_FIRST_STEP = 0.25  # of the longest
_GROWTH = 1.4
_LARGE = 5.0
_AT_LIMIT = 1e-9  # share of the range of the parameter
_SAME = 1e-7  # distance between two states that are the same
_AMPLITUDE = 1e-3  # of the first orbit after a flip
_REACH = 0.3  # length of the branch of half the period on which its flip is looked for


@dataclass(frozen=True)
class Branch:
    """A branch of period-n orbits.

    Attributes
    ----------
    parameter : str
        Name of the parameter.
    values : ndarray, shape (n,)
        The parameter along the branch.
    orbits : list of Orbit
        The orbits at these values.
    special : list of SpecialPoint
        Special points in their order along the branch.
    ends : tuple of two str
        Why the branch stops at its first and at its last point: `LIMIT`, `CLOSED`, `HALVED`,
        `FAR`, or what keeps the corrector from going on.
    """

    parameter: str
    values: np.ndarray
    orbits: list[Orbit]
    special: list[SpecialPoint]
    ends: tuple[str, str]

    @property
    def y_max(self) -> np.ndarray:
        """Greatest y of each orbit."""
        return np.array([orbit.y_max for orbit in self.orbits])

    @property
    def y_min(self) -> np.ndarray:
        """Least y of each orbit."""
        return np.array([orbit.y_min for orbit in self.orbits])

    @property
    def stable(self) -> np.ndarray:
        """Whether each orbit is stable."""
        return np.array([orbit.stable for orbit in self.orbits])

    @property
    def neutral(self) -> np.ndarray:
        """Whether each orbit is neutral."""
        return np.array([orbit.neutral for orbit in self.orbits])

    @property
    def multipliers(self) -> np.ndarray:
        """Floquet multipliers, shape (n, 4)."""
        return np.array([orbit.multipliers for orbit in self.orbits])


def follow(
    orbit: Orbit,
    parameter: str,
    limits: tuple[float, float],
    family: Family | None = None,
    value: float | None = None,
    longest_step: float = LONGEST_STEP,
) -> Branch:
    """Follow an orbit in one parameter, in both directions.

    Parameters
    ----------
    orbit : Orbit
        Where to begin.
    parameter : str
        A field of `Problem`, or a name of what `family` varies.
    limits : tuple of float
        Range of the parameter.
    family : callable, optional
        The problem at a value of the parameter, if it is not a field of `Problem`.
    value : float, optional
        The parameter at `orbit`, if it is not a field of `Problem`.
    longest_step : float
        Longest step along the branch.

    Raises
    ------
    NoOrbit
        If the orbit is not on a branch of the family.
    """
    family = family or field_family(orbit.problem, parameter)
    value = float(getattr(orbit.problem, parameter)) if value is None else value
    low, high = limits
    if not low <= value <= high:
        raise NoOrbit(f"{parameter} = {value:.6g} of the orbit is outside {low:.6g} to {high:.6g}")
    phase = orbit.problem.initial_phase
    moved = at_phase(orbit, clear_phase(orbit))
    curve = Curve(family, orbit.periods, high - low, moved.problem.initial_phase)
    start = curve.at(moved, value)
    ahead = _follow(_Piece(curve, [start]), limits, longest_step)
    pieces, back = ahead.pieces, ahead
    if ahead.reason != CLOSED:
        back = _follow(_Piece(curve, [start.reversed()]), limits, longest_step)
        pieces = [piece.reversed() for piece in reversed(back.pieces)] + pieces
    points = pieces[0].points[:1] + [point for piece in pieces for point in piece.points[1:]]
    special = [
        SpecialPoint(kind, found.problem.nu, {parameter: point.value}, found)
        for kind, point in [*back.flip[: back is not ahead], *_special(pieces), *ahead.flip]
        for found in (at_phase(point.orbit, phase),)
    ]
    return Branch(
        parameter,
        np.array([point.value for point in points]),
        [at_phase(point.orbit, phase) for point in points],
        special,
        (back.reason, ahead.reason),
    )


def field_family(problem: Problem, name: str) -> Family:
    """Return the problems that differ from `problem` in one field."""
    changed: Callable[..., Problem] = partial(replace, problem)
    return lambda value: changed(**{name: value})


@dataclass(frozen=True)
class _Piece:
    """A piece of a branch with its states taken at one phase.

    The last point of a piece is the first of the next.
    """

    curve: Curve
    points: list[Point]

    def reversed(self) -> "_Piece":
        return _Piece(self.curve, [point.reversed() for point in reversed(self.points)])


class _Walk(NamedTuple):
    """A walk along a branch in one direction.

    Attributes
    ----------
    pieces : list of _Piece
    reason : str
        Why it ends.
    flip : list of (str, Point)
        The flip of the orbit of half the period where it ends, if it ends there.
    """

    pieces: list[_Piece]
    reason: str
    flip: list[tuple[str, Point]]


def _follow(piece: _Piece, limits: tuple[float, float], longest: float) -> _Walk:
    """Follow the branch from the only point of `piece` on."""
    start, pieces = piece.points[0], [piece]
    length = _FIRST_STEP * longest
    for _ in range(MOST_POINTS):
        curve, point = pieces[-1].curve, pieces[-1].points[-1]
        try:
            phase = clear_phase(point.orbit)
            if phase != curve.phase:
                curve, point = curve.moved_to(phase, point)
                pieces.append(_Piece(curve, [point]))
            following, length = curve.step_on(point, length)
        except NoOrbit as error:
            flip = _flip_at_end(curve, point)
            return _Walk(pieces, HALVED if flip else f"the branch ends: {error}", flip)
        if curve.periods % 2 == 0 and _half_way(point) @ _half_way(following) < 0.0:
            return _Walk(pieces, HALVED, _flip_at_end(curve, point))
        if not limits[0] <= following.value <= limits[1]:
            edge = limits[0] if following.value < limits[0] else limits[1]
            if abs(edge - point.value) > _AT_LIMIT * curve.unit:
                pieces[-1].points.append(_between(curve, point, following, edge))
            return _Walk(pieces, LIMIT, [])
        pieces[-1].points.append(following)
        if _is_back(curve, point, following, start):
            return _Walk(pieces, CLOSED, [])
        size = max(following.orbit.y_max, -following.orbit.y_min)
        if size > FARTHEST:
            return _Walk(pieces, FAR, [])
        length = min(_GROWTH * length, longest * max(1.0, size / _LARGE))
    return _Walk(pieces, "too many points", [])


def _half_way(point: Point) -> np.ndarray:
    """Return how far an orbit is from its start after half of its period."""
    orbit = point.orbit
    return passage(orbit.problem, orbit.state, orbit.periods // 2).end - orbit.state


def _flip_at_end(curve: Curve, point: Point) -> list[tuple[str, Point]]:
    """Return the flip of an orbit of half the period near a point, if there is one."""
    if curve.periods % 2:
        return []
    half = replace(curve, periods=curve.periods // 2)
    middle = point.orbit.state + 0.5 * _half_way(point)
    try:
        near = half.at(replace(point.orbit, state=middle), point.value)
        test = flip_test(near.orbit)
        for length in _REACH * np.array([0.01, -0.01, 0.1, -0.1, 1.0, -1.0]):
            if flip_test(half.step(near, length).orbit) * test <= 0.0:
                at = brentq(lambda s: flip_test(half.step(near, s).orbit), 0.0, length, xtol=1e-13)
                return [("flip", half.step(near, at))]
    except NoOrbit:
        pass
    return []


def _between(curve: Curve, point: Point, following: Point, value: float) -> Point:
    """Return the point between two others at a value of the parameter."""
    share = (value - point.value) / (following.value - point.value)
    place = point.place + share * (following.place - point.place)
    place[4] = value / curve.unit
    return curve.point(place, np.append(np.zeros(4), 1.0), following.tangent)


def _is_back(curve: Curve, point: Point, following: Point, start: Point) -> bool:
    """Return whether a closed branch passes its start between two points."""
    rises = following.tangent[4] * start.tangent[4] > 0.0
    if (
        point is start
        or not rises
        or (point.value < start.value) == (following.value < start.value)
    ):
        return False
    here = _between(curve, point, following, start.value).orbit
    state = at_phase(here, start.orbit.problem.initial_phase).state
    for _ in range(curve.periods):
        if np.abs(state - start.orbit.state).max() < _SAME:
            return True
        state = passage(start.orbit.problem, state).end
    return False


def _special(pieces: list[_Piece]) -> list[tuple[str, Point]]:
    return [
        found
        for piece in pieces
        for left, right in pairwise(piece.points)
        for found in special_points(piece.curve, left, right)
    ]


def double_period(point: SpecialPoint, family: Family | None = None) -> Orbit:
    """Return an orbit of twice the period, close to a flip.

    Parameters
    ----------
    point : SpecialPoint
        Of kind ``"flip"``.
    family : callable, optional
        The problem at a value of the parameter, if it is not a field of `Problem`.

    Raises
    ------
    NoOrbit
        If the corrector does not converge.
    """
    ((parameter, value),) = point.parameters.items()
    family = family or field_family(point.orbit.problem, parameter)
    single = at_phase(point.orbit, clear_phase(point.orbit))
    curve = Curve(family, 2 * single.periods, 1.0, single.problem.initial_phase)
    across = np.linalg.svd(single.passage.jacobian + np.eye(4))[2][-1]
    normal = np.append(across, 0.0)
    place = np.append(single.state, value) + _AMPLITUDE * normal
    found = curve.point(place, normal, normal)
    return at_phase(found.orbit, point.orbit.problem.initial_phase)
