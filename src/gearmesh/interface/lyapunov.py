"""Lyapunov exponents, with units."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from gearmesh.dynamics.attraction.lyapunov import spectrum_of
from gearmesh.interface.periodic import periodic_problem
from gearmesh.interface.statements import (
    Start,
    check_pair,
    read_frequencies,
    read_variant,
    read_whole,
    with_settings,
)
from gearmesh.model.variants import Variant
from gearmesh.study.pair import Pair

_MOST_PERIODS = 10_000_000


def lyapunov_spectrum(
    pair: Pair,
    variant: str | Variant,
    nu: float | str | Sequence[float | str] | np.ndarray,
    *,
    start: Start | None = None,
    periods: int = 1000,
    transient: int = 1000,
) -> xr.Dataset:
    """Return the Lyapunov exponents of a motion, from the Jacobians of its mesh periods.

    They are exact in the reduced system. Differences of sixth order give those of other pairs; the
    error of the exponents is then about 1e-9 Ω_s.

    Parameters
    ----------
    pair, variant
        As for `attractors`.
    nu : array_like
        One mesh frequency ν_s, or speed of wheel 3, or several.
    start : tuple, optional
        Initial condition (y, dy/dτ_s), as for `simulate`; by default that of the pair.
    periods : int
        Mesh periods over which growth is measured, at least 8.
    transient : int
        Mesh periods that the run takes before growth is measured. Both numbers are rounded up to
        whole periods of the excitation.

    Returns
    -------
    xarray.Dataset
        `exponents` over (nu, ``exponent``), the largest first, in 1/s and, as `exponents_rel`, in
        Ω_s; `errors` and `errors_rel`, their standard errors. A motion that runs away has
        not-a-number.

    Raises
    ------
    InputError
        One line, if an argument is wrong.

    Examples
    --------
    >>> import gearmesh as gm
    >>> found = gm.lyapunov_spectrum(gm.paper(), "c-material", 0.7, periods=100, transient=100)
    >>> bool(found.exponents[0, 0] < 0.0)
    True
    """
    check_pair(pair)
    nus = read_frequencies(nu, pair)
    periods = read_whole("periods", periods, 8, _MOST_PERIODS)
    transient = read_whole("transient", transient, 0, _MOST_PERIODS)
    begun = with_settings(pair, start)
    problems = [periodic_problem(begun, variant, one) for one in nus]
    spectra = [spectrum_of(one, periods, transient) for one in problems]
    dataset = xr.Dataset()
    for name, rates, what in (
        ("exponents", np.array([one.exponents for one in spectra]), "Lyapunov exponents"),
        ("errors", np.array([one.errors for one in spectra]), "standard errors of the exponents"),
    ):
        stated = {"units": "s-1", "long_name": what}
        dataset[name] = (("nu", "exponent"), rates * pair.natural_frequency, stated)
        stated = {"units": "1", "long_name": f"{what}, in Omega_s"}
        dataset[f"{name}_rel"] = (("nu", "exponent"), rates, stated)
    stated = {"units": "1", "long_name": "mesh frequency nu_s"}
    dataset = dataset.assign_coords(nu=("nu", nus, stated))
    dataset.attrs = {"variant": read_variant(variant).name, "parameters": begun.canonical()}
    return dataset
