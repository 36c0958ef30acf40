"""Branches as one table over all their points, and special points as rows of a list."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gearmesh.data.casefile import REGIMES
from gearmesh.interface.lengths import with_lengths

if TYPE_CHECKING:  # code that only reads results imports this module, too, and needs no solver
    from gearmesh.interface.branches import Branch, SpecialPoint

STABILITY = {1: "stable", 0: "neutral", -1: "unstable"}
"""Values of the flag `stability`."""

Row = dict[str, Any]
"""A special point as `special_points.json` holds it."""


def table(branches: Mapping[str, Sequence["Branch"]], static_deflection: float) -> xr.Dataset:
    """Return all branches in ν_s, one after the other, over ``point``.

    Parameters
    ----------
    branches : mapping
        Name of a variant -> its branches.
    static_deflection : float
        y_st in mm.

    Returns
    -------
    xarray.Dataset
        `variant`, `branch`, `periods`, `nu`, `y_max`, `y_min` (in mm, and with ``_rel`` in static
        deflections), `stability`, `signature`, and the real and imaginary parts of the
        `multipliers`.
    """
    numbered = [
        (variant, number, branch.orbit.periods, branch.found)
        for variant, several in branches.items()
        for number, branch in enumerate(several)
    ]
    variants, numbers, periods, found = zip(*numbered, strict=True)
    sizes = [len(one.points) for one in found]

    def along(name: str) -> np.ndarray:
        return np.concatenate([getattr(one, name) for one in found])

    signatures = [
        " ".join(REGIMES[regime] for regime in point.orbit.signature)
        for one in found
        for point in one.points
    ]
    stability = np.where(along("neutral"), 0, np.where(along("stable"), 1, -1))
    flags = {
        "flag_values": np.array(list(STABILITY), np.int8),
        "flag_meanings": " ".join(STABILITY.values()),
    }
    columns: dict[str, tuple[np.ndarray, str, dict[str, Any]]] = {
        "variant": (
            np.repeat(np.array(variants, object), sizes),
            "name of the damping variant",
            {},
        ),
        "branch": (
            np.repeat(np.array(numbers, np.int32), sizes),
            "number of the branch of its variant",
            {},
        ),
        "periods": (
            np.repeat(np.array(periods, np.int32), sizes),
            "least period of the orbit, in mesh periods",
            {},
        ),
        "stability": (stability.astype(np.int8), "whether the orbit is stable", flags),
        "signature": (
            np.array(signatures, object),
            "regimes of one period, in their order",
            {},
        ),
    }
    dataset = xr.Dataset()
    dataset["nu"] = ("point", along("values"), {"units": "1", "long_name": "mesh frequency nu_s"})
    heights = {
        "y_max": (("point",), along("y_max"), "maximum of y"),
        "y_min": (("point",), along("y_min"), "minimum of y"),
    }
    dataset = dataset.merge(with_lengths(heights, static_deflection))
    for name, (values, what, more) in columns.items():
        units = {} if values.dtype == object else {"units": "1"}
        dataset[name] = ("point", values, {**units, "long_name": what, **more})
    multipliers = along("multipliers")
    for part, values in (("real", multipliers.real), ("imaginary", multipliers.imag)):
        stated = {"units": "1", "long_name": f"{part} part of the Floquet multipliers"}
        dataset[f"multipliers_{part}"] = (("point", "multiplier"), values, stated)
    return dataset


def rows(variant: str, branches: Sequence["Branch"], parameters: Mapping[str, Any]) -> list[Row]:
    """Return the special points of a variant in their order along the branches.

    Parameters
    ----------
    variant : str
        Name of the variant.
    branches : sequence of Branch
        Its branches.
    parameters : mapping
        Parameters that differ from those of the study; the rows repeat them if there are some.
    """
    more = {"parameters": dict(parameters)} if parameters else {}
    return [
        {**_row(variant, number, point), **more}
        for number, branch in enumerate(branches)
        for point in branch.special
        if point.orbit.periods == branch.orbit.periods  # others are on the branch they begin at
    ]


def _row(variant: str, number: int, point: "SpecialPoint") -> Row:
    found = point.orbit.reduced
    return {
        "variant": variant,
        "kind": point.kind,
        "nu": point.nu,
        "periods": found.periods,
        "branch": number,
        "y_max_rel": found.y_max,
        "y_min_rel": found.y_min,
        "signature": " ".join(point.orbit.signature),
        "state": found.state.tolist(),
    }
