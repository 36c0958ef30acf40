"""Simulate one run, or sweep many."""

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
import xarray as xr

from gearmesh.data.labelled import final_state, grid_dataset, run_dataset
from gearmesh.dynamics.sweeps import run_chains
from gearmesh.errors import InputError
from gearmesh.interface.parameters import number_of
from gearmesh.interface.statements import (
    Start,
    check_direction,
    check_pair,
    check_samples,
    read_frequencies,
    read_frequency,
    read_variant,
    read_variants,
    several,
    with_settings,
)
from gearmesh.model.problem import Problem
from gearmesh.model.variants import Variant
from gearmesh.solvers import simulation
from gearmesh.solvers.response import Response
from gearmesh.study.alternatives import DECLARED
from gearmesh.study.cases import Case
from gearmesh.study.pair import Pair
from gearmesh.study.reading.schema import shown
from gearmesh.study.speeds import check_constant_speed, is_speed


def simulate(
    pair: Pair,
    variant: str | Variant,
    nu: float | str,
    *,
    revolutions: int | None = None,
    kept: int | None = None,
    samples_per_period: int | None = None,
    start: Start | xr.Dataset | None = None,
    tolerance: float | None = None,
) -> xr.Dataset:
    """Integrate one run, and return it with its time course.

    Parameters
    ----------
    pair : Pair
        The gear pair; `gearmesh.paper` returns the paper's.
    variant : str or Variant
        Which damping terms act where, as ``"c-lubricant"`` (``gearmesh variants`` lists all).
    nu : float or str
        Mesh frequency ν_s = ω_c/Ω_s, or the speed of wheel 3, as ``"3000 rpm"``. It is that at the
        start if the pair states `final_nu` or `final_speed`, the end of a speed ramp.
    revolutions, kept, samples_per_period : int, optional
        Revolutions that are run, how many of the last are kept, and samples of the time course
        in a mesh period; by default those of the pair (5, 1 and 256 in the paper).
    start : tuple or Dataset, optional
        Initial condition: (y, dy/dτ_s), each with its unit or as a number of static deflections;
        or an earlier run, which this run continues as if there had been no interruption (bit for
        bit if all of its revolutions are kept). By default static equilibrium.
    tolerance : float, optional
        Local error tolerance, relative to y_st and y_st Ω_s; by default that of the pair (1e-10).

    Returns
    -------
    xarray.Dataset
        The variables of a case file. The time course has the coordinate ``time`` (s); lengths are
        in mm and, with ``_rel`` appended to the name, in static deflections. `status` is 0 (ok), or
        the reason why the run could not be integrated. A speed ramp has the coordinates ``nu`` and
        ``speed`` (rpm) over ``time``, and `period_y_max` and `period_y_min` over the kept mesh
        periods with ``period_nu`` and ``period_speed``.

    Raises
    ------
    InputError
        One line, if an argument is wrong.

    Examples
    --------
    >>> import gearmesh as gm
    >>> ds = gm.simulate(gm.paper(), "c-lubricant", nu=0.66)
    >>> float(ds.y_max_rel) > 1.0
    True
    """
    earlier = start if isinstance(start, xr.Dataset) else None
    pair = with_settings(
        pair,
        None if isinstance(start, xr.Dataset) else start,
        allowed="(y, dy/dtau_s), or the dataset of an earlier run",
        revolutions=revolutions,
        kept_revolutions=kept,
        samples_per_period=samples_per_period,
        tolerance=tolerance,
    )
    case = Case(read_variant(variant), read_frequency(nu, pair), time_course=True)
    problem = pair.problem(case.variant, case.nu)
    if earlier is not None:
        problem = replace(problem, initial_state=final_state(earlier))
    [response] = simulation.simulate([problem], pair.tolerance, pair.samples_per_period)
    return run_dataset(response, pair, case)


