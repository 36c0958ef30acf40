"""Attractors and basins, with units."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from gearmesh.dynamics.attraction import basins as dynamics
from gearmesh.dynamics.attraction.attractors import Attractor
from gearmesh.dynamics.attraction.basins import TRANSIENT
from gearmesh.dynamics.attraction.maps import map_of
from gearmesh.errors import InputError
from gearmesh.interface.lengths import with_lengths
from gearmesh.interface.orbits import REGIMES
from gearmesh.interface.periodic import periodic_problem
from gearmesh.interface.statements import (
    Start,
    read_lengths,
    read_variant,
    read_whole,
    several,
    with_settings,
)
from gearmesh.model.problem import Problem
from gearmesh.model.variants import Variant
from gearmesh.study.pair import Pair
from gearmesh.study.reading.schema import shown

_MOST_REVOLUTIONS = 100_000


def attractors(
    pair: Pair,
    variant: str | Variant,
    nu: float | str,
    *,
    starts: Sequence[Start] | None = None,
    revolutions: int = TRANSIENT,
) -> xr.Dataset:
    """Find the motions on which runs end.

    Parameters
    ----------
    pair : Pair
        The gear pair. If wheels are eccentric, a drive holds the speed, as for `find_orbit`.
    variant : str or Variant
        Which damping terms act where.
    nu : float or str
        Mesh frequency ν_s, or the speed of wheel 3, as ``"3000 rpm"``.
    starts : sequence of tuple, optional
        Initial conditions (y, dy/dτ_s), each with its unit or as a number of static deflections.
        By default the pair's own and a grid of 36.
    revolutions : int
        Revolutions of wheel 3 after which a motion that has not settled is classified as it is.
        They are rounded up to whole periods of the excitation.

    Returns
    -------
    xarray.Dataset
        Over ``attractor``: `label`; `kind` (``periodic``, ``neutral``, ``quasi-periodic``,
        ``chaotic``, ``moving`` or ``lost``); for an orbit its `periods`, `y_max`, `y_min`,
        `strobe_y`, `strobe_v` (at mesh phase 0), `signature`, `multipliers` and
        `time_constant` (mesh periods in which a deviation falls by e); `exponent_rel`, the largest
        Lyapunov exponent in Ω_s; and `starts`, the number of initial conditions that lead there.
        Lengths are in mm and, with ``_rel`` appended to the
        name, in static deflections.

        A label depends on the attractor alone, and so is the same in every dataset: the period and
        the stroboscopic point (y, dy/dτ_s) of greatest y at mesh phase 0, the middle of the C_max
        pulse, in static deflections; or the kind of a motion that is no orbit. Orbits are in the
        order of period and y_max; the other kinds follow. `multipliers` are complex, so
        ``to_netcdf`` and ``xarray.open_dataset`` need ``engine="netcdf4", auto_complex=True``.

    Raises
    ------
    InputError
        One line, if an argument is wrong.

    Examples
    --------
    >>> import gearmesh as gm
    >>> found = gm.attractors(gm.paper(), "c-material", 0.7)
    >>> found.kind.values.tolist()
    ['periodic']
    """
    problem = periodic_problem(pair, variant, nu)
    revolutions = read_whole("revolutions", revolutions, 1, _MOST_REVOLUTIONS)
    moved = map_of(problem)
    if starts is None:
        states = np.array([moved.start(problem), *dynamics.grid(problem)])
    else:
        begun = [with_settings(pair, start) for start in _sequence("starts", starts)]
        runs = [one.problem(read_variant(variant), problem.nu) for one in begun]
        states = np.array([moved.start(run) for run in runs])
    found = dynamics.reached(problem, states, revolutions)
    dataset = _described(found.attractors, pair, len(moved.weights))
    counts = np.bincount(found.labels, minlength=len(found.attractors))
    stated = {"units": "1", "long_name": "number of initial conditions that lead there"}
    dataset["starts"] = ("attractor", counts, stated)
    return _named(dataset, pair, variant, problem)


def basins(
    pair: Pair,
    variant: str | Variant,
    nu: float | str,
    *,
    y: object,
    v: object = 0.0,
    phase: object = None,
    revolutions: int = TRANSIENT,
) -> xr.Dataset:
    """Find the attractor to which each initial condition leads.

    Parameters
    ----------
    pair, variant, nu
        As for `attractors`.
    y, v : array_like
        Initial y and dy/dτ_s: one value or several, each with its unit or as a number of static
        deflections. The wheel bodies are in static equilibrium, and both wheels share the rotation
        that y takes, as for `simulate`.
    phase : array_like, optional
        Initial mesh phases, 0 to 1; by default that of the pair.
    revolutions : int
        As for `attractors`.

    Returns
    -------
    xarray.Dataset
        `reached` over (phase, y, v): the position on the axis ``attractor`` of the attractor to
        which the initial condition leads, so that ``ds.label[ds.reached]`` gives its label. Over
        ``attractor``: what `attractors` gives, and the share of the initial conditions (`share`)
        with the ends of its 95 % Wilson interval (`share_low`, `share_high`).

    Raises
    ------
    InputError
        One line, if an argument is wrong.

    Examples
    --------
    >>> import gearmesh as gm
    >>> found = gm.basins(gm.paper(), "b-material", 0.75, y=[0.0, 2.0], v=[-1.0, 1.0])
    >>> found.reached.shape
    (1, 2, 2)
    """
    problem = periodic_problem(pair, variant, nu)
    revolutions = read_whole("revolutions", revolutions, 1, _MOST_REVOLUTIONS)
    heights, rates = (
        _once(name, read_lengths(pair, name, values)) for name, values in (("y", y), ("v", v))
    )
    phases = _phases(pair, phase)
    _once("phase", phases % 1.0)
    found = dynamics.basins(problem, heights, rates, phases.tolist(), revolutions)
    dataset = _described(found.attractors, pair, len(map_of(problem).weights))
    for name, values, what in zip(
        ("share", "share_low", "share_high"),
        found.shares.T,
        ("", "lower end of the 95 % Wilson interval of the ", "upper end of that of the "),
        strict=True,
    ):
        stated = {"units": "1", "long_name": f"{what}share of the initial conditions"}
        dataset[name] = ("attractor", values, stated)
    axes = {
        "y": (("y",), heights, "initial relative motion y"),
        "v": (("v",), rates, "initial velocity dy/dtau_s"),
    }
    dataset = dataset.assign_coords(with_lengths(axes, pair.static_deflection).variables)
    stated = {"units": "1", "long_name": "initial mesh phase"}
    dataset = dataset.assign_coords(phase=("phase", phases, stated))
    stated = {"units": "1", "long_name": "position of the attractor that is reached"}
    dataset["reached"] = (("phase", "y", "v"), found.labels.astype(np.int16), stated)
    return _named(dataset, pair, variant, problem)


def _sequence(name: str, values: object) -> Sequence[Start]:
    if not isinstance(values, Sequence) or isinstance(values, str) or not values:
        raise InputError(f"{name}: found {shown(values)}; allowed is a list of (y, dy/dtau_s)")
    return values


def _once(name: str, values: np.ndarray) -> np.ndarray:
    """Return the values of an axis, each of which must be given once."""
    if len(set(values.tolist())) < len(values):
        raise InputError(f"{name}: a value occurs twice; allowed is each once")
    return values


def _phases(pair: Pair, phase: object) -> np.ndarray:
    if phase is None:
        return np.array([pair.initial_phase])
    phases = several(phase)
    if not phases:
        raise InputError("phase: none given; allowed is one phase or several")
    return np.array([pair.replace(initial_phase=one).initial_phase for one in phases])


def _described(found: Sequence[Attractor], pair: Pair, multipliers: int) -> xr.Dataset:
    """Return what is known of each attractor."""
    orbits = [one.orbit for one in found]
    lengths = {
        name: (("attractor",), [getattr(one, name) for one in found], what)
        for name, what in (
            ("y_max", "maximum of y"),
            ("y_min", "minimum of y"),
            ("strobe_y", "relative motion y at mesh phase 0"),
            ("strobe_v", "relative velocity dy/dtau_s at mesh phase 0"),
        )
    }
    dataset = with_lengths(lengths, pair.static_deflection)
    for name, numbers, what in (
        (
            "periods",
            [orbit.periods if orbit else 0 for orbit in orbits],
            "least period in mesh periods, 0 if it is no orbit",
        ),
        (
            "exponent_rel",
            [one.exponent for one in found],
            "largest Lyapunov exponent, in Omega_s",
        ),
        (
            "time_constant",
            [one.time_constant for one in found],
            "mesh periods in which a deviation falls by e",
        ),
    ):
        dataset[name] = ("attractor", numbers, {"units": "1", "long_name": what})
    nothing = np.full(multipliers, np.nan, complex)
    stated = {"units": "1", "long_name": "Floquet multipliers"}
    values = np.array([orbit.multipliers if orbit else nothing for orbit in orbits])
    dataset["multipliers"] = (("attractor", "multiplier"), values, stated)
    for name, texts, what in (
        ("label", [one.label for one in found], "name of the attractor in every dataset"),
        ("kind", [one.kind for one in found], "kind of motion"),
        (
            "signature",
            [
                " ".join(REGIMES[regime] for regime in orbit.signature) if orbit else ""
                for orbit in orbits
            ],
            "regimes of the mesh over the period of an orbit",
        ),
    ):
        dataset[name] = ("attractor", texts, {"long_name": what})
    return dataset


def _named(dataset: xr.Dataset, pair: Pair, variant: str | Variant, problem: Problem) -> xr.Dataset:
    dataset.attrs = {
        "variant": read_variant(variant).name,
        "nu_s": problem.nu,
        "parameters": pair.canonical(),
    }
    return dataset
