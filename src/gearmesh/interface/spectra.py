"""Spectra over orders: of one run, and of a sweep over speeds as a Campbell map."""

import json
from collections.abc import Sequence
from numbers import Real
from typing import Literal

import numpy as np
import xarray as xr

from gearmesh.data.casefile import LOAD_SAMPLE_FIELDS, SAMPLE_FIELDS
from gearmesh.data.labelled import run_dataset
from gearmesh.dynamics.sweeps import run_chains
from gearmesh.errors import InputError
from gearmesh.interface.statements import (
    check_direction,
    check_pair,
    check_samples,
    read_frequencies,
    read_variant,
    with_settings,
)
from gearmesh.model.variants import Variant
from gearmesh.study.cases import Case
from gearmesh.study.pair import Pair
from gearmesh.study.reading.schema import shown
from gearmesh.study.speeds import check_constant_speed

_SPECTRA = {
    field.name: field
    for field in (*SAMPLE_FIELDS, *LOAD_SAMPLE_FIELDS)
    if field.kind == "f8" and field.name != "time"
}
"""Quantities that have a spectrum."""


def spectrum(run: xr.Dataset, *quantities: str) -> xr.Dataset:
    """Return the amplitudes of a run's time course over orders.

    Parameters
    ----------
    run : Dataset
        What `simulate` returns, or a case file with its time course.
    *quantities : str
        Variables over time; by default ``"force_normal"`` and ``"transmission_error"``.

    Returns
    -------
    xarray.Dataset
        Each quantity over ``order``, the multiple of the mesh frequency, in its own unit: the mean
        at order 0, amplitudes of cosines elsewhere. `shaft_order` is the multiple of the speed of
        wheel 3 and `frequency` is in Hz. The kept revolutions are taken as one period, so n of
        them resolve 1/n of a shaft order. In a speed ramp the samples are equally spaced in the
        angle of the wheels, so the orders hold, and `frequency` belongs to the mean speed.

    Raises
    ------
    InputError
        One line, if the run has no such time course.

    Examples
    --------
    >>> import gearmesh as gm
    >>> run = gm.simulate(gm.paper(), "c-both", nu=0.8)
    >>> tooth = gm.spectrum(run).sel(order=1.0)
    >>> float(tooth.force_normal) > 0.0
    True
    """
    if not isinstance(run, xr.Dataset):
        raise InputError(f"run: found {shown(run)}; allowed is a dataset, as simulate returns it")
    quantities = quantities or ("force_normal", "transmission_error")
    for name in quantities:
        if not isinstance(name, str) or name not in _SPECTRA or name not in run:
            there = [known for known in _SPECTRA if known in run]
            allowed = f"allowed are {', '.join(there)}" if there else "the run has no time course"
            raise InputError(f"spectrum: found {shown(name)}; {allowed}")
    (dimension,) = run[quantities[0]].dims
    size = run.sizes[dimension]
    teeth = np.ravel(json.loads(run.attrs["parameters"])["teeth"])[0]
    step, period = float(run["time"][1] - run["time"][0]), float(run["mesh_period"])
    periods = run.sizes.get("period") or round(size * step / period)
    order = np.arange(size // 2 + 1) / periods
    found = xr.Dataset(coords=_orders(order, order / period, teeth))
    for name in quantities:
        stated = {**run[name].attrs, "long_name": f"amplitude: {run[name].attrs['long_name']}"}
        found[name] = ("order", _amplitudes(run[name].values), stated)
    found.attrs = dict(run.attrs)
    return found


def campbell(
    pair: Pair,
    variant: str | Variant,
    nu: Sequence[float | str] | np.ndarray,
    *,
    quantity: str = "force_normal",
    highest_order: float = 5.0,
    direction: Literal["up", "down"] | None = None,
    revolutions: int | None = None,
    kept: int | None = None,
) -> xr.Dataset:
    """Return the spectra of runs at several speeds, as a map over speed and order.

    Parameters
    ----------
    pair : Pair
        The gear pair.
    variant : str or Variant
        Which damping terms act where.
    nu : array_like
        Mesh frequencies ν_s, or speeds of wheel 3, as ``"3000 rpm"``.
    quantity : str
        As for `spectrum`.
    highest_order : float
        Highest multiple of the mesh frequency that is kept.
    direction, revolutions, kept
        As for `sweep`.

    Returns
    -------
    xarray.Dataset
        The amplitudes over (nu, order), with the coordinates `speed` (rpm) and `shaft_order`, and
        `frequency` (Hz) over both.

    Raises
    ------
    InputError
        One line, if an argument is wrong or a run cannot be integrated.
    """
    check_pair(pair)
    check_direction(direction)
    if not isinstance(highest_order, Real) or not highest_order >= 0.0:
        raise InputError(f"highest_order: found {shown(highest_order)}; allowed is 0 or more")
    check_constant_speed(pair, "a map over speeds")
    chosen, nus = read_variant(variant), sorted(read_frequencies(nu, pair))
    pair = with_settings(pair, revolutions=revolutions, kept_revolutions=kept)
    check_samples([pair], len(nus))
    if direction == "down":
        nus.reverse()
    problems = [pair.problem(chosen, one) for one in nus]
    chains = [problems] if direction else [[problem] for problem in problems]
    responses = run_chains(chains, pair.tolerance, pair.samples_per_period, estimate_errors=False)
    rows = []
    for one, response in zip(nus, (r for chain in responses for r in chain), strict=True):
        if response.samples is None:
            raise InputError(f"nu: the run at {one:g} failed: {response.status}")
        run = run_dataset(response, pair, Case(chosen, one))
        amplitudes = spectrum(run, quantity)
        rows.append(amplitudes.sel(order=slice(None, highest_order)).assign_coords(nu=one))
    found = xr.concat(rows, "nu", coords=["frequency"]).sortby("nu")
    found.attrs = {"variant": chosen.name, "parameters": pair.canonical()}
    return _with_speeds(found, pair)


def _amplitudes(values: np.ndarray) -> np.ndarray:
    """Return the mean, and the amplitudes of the cosines."""
    found = np.abs(np.fft.rfft(values)) / values.size
    doubled = slice(1, (values.size + 1) // 2)
    found[doubled] *= 2.0
    return found


def _orders(
    order: np.ndarray, frequency: np.ndarray, teeth: int
) -> dict[str, tuple[str, np.ndarray, dict[str, str]]]:
    return {
        "order": ("order", order, {"units": "1", "long_name": "order of the mesh frequency"}),
        "shaft_order": (
            *("order", order * teeth),
            {"units": "1", "long_name": "order of the speed of wheel 3"},
        ),
        "frequency": ("order", frequency, {"units": "Hz", "long_name": "frequency"}),
    }


def _with_speeds(found: xr.Dataset, pair: Pair) -> xr.Dataset:
    found["nu"].attrs = {"units": "1", "long_name": "mesh frequency nu_s"}
    stated = {"units": "rpm", "long_name": "speed of wheel 3"}
    speed = found["nu"].values * pair.resonance_speed
    return found.assign_coords(speed=("nu", speed, stated))
