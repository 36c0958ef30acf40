"""Periodic orbits and their branches, with units."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from gearmesh.dynamics import branches, orbits, special_curves, special_points
from gearmesh.dynamics.continuation import Family
from gearmesh.errors import InputError
from gearmesh.interface.statements import (
    Start,
    read_frequency,
    read_variant,
    with_settings,
)
from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH
from gearmesh.model.motion import state_at
from gearmesh.model.problem import Problem
from gearmesh.model.variants import Variant
from gearmesh.study import units
from gearmesh.study.pair import Pair

_REGIMES = {
    NORMAL_MESH: "normal_mesh",
    CONTACT_LOSS: "contact_loss",
    INVERSE_MESH: "inverse_mesh",
}

Limits = tuple[object, object]
"""Ends of a range: numbers in the parameter's unit, or texts with units."""


@dataclass(frozen=True)
class Orbit:
    """A periodic orbit of a gear pair.

    Attributes
    ----------
    pair : Pair
    variant : Variant
    nu : float
        Mesh frequency ν_s.
    found : gearmesh.dynamics.orbits.Orbit
        The orbit in dimensionless form, with its certificate.
    """

    pair: Pair
    variant: Variant
    nu: float
    found: orbits.Orbit = field(repr=False)

    @property
    def periods(self) -> int:
        """Least period in mesh periods."""
        return self.found.periods

    @property
    def multipliers(self) -> np.ndarray:
        """Floquet multipliers, complex, shape (4,), the largest modulus first."""
        return self.found.multipliers

    @property
    def stable(self) -> bool:
        """Whether all multipliers are inside the unit circle, and damping acts."""
        return self.found.stable

    @property
    def neutral(self) -> bool:
        """Whether no damping of the mesh acts along the orbit and nothing grows."""
        return self.found.neutral

    @property
    def signature(self) -> tuple[str, ...]:
        """Regimes of the mesh in their order over the orbit's own period."""
        return tuple(_REGIMES[regime] for regime in self.found.signature)

    @property
    def residual(self) -> float:
        """Distance between the states at the two ends of one period, in y_st."""
        return self.found.residual

    def to_dataset(self, samples_per_period: int = 256) -> xr.Dataset:
        """Return the orbit with its time course over its own period.

        Returns
        -------
        xarray.Dataset
            `y`, `v`, `a` and `regime` over ``time``; `strobe_y` and `strobe_v` (y and dy/dτ_s at
            the initial phase), `y_max`, `y_min`, `stable`, `neutral`, `residual`; `multipliers`.
            Lengths are in mm and, with ``_rel`` appended to the name, in static deflections.
        """
        course = self.found.time_course(samples_per_period)
        lengths: dict[str, tuple[tuple[str, ...], Any, str]] = {
            "y": (("time",), course.y, "relative motion in the mesh"),
            "v": (("time",), course.v, "relative velocity dy/dtau_s (tau_s = Omega_s t)"),
            "a": (("time",), course.a, "relative acceleration d2y/dtau_s2"),
            "strobe_y": ((), self.found.y, "relative motion y at the initial phase"),
            "strobe_v": ((), self.found.v, "relative velocity dy/dtau_s at the initial phase"),
            "y_max": ((), self.found.y_max, "maximum of y"),
            "y_min": ((), self.found.y_min, "minimum of y"),
        }
        dataset = _lengths(lengths, self.pair)
        time = course.time / self.pair.natural_frequency
        dataset = dataset.assign_coords(time=("time", time, {"units": "s", "long_name": "time"}))
        flags = {
            "units": "1",
            "long_name": "regime of the mesh",
            "flag_values": np.array(list(_REGIMES), np.int8),
            "flag_meanings": " ".join(_REGIMES.values()),
        }
        dataset["regime"] = ("time", course.regime, flags)
        for name, value, what in (
            ("stable", self.stable, "whether the orbit is stable"),
            ("neutral", self.neutral, "whether no damping acts along the orbit"),
            ("residual", self.residual, "distance from its start after one period, in y_st"),
            ("periods", self.periods, "least period in mesh periods"),
        ):
            dataset[name] = ((), value, {"units": "1", "long_name": what})
        stated = {"units": "1", "long_name": "Floquet multipliers"}
        dataset["multipliers"] = ("multiplier", self.multipliers, stated)
        dataset.attrs = {
            "variant": self.variant.name,
            "nu_s": self.nu,
            "signature": " ".join(self.signature),
            "parameters": self.pair.canonical(),
        }
        return dataset


