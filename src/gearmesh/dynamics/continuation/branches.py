"""Branches of orbits: how a periodic motion changes with a parameter, and where it ends."""

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import product
from typing import overload

import numpy as np

from gearmesh.dynamics.continuation.curves import Curve, Family, unit_of
from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.readings import extremes, judgements, multipliers
from gearmesh.dynamics.continuation.resampling import resampled
from gearmesh.dynamics.continuation.special_points import SpecialPoint, special_points
from gearmesh.dynamics.continuation.suspects import suspects
from gearmesh.dynamics.continuation.test_functions import bifurcation_values
from gearmesh.dynamics.continuation.tracing import first_values
from gearmesh.dynamics.continuation.walks import (
    CLOSED,
    LONGEST_STEP,
    Limits,
    Piece,
    Walk,
    check_inside,
    clear_phase,
    joined,
    points_of,
    walk,
)
from gearmesh.dynamics.periodic.general_search import in_all_coordinates
from gearmesh.dynamics.periodic.orbits import Orbit
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.errors import InputError, NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.runs import is_reducible

_AMPLITUDE = 1e-3  # of the first orbit after a flip


@dataclass(frozen=True)
class Branch:
    """A branch of period-n orbits.

    Attributes
    ----------
    parameter : str
        Name of the parameter.
    pieces : list of Piece
        The branch, piece by piece, in the order in which it is passed.
    phase : float
        Mesh phase at which the states of `orbits` are taken.
    located : list of (str, Point)
        Kinds and places of the special points, in their order along the branch.
    ends : tuple of two str
        Why the branch ends at its first and at its last point: `LIMIT`, `CLOSED`, `HALVED`, `FAR`,
        `LONG`, or the reason why the corrector failed.
    chosen : list of Piece, optional
        The pieces with points at chosen values of the parameter.
    """

    parameter: str
    pieces: list[Piece]
    phase: float
    located: list[tuple[str, Point]]
    ends: tuple[str, str]
    chosen: list[Piece] = field(default_factory=list)

    @cached_property
    def points(self) -> list[Point]:
        """The branch, point by point."""
        return points_of(self.chosen or self.pieces)

    def resampled(self, values: np.ndarray) -> "Branch":
        """Return the branch with points at values of the parameter instead of its own.

        Parameters
        ----------
        values : ndarray, shape (n,)

        Raises
        ------
        NoOrbit
            If the branch passes none of the values, or an orbit is not found.
        """
        chosen = resampled(self.pieces, np.unique(values), CLOSED in self.ends)
        if not chosen:
            raise NoOrbit(f"the branch passes none of the values of {self.parameter}")
        return replace(self, chosen=chosen)

    @cached_property
    def special(self) -> list[SpecialPoint]:
        """Special points in their order along the branch."""
        return [
            SpecialPoint(kind, orbit.problem.nu, {self.parameter: point.values[0]}, orbit)
            for kind, point in self.located
            for orbit in (point.orbit.at_phase(self.phase),)
        ]

    @cached_property
    def values(self) -> np.ndarray:
        """The parameter along the branch, shape (n,)."""
        return self._along(first_values)

    @cached_property
    def orbits(self) -> Sequence[Shot]:
        """The orbits at these values; each is computed when it is first asked for."""
        return _Orbits(self.points, self.phase)

    @property
    def y_max(self) -> np.ndarray:
        """Greatest y of each orbit."""
        return self._along(extremes)[:, 0]

    @property
    def y_min(self) -> np.ndarray:
        """Least y of each orbit."""
        return self._along(extremes)[:, 1]

    @property
    def stable(self) -> np.ndarray:
        """Whether each orbit is stable."""
        return self._along(judgements)[:, 0]

    @property
    def neutral(self) -> np.ndarray:
        """Whether each orbit is neutral."""
        return self._along(judgements)[:, 1]

    @property
    def multipliers(self) -> np.ndarray:
        """Floquet multipliers, shape (n, number of multipliers)."""
        return self._along(multipliers)

    def _along(self, read: Callable[[Sequence[Point]], np.ndarray]) -> np.ndarray:
        """Return what `read` finds in the points of each piece, for all points."""
        return np.concatenate([read(part) for part in self._parts if part])

    @cached_property
    def _parts(self) -> list[Sequence[Point]]:
        """The points of each piece, without those of the piece before."""
        first, *others = self.chosen or self.pieces
        return [first.points, *(one.points[1:] for one in others)]


