"""Branches of orbits and curves of special points, with units."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from gearmesh.dynamics.continuation import branches, special_curves, special_points
from gearmesh.dynamics.continuation.curves import Family
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.errors import InputError
from gearmesh.interface.lengths import with_lengths
from gearmesh.interface.orbits import Orbit
from gearmesh.interface.parameters import (
    Limits,
    declared,
    number_of,
    read_limits,
    read_values,
    static_deflection,
    with_number,
)
from gearmesh.interface.statements import read_whole
from gearmesh.model.problem import Problem
from gearmesh.study.reading.schema import shown


@dataclass(frozen=True)
class SpecialPoint:
    """A point of a branch where something changes.

    Attributes
    ----------
    kind : str
        ``"fold"``, ``"flip"``, ``"torus"``, ``"branch_point"``, ``"grazing_front"``,
        ``"grazing_back"``, ``"switching"`` or, on a curve of folds, ``"cusp"``.
    nu : float
        Mesh frequency ν_s.
    parameters : dict
        The parameters that are followed, by name, in their units.
    orbit : Orbit
        The orbit there.
    """

    kind: str
    nu: float
    parameters: dict[str, float]
    orbit: Orbit = field(repr=False)

    def double_period(self) -> Orbit:
        """Return an orbit of twice the period, close to this flip, from which to follow its branch.

        Raises
        ------
        InputError
            If the point is of another kind.
        NoOrbit
            If there is none nearby.
        """
        if self.kind != "flip":
            raise InputError(f"kind: found {self.kind!r}; only at a flip does the period double")
        (name,) = self.parameters
        family, _ = _family(self.orbit, (name,))
        bare = special_points.SpecialPoint(self.kind, self.nu, self.parameters, self.orbit.found)
        found, value = branches.double_period(bare, family)
        return _at_value(self.orbit, name, value, found)


@dataclass(frozen=True)
class Branch:
    """A branch of orbits, as `follow` returns it.

    Attributes
    ----------
    orbit : Orbit
        Where the branch was entered. It is no point of the branch unless it is an end.
    found : gearmesh.dynamics.continuation.branches.Branch
        The branch in dimensionless form.
    """

    orbit: Orbit
    found: branches.Branch = field(repr=False)

    @property
    def parameter(self) -> str:
        """Name of the parameter that is followed."""
        return self.found.parameter

    @property
    def ends(self) -> tuple[str, str]:
        """Why the branch ends at its first and at its last point.

        ``"limit"``, ``"closed"``, ``"half the period"``, ``"far"``, ``"too many points"``, or the
        reason why Newton's method failed.
        """
        return self.found.ends

    def at(self, point: int) -> Orbit:
        """Return the orbit at a point of the branch; negative numbers count from its end."""
        size = len(self.found.points)
        point = read_whole("point", point, -size, size - 1)
        found, value = self.found.orbits[point], float(self.found.values[point])
        return _at_value(self.orbit, self.parameter, value, found)

    def resampled(self, values: ArrayLike | Sequence[str]) -> "Branch":
        """Return the same branch with points at values of the parameter instead of its own.

        The orbits are predicted by polynomials through those of this branch, and corrected by
        Newton's method. So they are found faster than one by one. The first call with 128 values or
        more compiles code for about ten seconds.

        Parameters
        ----------
        values : array_like
            Numbers in the parameter's unit, or texts with units, as the limits of `follow`.

        Returns
        -------
        Branch
            One point for each passage of the branch through a value, in the order of the branch.
            Special points and ends stay as they are.

        Raises
        ------
        NoOrbit
            If the branch passes none of the values, or an orbit is not found.
        InputError
            One line, if a value is wrong.
        """
        wanted = read_values(self.orbit.pair, self.parameter, values)
        return Branch(self.orbit, self.found.resampled(wanted))

    @cached_property
    def special(self) -> list[SpecialPoint]:
        """Special points in their order along the branch."""
        return [_special(point, self.orbit) for point in self.found.special]

    def to_dataset(self) -> xr.Dataset:
        """Return the branch.

        Returns
        -------
        xarray.Dataset
            Over ``point``: the parameter, `nu`, `y_max`, `y_min`, `stable`, `neutral`, and
            `multipliers` (complex, over ``multiplier`` too). Lengths as in `Orbit.to_dataset`,
            whose notes state how to write the dataset.
        """
        found, pair = self.found, self.orbit.pair
        dataset = with_lengths(
            {
                "y_max": (("point",), found.y_max, "maximum of y"),
                "y_min": (("point",), found.y_min, "minimum of y"),
            },
            static_deflection(pair, (self.parameter,), found.values[:, None]),
        )
        nu = found.values
        if self.parameter != "nu":
            nu = np.full(found.values.shape, self.orbit.nu)
        for name, values, what in (
            ("nu", nu, "mesh frequency nu_s"),
            ("stable", found.stable, "whether the orbit is stable"),
            ("neutral", found.neutral, "whether no damping acts along the orbit"),
        ):
            dataset[name] = ("point", values, {"units": "1", "long_name": what})
        stated = {"units": "1", "long_name": "Floquet multipliers"}
        dataset["multipliers"] = (("point", "multiplier"), found.multipliers, stated)
        if self.parameter != "nu":
            unit, what = declared(pair, self.parameter)
            stated = {"units": unit, "long_name": what}
            dataset[self.parameter] = ("point", found.values, stated)
        dataset.attrs = {"variant": self.orbit.variant.name, "parameters": pair.canonical()}
        return dataset


def follow(orbit: Orbit, parameter: str, limits: Limits) -> Branch:
    """Follow an orbit in one parameter, in both directions.

    Parameters
    ----------
    orbit : Orbit
        Where to begin.
    parameter : str
        ``"nu"``, or any parameter of the pair that is a single number, or the same for both
        wheels.
    limits : tuple
        Lowest and highest value, each a number in the parameter's unit or a text with its unit,
        such as ``"5 y_st"`` for a length or ``"3000 rpm"`` for ``"nu"``.

    Returns
    -------
    Branch
        Orbits along the branch, and its special points, located to 1e-8 in the parameter. If the
        pair has terms that only the general solver knows, a `torus` point closer than 1e-6 to a
        grazing is located only to 1e-7.

    Raises
    ------
    NoOrbit
        If the branch cannot be followed; the message gives the reason.
    InputError
        One line, if an argument is wrong.
    """
    if not isinstance(orbit, Orbit):
        raise InputError(f"orbit: found {shown(orbit)}; allowed is an Orbit of find_orbit")
    family, (value,) = _family(orbit, (parameter,))
    found = branches.follow(
        orbit.found, parameter, read_limits(orbit.pair, parameter, limits), family, value
    )
    return Branch(orbit, found)


@dataclass(frozen=True)
class SpecialCurve:
    """A curve of special points in two parameters, as `follow_special` returns it."""

    point: SpecialPoint
    found: special_curves.SpecialCurve = field(repr=False)

    @cached_property
    def cusps(self) -> list[SpecialPoint]:
        """Of a curve of folds: where two folds meet and vanish."""
        return [_special(cusp, self.point.orbit) for cusp in self.found.cusps]

    def to_dataset(self) -> xr.Dataset:
        """Return the curve over ``point``: both parameters, and `y_max` and `y_min` there."""
        pair = self.point.orbit.pair
        heights: dict[str, tuple[tuple[str, ...], Any, str]] = {
            name: (("point",), [getattr(orbit, name) for orbit in self.found.orbits], what)
            for name, what in (("y_max", "maximum of y"), ("y_min", "minimum of y"))
        }
        y_st = static_deflection(pair, self.found.parameters, self.found.values)
        dataset = with_lengths(heights, y_st)
        for name, values in zip(self.found.parameters, self.found.values.T, strict=True):
            unit, what = declared(pair, name)
            dataset[name] = ("point", values, {"units": unit, "long_name": what})
        dataset.attrs = {
            "kind": self.found.kind,
            "variant": self.point.orbit.variant.name,
            "parameters": pair.canonical(),
        }
        return dataset


def follow_special(
    point: SpecialPoint, parameters: tuple[str, str], limits: tuple[Limits, Limits]
) -> SpecialCurve:
    """Follow a special point in two parameters, in both directions.

    Parameters
    ----------
    point : SpecialPoint
        Of a branch.
    parameters : tuple of two str
        ``"nu"`` and a parameter of the pair, or two parameters.
    limits : tuple of two tuples
        Range of each parameter, as for `follow`.

    Raises
    ------
    NoOrbit
        If the curve cannot be followed; the message gives the reason.
    InputError
        One line, if an argument is wrong.
    """
    if not isinstance(point, SpecialPoint):
        raise InputError(f"point: found {shown(point)}; allowed is one of Branch.special")
    names, ranges = _two("parameters", parameters), _two("limits", limits)
    orbit = point.orbit
    family, values = _family(orbit, names)
    if names[0] == names[1]:
        raise InputError(f"parameters: found {names[0]!r} twice; allowed are two different ones")
    first, second = (
        read_limits(orbit.pair, name, ends) for name, ends in zip(names, ranges, strict=True)
    )
    bare = special_points.SpecialPoint(point.kind, point.nu, point.parameters, orbit.found)
    found = special_curves.follow_special(bare, names, (first, second), family, values)
    return SpecialCurve(point, found)


def _two(name: str, values: object) -> tuple[Any, Any]:
    """Return what a curve in two parameters needs of each."""
    if not isinstance(values, tuple | list) or len(values) != 2:
        raise InputError(f"{name}: found {shown(values)}; allowed are two, one for each parameter")
    return values[0], values[1]


def _special(point: special_points.SpecialPoint, orbit: Orbit) -> SpecialPoint:
    """Return a special point with the pair that it belongs to."""
    found = orbit
    for name, value in point.parameters.items():
        found = _at_value(found, name, value, point.orbit)
    return SpecialPoint(point.kind, point.nu, dict(point.parameters), found)


def _at_value(orbit: Orbit, name: str, value: float, found: Shot) -> Orbit:
    """Return an orbit that was found at a value of a parameter of another one."""
    pair = orbit.pair if name == "nu" else with_number(orbit.pair, name, value)
    return Orbit(pair, orbit.variant, found.problem.nu, found)


def _family(orbit: Orbit, names: tuple[str, ...]) -> tuple[Family | None, tuple[float, ...]]:
    """Return the problems over some parameters, and the values of these at an orbit.

    If nu alone varies, there is no such function, because no parameter of the pair changes.
    """
    for name in names:
        declared(orbit.pair, name)
    values = tuple(orbit.nu if name == "nu" else number_of(orbit.pair, name) for name in names)

    def problem(*stated: float) -> Problem:
        pair, nu = orbit.pair, orbit.nu
        for name, value in zip(names, stated, strict=True):
            if name == "nu":
                nu = value
            else:
                pair = with_number(pair, name, value)
        return pair.problem(orbit.variant, nu)

    return (None if names == ("nu",) else problem), values