def _lengths(
    stated: dict[str, tuple[tuple[str, ...], Any, str]], pair: Pair, **more: Any
) -> xr.Dataset:
    """Return lengths in mm and in static deflections."""
    dataset = xr.Dataset(**more)
    for name, (dimensions, values, what) in stated.items():
        values = np.asarray(values)
        in_mm = {"units": "mm", "long_name": what}
        relative = {"units": "1", "long_name": f"{what}, in static deflections y_st"}
        dataset[name] = (dimensions, values * pair.static_deflection, in_mm)
        dataset[f"{name}_rel"] = (dimensions, values, relative)
    return dataset


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


@dataclass(frozen=True)
class Branch:
    """A branch of orbits, as `follow` returns it.

    Attributes
    ----------
    orbit : Orbit
        Where the branch was entered.
    found : gearmesh.dynamics.branches.Branch
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
        """Why the branch ends at its first and at its last point."""
        return self.found.ends

    def at(self, point: int) -> Orbit:
        """Return the orbit at a point of the branch."""
        found, orbit = self.found.orbits[point], self.orbit
        pair = orbit.pair
        if self.parameter != "nu":
            pair = _replaced(pair, self.parameter, float(self.found.values[point]))
        return Orbit(pair, orbit.variant, found.problem.nu, found)

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
            `multipliers` (complex, over ``multiplier`` too). Lengths as in `Orbit.to_dataset`.
        """
        found, pair = self.found, self.orbit.pair
        dataset = _lengths(
            {
                "y_max": (("point",), found.y_max, "maximum of y"),
                "y_min": (("point",), found.y_min, "minimum of y"),
            },
            pair,
        )
        nu = np.array([orbit.problem.nu for orbit in found.orbits])
        for name, values, what in (
            ("nu", nu, "mesh frequency nu_s"),
            ("stable", found.stable, "whether the orbit is stable"),
            ("neutral", found.neutral, "whether no damping acts along the orbit"),
        ):
            dataset[name] = ("point", values, {"units": "1", "long_name": what})
        stated = {"units": "1", "long_name": "Floquet multipliers"}
        dataset["multipliers"] = (("point", "multiplier"), found.multipliers, stated)
        if self.parameter != "nu":
            unit, what = _declared(pair, self.parameter)
            stated = {"units": unit, "long_name": what}
            dataset[self.parameter] = ("point", found.values, stated)
        dataset.attrs = {"variant": self.orbit.variant.name, "parameters": pair.canonical()}
        return dataset


def find_orbit(
    pair: Pair,
    variant: str | Variant,
    nu: float,
    *,
    periods: int = 1,
    start: Start | Orbit | None = None,
) -> Orbit:
    """Find a periodic orbit.

    Parameters
    ----------
    pair : Pair
        The gear pair, without eccentricity, profile deviation and Fourier stiffness.
    variant : str or Variant
        Which damping terms act where.
    nu : float
        Mesh frequency ν_s.
    periods : int
        Its least period, in mesh periods.
    start : tuple or Orbit, optional
        (y, dy/dτ_s) at the initial phase near the orbit, each with its unit or as a number of
        static deflections; or an orbit nearby. By default several initial conditions are tried.

    Returns
    -------
    Orbit

    Raises
    ------
    NoOrbit
        If none is found; the message gives the reason.
    InputError
        One line, if an argument is wrong.

    Examples
    --------
    >>> import gearmesh as gm
    >>> orbit = gm.find_orbit(gm.paper(), "c-material", 0.7)
    >>> orbit.stable
    True
    """
    if isinstance(periods, bool) or not isinstance(periods, int) or not 1 <= periods <= 1000:
        raise InputError(f"periods: found {periods!r}; allowed is a whole number from 1 to 1000")
    chosen, frequency = read_variant(variant), read_frequency(nu)
    problem = pair.problem(chosen, frequency)
    state = None
    if isinstance(start, Orbit):
        state = start.found.state
    elif start is not None:
        begun = with_settings(pair, start).problem(chosen, frequency).initial_state
        begun = begun or state_at(problem)
        state = np.array([begun.y, begun.v, begun.b, begun.b_rate])
    return Orbit(pair, chosen, frequency, orbits.find_orbit(problem, periods, state))