class _Orbits(Sequence[Shot]):
    """The orbits of points of a branch at one mesh phase, each computed once, when asked for."""

    def __init__(self, points: Sequence[Point], phase: float) -> None:
        self._points, self._phase = points, phase
        self._known: dict[int, Shot] = {}

    def __len__(self) -> int:
        return len(self._points)

    @overload
    def __getitem__(self, at: int) -> Shot: ...

    @overload
    def __getitem__(self, at: slice) -> list[Shot]: ...

    def __getitem__(self, at: int | slice) -> Shot | list[Shot]:
        chosen = range(len(self))[at]
        if isinstance(chosen, range):
            return [self[i] for i in chosen]
        if chosen not in self._known:
            self._known[chosen] = self._points[chosen].orbit.at_phase(self._phase)
        return self._known[chosen]


def follow(
    orbit: Shot,
    parameter: str,
    limits: tuple[float, float],
    family: Family | None = None,
    value: float | None = None,
    longest_step: float = LONGEST_STEP,
) -> Branch:
    """Follow an orbit in one parameter, in both directions.

    The branch begins at the end with the lower value of the parameter, or with the lower greatest
    y if both values are the same.

    Parameters
    ----------
    orbit : Shot
        Where to start.
    parameter : str
        A field of `Problem`, or a name of what `family` varies.
    limits : tuple of float
        Range of the parameter.
    family : callable, optional
        The problem at a value of the parameter, if this is not a field of `Problem`.
    value : float, optional
        The parameter at `orbit`, if it is not a field of `Problem`.
    longest_step : float
        Longest step along the branch.

    Raises
    ------
    NoOrbit
        If the orbit is not on a branch of the family.
    """
    stretches = family is None and parameter == "nu"
    family = family or field_family(orbit.problem, parameter)
    value = float(getattr(orbit.problem, parameter)) if value is None else value
    low, high = limits
    check_inside(parameter, value, low, high)
    phase = orbit.problem.initial_phase
    orbit = orbit if stretches else in_coordinates_of(orbit, family, (limits,))
    moved = orbit.at_phase(clear_phase(orbit, stretches))
    curve = Curve(
        family,
        orbit.periods,
        (unit_of(low, high),),
        moved.problem.initial_phase,
        moved,
        stretches=stretches,
    )
    start = curve.at(moved, (value,))
    walks = walk(curve, start, (limits,), longest_step)
    # Near a branching the slope may be rounding, so the ends tell where the branch begins.
    back, ahead = sorted(walks, key=_place_of_end)
    pieces = joined(back, ahead)
    located = [*back.flip, *_special(pieces), *ahead.flip]
    return Branch(
        parameter,
        pieces,
        phase,
        located,
        (back.reason, ahead.reason),
    )


def _place_of_end(one: Walk) -> tuple[float, float]:
    """Return what tells which of two walks ends lower."""
    end = one.pieces[-1].points[-1]
    return end.values[0], end.motion.y_max


def field_family(problem: Problem, *names: str) -> Family:
    """Return the problems that differ from `problem` in the named fields."""
    changed: Callable[..., Problem] = partial(replace, problem)
    return lambda *values: changed(**dict(zip(names, values, strict=True)))


def in_coordinates_of(orbit: Shot, family: Family, limits: Limits) -> Shot:
    """Return an orbit in the coordinates that the problems of a family need within its limits."""
    if isinstance(orbit, Orbit):
        for corner in product(*limits):
            with contextlib.suppress(InputError):
                if not is_reducible(family(*corner)):
                    return in_all_coordinates(orbit)
    return orbit


def _special(pieces: list[Piece]) -> list[tuple[str, Point]]:
    return [
        found
        for piece in pieces
        for bifurcating in (bifurcation_values(piece.points),)
        for i, tests in suspects(piece.points, bifurcating)
        for found in special_points(piece.curve, piece.points, i, tests, bifurcating)
    ]


def double_period(point: SpecialPoint, family: Family | None = None) -> tuple[Shot, float]:
    """Return an orbit of twice the period, close to a flip, and the parameter there.

    Parameters
    ----------
    point : SpecialPoint
        Of kind ``"flip"``.
    family : callable, optional
        The problem at a value of the parameter, if this is not a field of `Problem`.

    Raises
    ------
    NoOrbit
        If the corrector does not converge.
    """
    ((parameter, value),) = point.parameters.items()
    stretches = family is None and parameter == "nu"
    family = family or field_family(point.orbit.problem, parameter)
    single = point.orbit.at_phase(clear_phase(point.orbit, stretches))
    phase = single.problem.initial_phase
    curve = Curve(family, 2 * single.periods, (1.0,), phase, single, stretches=stretches)
    across = np.linalg.svd(single.monodromy + np.eye(len(single.monodromy)))[2][-1]
    # Of the two sides, which are the same orbits a period later, rounding must not choose one.
    normal = np.append(across if across[0] > 0.0 else -across, 0.0)
    place = np.append(single.state, value) + _AMPLITUDE * normal
    found = curve.point(place, normal, normal)
    return found.orbit.at_phase(point.orbit.problem.initial_phase), found.values[0]
