"""Branches as one table over all their points, and special points as rows of a list."""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

if TYPE_CHECKING:  # code that only reads results imports this module, too, and needs no solver
    from gearmesh.interface.branches import Branch, SpecialPoint

STABILITY = {1: "stable", 0: "neutral", -1: "unstable"}
"""Values of the flag `stability`."""

Row = dict[str, Any]
"""A special point as `special_points.json` holds it."""


def table(variant: str, branches: Sequence["Branch"]) -> xr.Dataset:
    """Return the branches of a variant, one after the other, over ``point``.

    Returns
    -------
    xarray.Dataset
        `variant`, `branch`, `periods`, `nu`, `y_max`, `y_min` (in mm, and with ``_rel`` in static
        deflections), `stability`, `signature`, and the real and imaginary parts of the
        `multipliers`.
    """
    return xr.concat(
        [_points(variant, number, branch) for number, branch in enumerate(branches)], "point"
    )


def _points(variant: str, number: int, branch: "Branch") -> xr.Dataset:
    found = branch.to_dataset()
    multipliers = found["multipliers"].values
    stability = np.where(found["neutral"], 0, np.where(found["stable"], 1, -1)).astype(np.int8)
    flags = {
        "flag_values": np.array(list(STABILITY), np.int8),
        "flag_meanings": " ".join(STABILITY.values()),
    }
    size = found.sizes["point"]
    signatures = [" ".join(branch.at(i).signature) for i in range(size)]
    columns: dict[str, tuple[Any, str, dict[str, Any]]] = {
        "variant": (np.full(size, variant, object), "name of the damping variant", {}),
        "branch": (np.full(size, number, np.int32), "number of the branch of its variant", {}),
        "periods": (
            np.full(size, branch.orbit.periods, np.int32),
            "least period of the orbit, in mesh periods",
            {},
        ),
        "stability": (stability, "whether the orbit is stable", flags),
        "signature": (np.array(signatures, object), "regimes of one period, in their order", {}),
    }
    kept = found[["nu", "y_max", "y_max_rel", "y_min", "y_min_rel"]]
    for name, (values, what, more) in columns.items():
        units = {} if values.dtype == object else {"units": "1"}
        kept[name] = ("point", values, {**units, "long_name": what, **more})
    for part, values in (("real", multipliers.real), ("imaginary", multipliers.imag)):
        stated = {"units": "1", "long_name": f"{part} part of the Floquet multipliers"}
        kept[f"multipliers_{part}"] = (("point", "multiplier"), values, stated)
    return kept.drop_attrs(deep=False)


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


def joined(tables: Iterable[xr.Dataset]) -> xr.Dataset:
    """Return the tables of several variants as one."""
    return xr.concat(list(tables), "point", combine_attrs="drop")
