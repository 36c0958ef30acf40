"""Sweeps up and down: each run starts from the end of the run at the frequency before it."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from gearmesh.interface.lengths import with_lengths
from gearmesh.model.variants import Variant, variant
from gearmesh.study.pair import Pair

DWELL = 20
"""Revolutions at each frequency of a sweep."""

DIRECTIONS = ("up", "down")
STEP = 0.0025
FROM, TO = 0.6, 1.2

MAP_LETTER = "c"
MAP_PLACES = ("material", "both", "lubricant")
MAP_STEP = 0.01
MAP_DAMPING = (0.005, 0.5)
"""Least and greatest damping ratio D of the map."""

SEPARATE = 0.2
"""Difference of y_max or y_min, in y_st, from which two motions count as two attractors."""

GRAZES = 0.02
"""Depth below y = 0 or -s, in y_st, up to which a motion counts as still on its side."""

STATES = ("no_contact_loss", "contact_loss", "back_flank_contact")
"""States of a cell of the design map: how far the motion goes in either sweep."""


def sweeps(pair: Pair, variants: Sequence[str]) -> xr.Dataset:
    """Return the extremes of y in the last of `DWELL` revolutions over (variant, direction, nu)."""
    nus = _grid(STEP)
    found = _both_ways(pair, [variant(name) for name in variants], nus)
    dataset = _extremes(found, ("variant", "direction", "nu"), pair)
    dataset = dataset.assign_coords(_coordinates(nus))
    dataset = dataset.assign_coords(variant=("variant", list(variants)))
    dataset["variant"].attrs = {"long_name": "name of the damping variant"}
    dataset.attrs = {"dwell_revolutions": DWELL}
    return dataset


def design_map(pair: Pair, resolution: int) -> xr.Dataset:
    """Return the state of the mesh over (place, damping ratio, nu) for quadratic damping.

    Parameters
    ----------
    pair : Pair
        The gear pair.
    resolution : int
        Damping ratios, evenly spaced in their logarithm.
    """
    nus = _grid(MAP_STEP)
    ratios = np.geomspace(*MAP_DAMPING, resolution)
    chosen = [
        Variant(MAP_LETTER, place, float(ratio / pair.damping_ratio))
        for place in MAP_PLACES
        for ratio in ratios
    ]
    found = _both_ways(pair, chosen, nus)
    found = found.reshape(len(MAP_PLACES), resolution, *found.shape[1:])
    axes = ("place", "damping_ratio", "direction", "nu")
    dataset = _extremes(found, axes, pair)
    lowest = found[..., 1].min(axis=2)
    apart = np.abs(found[:, :, 0] - found[:, :, 1]).max(axis=-1)
    backlash = pair.backlash / pair.static_deflection
    state = np.where(lowest < -backlash - GRAZES, 2, np.where(lowest < -GRAZES, 1, 0))
    flags = {
        "flag_values": np.arange(len(STATES), dtype=np.int8),
        "flag_meanings": " ".join(STATES),
        "units": "1",
        "long_name": "how far the motion goes in sweeps up and down",
    }
    dataset["state"] = (("place", "damping_ratio", "nu"), state.astype(np.int8), flags)
    stated = {"units": "1", "long_name": "1 where the sweeps end on different motions"}
    several = (apart > SEPARATE).astype(np.int8)
    dataset["several"] = (("place", "damping_ratio", "nu"), several, stated)
    dataset = dataset.assign_coords(_coordinates(nus))
    stated = {"units": "1", "long_name": "damping ratio D = k/(2 sqrt(C_s m_red))"}
    dataset = dataset.assign_coords(
        place=("place", list(MAP_PLACES), {"long_name": "where the damping acts"}),
        damping_ratio=("damping_ratio", ratios, stated),
    )
    dataset.attrs = {"letter": MAP_LETTER, "dwell_revolutions": DWELL}
    return dataset


def _grid(step: float) -> np.ndarray:
    return np.round(np.linspace(FROM, TO, round((TO - FROM) / step) + 1), 10)


def _both_ways(pair: Pair, variants: Sequence[Variant], nus: np.ndarray) -> np.ndarray:
    """Return y_max and y_min in y_st, shape (variant, direction, nu, 2), by ascending nu.

    Each run starts from the end of the run before it, or as a case does if that run failed.
    """
    # numba is loaded at the first run: code that only reads results imports this module, too.
    from gearmesh.solvers.reduced.ensembles import laws_of, measure

    cases = [pair.problem(chosen, float(nu)) for chosen in variants for nu in nus]
    upwards = laws_of(cases, pair.tolerance).reshape(len(variants), len(nus))
    laws = np.concatenate([upwards, upwards[:, ::-1]])
    teeth = cases[0].teeth
    starts = laws["start"]
    states, found = starts[:, 0], np.empty((*laws.shape, 2))
    for step in range(len(nus)):
        measured = measure(laws[:, step], states, DWELL * teeth, teeth)
        found[:, step] = np.column_stack([measured["y_max"], measured["y_min"]])
        failed, following = np.isnan(measured["y_max"]), min(step + 1, len(nus) - 1)
        states = np.where(failed[:, None], starts[:, following], measured["final"])
    up, down = np.split(found, 2)
    return np.stack([up, down[:, ::-1]], axis=1)


def _extremes(found: np.ndarray, axes: tuple[str, ...], pair: Pair) -> xr.Dataset:
    return with_lengths(
        {
            "y_max": (axes, found[..., 0], "maximum of y in the last revolution"),
            "y_min": (axes, found[..., 1], "minimum of y in the last revolution"),
        },
        pair.static_deflection,
    )


def _coordinates(nus: np.ndarray) -> dict[str, xr.Variable]:
    frequency = {"units": "1", "long_name": "mesh frequency nu_s"}
    direction = {"long_name": "direction of the sweep"}
    return {
        "nu": xr.Variable("nu", nus, frequency),
        "direction": xr.Variable("direction", list(DIRECTIONS), direction),
    }