def follow(orbit: Orbit, parameter: str, limits: Limits) -> Branch:
    """Follow an orbit in one parameter, in both directions.

    Parameters
    ----------
    orbit : Orbit
        Where to begin.
    parameter : str
        ``"nu"``, or any parameter of the pair that is a single number.
    limits : tuple
        Lowest and highest value, each a number in the parameter's unit or a text with its unit.

    Returns
    -------
    Branch
        Orbits along the branch, and its special points, located to 1e-8 in the parameter.

    Raises
    ------
    NoOrbit
        If the branch cannot be followed; the message gives the reason.
    InputError
        One line, if an argument is wrong.
    """
    family, (value,) = _family(orbit, (parameter,))
    found = branches.follow(
        orbit.found, parameter, _limits(orbit.pair, parameter, limits), family, value
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
        dataset = _lengths(heights, pair)
        for name, values in zip(self.found.parameters, self.found.values.T, strict=True):
            unit, what = _declared(pair, name)
            dataset[name] = ("point", values, {"units": unit, "long_name": what})
        dataset.attrs = {"kind": self.found.kind, "variant": self.point.orbit.variant.name}
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
    """
    orbit = point.orbit
    family, values = _family(orbit, parameters)
    first, second = (
        _limits(orbit.pair, name, ends) for name, ends in zip(parameters, limits, strict=True)
    )
    bare = special_points.SpecialPoint(point.kind, point.nu, point.parameters, orbit.found)
    found = special_curves.follow_special(bare, parameters, (first, second), family, values)
    return SpecialCurve(point, found)


def _special(point: special_points.SpecialPoint, orbit: Orbit) -> SpecialPoint:
    """Return a special point with the pair that it belongs to."""
    pair = orbit.pair
    for name, value in point.parameters.items():
        if name != "nu":
            pair = _replaced(pair, name, value)
    found = Orbit(pair, orbit.variant, point.nu, point.orbit)
    return SpecialPoint(point.kind, point.nu, dict(point.parameters), found)


def _family(orbit: Orbit, names: tuple[str, ...]) -> tuple[Family, tuple[float, ...]]:
    """Return the problems over some parameters, and the values of these at an orbit."""
    for name in names:
        _declared(orbit.pair, name)
    values = tuple(orbit.nu if name == "nu" else float(getattr(orbit.pair, name)) for name in names)

    def problem(*stated: float) -> Problem:
        pair, nu = orbit.pair, orbit.nu
        for name, value in zip(names, stated, strict=True):
            if name == "nu":
                nu = value
            else:
                pair = _replaced(pair, name, value)
        return pair.problem(orbit.variant, nu)

    if names == ("nu",):  # no parameter of the pair changes, so it need not be read again
        return branches.field_family(orbit.found.problem, "nu"), values
    made: Callable[..., Problem] = problem
    return made, values


def _replaced(pair: Pair, name: str, value: float) -> Pair:
    unit, _ = _declared(pair, name)
    return pair.replace(**{name: value if unit == "1" else f"{value!r} {unit}"})


def _declared(pair: Pair, name: str) -> tuple[str, str]:
    """Return unit and meaning of a parameter that can be followed."""
    if name == "nu":
        return "1", "mesh frequency nu_s"
    for row in pair.parameters:
        if row.name == name:
            if isinstance(row.value, float):
                return row.unit, row.description
            raise InputError(f"{name}: found {row.value!r}; allowed are single real numbers")
    raise InputError(f"{name}: no such parameter; 'gearmesh parameters' lists all")


def _limits(pair: Pair, name: str, limits: Limits) -> tuple[float, float]:
    """Read the ends of a range."""
    unit, _ = _declared(pair, name)
    try:
        low, high = (
            units.parse(end, unit) if isinstance(end, str) else float(end)  # type: ignore[arg-type]
            for end in limits
        )
    except (TypeError, ValueError) as error:
        raise InputError(f"limits of {name}: found {limits!r}; {error}") from None
    if not low < high:
        raise InputError(f"limits of {name}: found {limits!r}; allowed is (low, high)")
    return low, high
