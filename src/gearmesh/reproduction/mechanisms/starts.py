"""What becomes of a start: basins over (y, y'), and the share of starting phases that jump.

Both are measured on runs of c-•, whose second jump is the edge of a basin: below it the motion in
contact and the resonant orbit with contact loss exist side by side.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from gearmesh.interface.lengths import with_lengths
from gearmesh.model.problem import Problem
from gearmesh.model.variants import variant
from gearmesh.study.pair import Pair

VARIANT = "c-lubricant"

BASINS_AT = (0.72, 0.76, 0.785)
"""Mesh frequencies of the basins: three between the fold and the grazing of the orbit."""

HEIGHTS, RATES = (-1.0, 5.0), (-2.0, 4.0)
"""Ranges of y and y' of the starts of a basin, in static deflections."""

REVOLUTIONS = 20
"""Revolutions after which a basin is judged."""

IN_CONTACT, RESONANT, OTHER = range(3)
MOTIONS = {
    IN_CONTACT: "rings_on_and_at_most_grazes",
    RESONANT: "resonant_orbit_with_contact_loss",
    OTHER: "another_motion",
}
"""What a start leads to."""

_GRAZES = 0.1  # greatest depth below y = 0, in y_st, of motion that at most grazes
_NEAR = 0.15  # of the extremes of the resonant orbit, in y_st

PHASES_FROM, PHASES_TO, PHASES_STEP = 0.6, 0.85, 0.005
CHECKED_AFTER = (5, 50)
"""Revolutions after which the share of starting phases that have jumped is measured."""

JUMPED = 0.05
"""Least share of contact loss in the last revolution of a run that has jumped (claim F3.5)."""


def basins(pair: Pair, branches: xr.Dataset, resolution: int) -> xr.Dataset:
    """Return what the starts of a grid of y and y' lead to, at three frequencies.

    Parameters
    ----------
    pair : Pair
        The gear pair.
    branches : xarray.Dataset
        Its branches, see `gearmesh.reproduction.mechanisms.tables`.
    resolution : int
        Starts along each axis.
    """
    # numba is loaded at the first run: code that only reads results imports this module, too.
    from gearmesh.dynamics.starts import initial_states
    from gearmesh.solvers.reduced.ensembles import laws_of, measure

    heights, rates = np.linspace(*HEIGHTS, resolution), np.linspace(*RATES, resolution)
    problems = _problems(pair, BASINS_AT)
    states = np.concatenate([initial_states(problem, heights, rates) for problem in problems])
    laws = np.repeat(laws_of(problems, pair.tolerance), resolution**2)
    teeth = problems[0].teeth
    measured = measure(laws, states, REVOLUTIONS * teeth, teeth)
    shape = len(BASINS_AT), resolution, resolution
    high, low = (measured[name].reshape(shape) for name in _EXTREMES)
    dataset = with_lengths(
        {
            "y_max": (("nu", "y", "v"), high, "maximum of y in the last revolution"),
            "y_min": (("nu", "y", "v"), low, "minimum of y in the last revolution"),
        },
        pair.static_deflection,
    )
    orbits = [resonant_orbit(branches, nu) for nu in BASINS_AT]
    top, bottom = (np.array(one).reshape(-1, 1, 1) for one in zip(*orbits, strict=True))
    near = (np.abs(high - top) < _NEAR) & (np.abs(low - bottom) < _NEAR)
    reached = np.where(near, RESONANT, np.where(low > -_GRAZES, IN_CONTACT, OTHER))
    flags = {
        "flag_values": np.array(list(MOTIONS), np.int8),
        "flag_meanings": " ".join(MOTIONS.values()),
        "long_name": "motion that the start leads to",
        "units": "1",
    }
    dataset["reached"] = (("nu", "y", "v"), reached.astype(np.int8), flags)
    axes = {
        "y": (("y",), heights, "initial relative motion y"),
        "v": (("v",), rates, "initial velocity dy/dtau_s"),
    }
    dataset = dataset.assign_coords(with_lengths(axes, pair.static_deflection).variables)
    dataset = dataset.assign_coords(nu=_frequencies(BASINS_AT))
    dataset.attrs = {"variant": VARIANT, "revolutions": REVOLUTIONS}
    return dataset


_EXTREMES = ("y_max", "y_min")


def resonant_orbit(branches: xr.Dataset, nu: float) -> tuple[float, float]:
    """Return y_max and y_min, in y_st, of the stable orbit with contact loss at a frequency."""
    chosen = (branches["variant"] == VARIANT) & (branches["periods"] == 1)
    chosen &= (branches["stability"] == 1) & (branches["y_min_rel"] < -_GRAZES)
    points = branches.isel(point=np.flatnonzero(chosen)).sortby("nu")
    return tuple(
        float(np.interp(nu, points["nu"], points[f"{name}_rel"], left=np.nan, right=np.nan))
        for name in _EXTREMES
    )  # type: ignore[return-value]


def phases(pair: Pair, resolution: int) -> xr.Dataset:
    """Return what becomes of the study's start at each starting phase, over ν_s.

    Parameters
    ----------
    pair : Pair
        The gear pair.
    resolution : int
        Starting phases, evenly spaced over the mesh period.
    """
    from gearmesh.solvers.reduced.ensembles import laws_of, measure

    count = round((PHASES_TO - PHASES_FROM) / PHASES_STEP) + 1
    nus = np.round(np.linspace(PHASES_FROM, PHASES_TO, count), 10)
    starts = np.arange(resolution) / resolution
    problems = [
        replace(problem, initial_phase=float(phase))
        for problem in _problems(pair, nus)
        for phase in starts
    ]
    laws, teeth = laws_of(problems, pair.tolerance), problems[0].teeth
    states, done, found = laws["start"], 0, []
    for revolutions in CHECKED_AFTER:
        # A run goes on from its end: whole revolutions leave the mesh phase as it is.
        measured = measure(laws, states, (revolutions - done) * teeth, teeth)
        found.append((measured["y_max"], measured["loss_time"] / (teeth * laws["period"])))
        states, done = measured["final"], revolutions
    shape = len(CHECKED_AFTER), 2, count, resolution
    high, loss = np.moveaxis(np.reshape(found, shape), 1, 0)
    axes = "revolutions", "nu", "phase"
    dataset = with_lengths(
        {"y_max": (axes, high, "maximum of y in the last revolution")}, pair.static_deflection
    )
    stated = {"units": "1", "long_name": "share of contact loss in the last revolution"}
    dataset["contact_loss_fraction"] = (axes, loss, stated)
    stated = {"units": "1", "long_name": "share of the starting phases that have jumped"}
    dataset["share"] = (axes[:2], (loss >= JUMPED).mean(axis=2), stated)
    count_of = {"units": "1", "long_name": "revolutions from the start"}
    phase = {"units": "1", "long_name": "starting phase in the mesh period"}
    dataset = dataset.assign_coords(
        nu=_frequencies(nus),
        revolutions=("revolutions", np.array(CHECKED_AFTER, np.int32), count_of),
        phase=("phase", starts, phase),
    )
    dataset.attrs = {"variant": VARIANT}
    return dataset


def _problems(pair: Pair, nus: Iterable[float]) -> list[Problem]:
    return [pair.problem(variant(VARIANT), float(nu)) for nu in nus]


def _frequencies(nus: Sequence[float] | np.ndarray) -> tuple[str, np.ndarray, dict[str, str]]:
    return "nu", np.asarray(nus, float), {"units": "1", "long_name": "mesh frequency nu_s"}