def sweep(
    pair: Pair,
    variants: str | Variant | Sequence[str | Variant],
    nu: float | str | Sequence[float | str] | np.ndarray,
    *,
    over: Mapping[str, Sequence[object]] | None = None,
    direction: Literal["up", "down"] | None = None,
    loads: bool = False,
    revolutions: int | None = None,
    kept: int | None = None,
    start: Start | None = None,
    tolerance: float | None = None,
) -> xr.Dataset:
    """Integrate runs over variants, mesh frequencies and, if wanted, parameters.

    Parameters
    ----------
    pair : Pair
        The gear pair.
    variants : str, Variant or sequence of these
        Which damping terms act where.
    nu : array_like
        Mesh frequencies ν_s, or speeds of wheel 3, as ``"3000 rpm"``.
    over : mapping of str to sequence, optional
        Parameters to vary and their values, as ``{"backlash": ["40 um", "8 y_st"]}``.
    direction : {"up", "down"}, optional
        Start each run from the end of the run at the next lower (``"up"``) or higher ν_s. By
        default all runs have the same initial condition.
    loads : bool
        Whether to measure tooth forces, dynamic factors, transmission errors and bearing forces,
        too. They are measured on the time course, which takes a while.
    revolutions, kept, start, tolerance
        As for `simulate`.

    Returns
    -------
    xarray.Dataset
        The scalars of a case file over (variant, nu, *parameters*), extrema over one more axis
        (``extremum``, filled with not-a-number) and stroboscopic points over ``boundary``.

    Raises
    ------
    InputError
        One line, if an argument is wrong.

    Examples
    --------
    >>> import numpy as np
    >>> import gearmesh as gm
    >>> ds = gm.sweep(gm.paper(), ["c-material", "c-lubricant"], np.linspace(0.6, 0.7, 11))
    >>> ds.y_max.sizes["nu"]
    11
    """
    check_pair(pair)
    check_direction(direction)
    chosen, nus = read_variants(variants), read_frequencies(nu, pair)
    pair = with_settings(
        pair, start, revolutions=revolutions, kept_revolutions=kept, tolerance=tolerance
    )
    varied = _read_over(over)
    pairs = [
        pair.replace(**dict(zip(varied, values, strict=True)))
        for values in itertools.product(*varied.values())
    ]
    for one in (pair, *pairs):
        check_constant_speed(one, "each run of a sweep")
    _check_speeds(nu, [pair, *pairs])
    if loads:
        check_samples(pairs, len(chosen) * len(nus))
    order = sorted(nus, reverse=direction == "down")
    places = list(itertools.product(chosen, pairs))
    chains = [[one.problem(variant, x) for x in order] for variant, one in places]
    responses = _integrated(chains, [one for _, one in places], direction is not None, loads)
    at = {x: i for i, x in enumerate(order)}
    cells = [(i * len(pairs) + j, at[x]) for i in range(len(chosen)) for x in nus
             for j in range(len(pairs))]  # fmt: skip
    rows = [responses[chain][place] for chain, place in cells]
    states = [chains[chain][place] for chain, place in cells] if loads else None
    axes: dict[str, Sequence[object]] = {"variant": [variant.name for variant in chosen], "nu": nus}
    axes |= {name: _axis(name, values, pair) for name, values in varied.items()}
    dataset = grid_dataset(rows, pairs * (len(rows) // len(pairs)), axes, states)
    return _described(dataset, pair, varied)


def _read_over(over: object) -> dict[str, list[object]]:
    """Return the parameters to vary with the list of their values."""
    if over is None:
        return {}
    if not isinstance(over, Mapping):
        raise InputError(
            f"over: found {shown(over)}; allowed is a mapping of names to lists of values"
        )
    found: dict[str, list[object]] = {}
    for name, values in over.items():
        if not isinstance(name, str):
            raise InputError(f"over: found the name {shown(name)}; allowed is a text")
        listed = isinstance(values, Iterable) and not isinstance(values, str | Mapping)
        found[name] = several(list(values) if isinstance(values, Iterator) else values)
        if not listed or not found[name]:
            raise InputError(
                f"over: {name}: found {shown(values)}; allowed is a list of one value or more"
            )
    return found


def _integrated(
    chains: Sequence[Sequence[Problem]], pairs: Sequence[Pair], continued: bool, loads: bool
) -> list[list[Response]]:
    """Integrate each chain with the settings of its pair, those with equal settings together.

    Unless the chains are continued, all of their runs begin from their own initial conditions.
    """
    settings = [(one.tolerance, one.samples_per_period if loads else 0) for one in pairs]
    found: dict[int, list[Response]] = {}
    for tolerance, samples in dict.fromkeys(settings):
        places = [i for i, stated in enumerate(settings) if stated == (tolerance, samples)]
        if continued:
            together = run_chains([chains[i] for i in places], tolerance, samples)
        else:
            runs = [problem for i in places for problem in chains[i]]
            responses = iter(simulation.simulate(runs, tolerance, samples))
            together = [list(itertools.islice(responses, len(chains[i]))) for i in places]
        found.update(zip(places, together, strict=True))
    return [found[i] for i in range(len(chains))]


def _check_speeds(nu: object, pairs: Sequence[Pair]) -> None:
    """Refuse speeds where a parameter that is varied gives each another ν_s."""
    if len({one.resonance_speed for one in pairs}) > 1:
        for value in several(nu):
            if is_speed(value):
                raise InputError(
                    f"nu: found {shown(value)}, but ν_s at a speed changes with a parameter in "
                    "over; allowed are numbers ν_s"
                )


def _axis(name: str, values: Sequence[object], pair: Pair) -> list[float]:
    """Return the values of a parameter in its unit, as an axis."""
    found = [number_of(pair.replace(**{name: value}), name) for value in values]
    for stated, value in zip(values, found, strict=True):
        if not isinstance(value, int | float):
            raise InputError(f"over: {name}: found {shown(stated)}; allowed are single numbers")
    return found


def _described(dataset: xr.Dataset, pair: Pair, over: Mapping[str, object]) -> xr.Dataset:
    """Give the axes of a sweep their units and names."""
    dataset["nu"].attrs = {"units": "1", "long_name": "mesh frequency nu_s"}
    dataset["variant"].attrs = {"long_name": "damping variant"}
    for name in over:
        declared = DECLARED[name]
        dataset[name].attrs = {"units": declared["unit"], "long_name": declared["description"]}
    dataset.attrs = {"parameters": pair.canonical()}
    return dataset
