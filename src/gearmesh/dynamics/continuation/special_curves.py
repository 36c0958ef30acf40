"""Curves of special points in two parameters, and the cusps where folds vanish."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearmesh.dynamics.continuation.branches import field_family, in_coordinates_of
from gearmesh.dynamics.continuation.curves import Curve, Family, unit_of
from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.special_points import SpecialPoint, search
from gearmesh.dynamics.continuation.test_functions import (
    BACK,
    FRONT,
    Extrema,
    Test,
    flip_test,
    torus_test,
)
from gearmesh.dynamics.continuation.walks import (
    LONGEST_STEP,
    check_inside,
    clear_phase,
    joined,
    points_of,
    walk,
)
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.errors import NoOrbit
from gearmesh.solvers.reduced.derivatives.variational import VELOCITY


@dataclass(frozen=True)
class SpecialCurve:
    """Special points of one kind along a curve in two parameters.

    Attributes
    ----------
    kind : str
        Kind of the special points.
    parameters : tuple of two str
        Names of the parameters.
    values : ndarray, shape (n, 2)
        The parameters along the curve.
    orbits : list of Shot
        The orbits there.
    cusps : list of SpecialPoint
        Of a curve of folds: where two folds meet and vanish.
    ends : tuple of two str
        Why the curve ends at its first and at its last point, see `walks`.
    """

    kind: str
    parameters: tuple[str, str]
    values: np.ndarray
    orbits: list[Shot]
    cusps: list[SpecialPoint]
    ends: tuple[str, str]


def follow_special(
    point: SpecialPoint,
    parameters: tuple[str, str],
    limits: tuple[tuple[float, float], tuple[float, float]],
    family: Family | None = None,
    values: tuple[float, ...] | None = None,
    longest_step: float = LONGEST_STEP,
) -> SpecialCurve:
    """Follow a special point in two parameters, in both directions.

    Parameters
    ----------
    point : SpecialPoint
        Of any kind except ``"branch_point"``, which in general vanishes when a second parameter
        changes.
    parameters : tuple of two str
        Fields of `Problem`, or names of what `family` varies.
    limits : tuple of two tuples of float
        Range of each parameter.
    family : callable, optional
        The problem at two values, if the parameters are not fields of `Problem`.
    values : tuple of two float, optional
        The parameters at `point`, if they are not fields of `Problem`.
    longest_step : float
        Longest step along the curve.

    Raises
    ------
    NoOrbit
        If the curve cannot be followed from `point`.
    """
    if point.kind not in _CONDITIONS:
        raise NoOrbit(f"special points: no curve of {point.kind!r}, only of {list(_CONDITIONS)}")
    problem = point.orbit.problem
    family = family or field_family(problem, *parameters)
    values = values or tuple(float(getattr(problem, name)) for name in parameters)
    for name, value, (low, high) in zip(parameters, values, limits, strict=True):
        check_inside(name, value, low, high)
    orbit = in_coordinates_of(point.orbit, family, limits)
    moved = orbit.at_phase(clear_phase(orbit, over_nu=False))
    units = tuple(unit_of(low, high) for low, high in limits)
    phase = moved.problem.initial_phase
    curve = Curve(family, moved.periods, units, phase, moved, _CONDITIONS[point.kind])
    back, ahead = walk(curve, _start(curve, moved, values), limits, longest_step)
    pieces = joined(back, ahead)
    cusps = [
        SpecialPoint(
            "cusp", orbit.problem.nu, dict(zip(parameters, cusp.values, strict=True)), orbit
        )
        for piece in pieces
        for left, right in pairwise(piece.points)
        if point.kind == "fold"
        for _, cusp in search(piece.curve, left, right, [Test("cusp", _turned_back(left))])
        for orbit in (cusp.orbit.at_phase(problem.initial_phase),)
    ]
    points = points_of(pieces)
    return SpecialCurve(
        point.kind,
        parameters,
        np.array([one.values for one in points]),
        [one.orbit.at_phase(problem.initial_phase) for one in points],
        cusps,
        (back.reason, ahead.reason),
    )


def _start(curve: Curve, orbit: Shot, values: tuple[float, ...]) -> Point:
    """Return the first point of a curve, the tangent towards more of the second parameter."""
    place = np.append(orbit.state, np.divide(values, curve.units))
    directions = np.eye(place.size)
    for fixed in (-1, -2):
        try:
            return curve.point(place, directions[fixed], directions[-1])
        except NoOrbit as error:
            reason = error
    raise reason


def _turned_back(left: Point) -> Callable[[Point], float]:
    """Return the test for a cusp: there both parameters turn back."""
    return lambda point: float(point.tangent[-2:] @ left.tangent[-2:])


def _least_height(extrema: Extrema) -> Callable[[Shot], float]:
    """Return the height of the extremum that is nearest to 0."""

    def height(orbit: Shot) -> float:
        above = extrema(orbit)[:, 1]
        return float(above[np.argmin(np.abs(above))])

    return height


def _least_velocity(orbit: Shot) -> float:
    """Return the velocity at the switch of C(t) where it is least."""
    velocities = orbit.stiffness_jumps[:, VELOCITY]
    return float(velocities[np.argmin(np.abs(velocities))])


_CONDITIONS: dict[str, Callable[[Shot], float]] = {
    "fold": lambda orbit: float(np.linalg.det(orbit.gradient)),
    "flip": flip_test,
    "torus": torus_test,
    "grazing_front": _least_height(FRONT),
    "grazing_back": _least_height(BACK),
    "switching": _least_velocity,
}
