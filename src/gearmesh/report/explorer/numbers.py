"""The numbers of a study as the explorer reads them: raw bytes, and an index of what they are."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gearmesh.dynamics.continuation.kinds import KINDS

MOST_PERIODS = 2
"""The longest orbits, in mesh periods, whose special points the diagram marks."""

MOST_BYTES = 3_500_000
"""Bytes of numbers in a page; a study with more keeps every second, third, … frequency."""

_ALIGNMENT = 8


@dataclass(frozen=True, slots=True)
class Packed:
    """Arrays in one text.

    Attributes
    ----------
    index : dict
        For each array its type (``f8``, ``f4``, ``u2`` or ``i1``), first byte and length.
    text : str
        All bytes, little-endian, in base64.
    """

    index: dict[str, tuple[str, int, int]]
    text: str


def pack(arrays: Mapping[str, np.ndarray]) -> Packed:
    """Put arrays one behind the other, each aligned to its type."""
    index, content = {}, bytearray()
    for name, array in arrays.items():
        content += bytes(-len(content) % _ALIGNMENT)
        little = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
        index[name] = (little.dtype.str[1:], len(content), little.size)
        content += little.tobytes()
    return Packed(index, base64.b64encode(content).decode())


def diagram(resonance: xr.Dataset, bifurcation: xr.Dataset) -> dict[str, np.ndarray]:
    """Return the arrays of the bifurcation diagram.

    Parameters
    ----------
    resonance, bifurcation : xarray.Dataset
        The datasets of a study, over (variant, nu).

    Returns
    -------
    dict of ndarray
        ``nu``; over (variant, nu) ``counts`` of extrema, ``y_max``, ``y_min``, ``status`` and
        ``sensitive``; and all extrema one after the other, ``y`` and whether it is a ``maximum``.
        Lengths are in static deflections.
    """
    step = 1
    while _size(bifurcation, step) > MOST_BYTES:
        step += 1
    resonance, bifurcation = (
        dataset.isel(nu=slice(None, None, step)) for dataset in (resonance, bifurcation)
    )
    y = bifurcation["extremum_y_rel"].values
    there = ~np.isnan(y)
    kinds = np.broadcast_to(bifurcation["extremum_kind"].values, y.shape)
    return {
        "nu": bifurcation["nu"].values.astype("f8"),
        "counts": there.sum(axis=2).astype("u2"),
        "y": y[there].astype("f4"),
        "maximum": (kinds[there] > 0).astype("i1"),
        "y_max": resonance["y_max_rel"].values.astype("f4"),
        "y_min": resonance["y_min_rel"].values.astype("f4"),
        "status": resonance["status"].values.astype("i1"),
        "sensitive": (resonance["sensitive"].values == 1).astype("i1"),
    }


def _size(bifurcation: xr.Dataset, step: int) -> int:
    y: Any = bifurcation["extremum_y_rel"].values[:, ::step]
    return int(5 * (~np.isnan(y)).sum())


def orbits(
    branches: xr.Dataset, points: Sequence[Mapping[str, Any]], variants: Sequence[str]
) -> dict[str, np.ndarray]:
    """Return the arrays of the branches of orbits and of their special points.

    Parameters
    ----------
    branches : xarray.Dataset
        Over ``point``, one branch after the other.
    points : sequence of mapping
        Special points. Left out are those with parameters of their own, which belong to another
        gear pair, and those of longer periods than `MOST_PERIODS`, which would hide the diagram.
    variants : sequence of str
        Names of the variants, whose places stand for them.

    Returns
    -------
    dict of ndarray
        ``branch_…`` over the points of the branches and ``special_…`` over the special points:
        the variant, ν_s, y_max and y_min; for branches their number and stability, for special
        points their kind and period.
    """
    known = np.isin(branches["variant"].values.astype(str), list(variants))
    branches = branches.isel(point=known)
    rows = [
        row
        for row in points
        if "parameters" not in row and row["variant"] in variants and row["periods"] <= MOST_PERIODS
    ]
    place = {name: i for i, name in enumerate(variants)}
    return {
        "branch_variant": np.array([place[str(v)] for v in branches["variant"].values], "u2"),
        "branch_number": branches["branch"].values.astype("u2"),
        "branch_stability": branches["stability"].values.astype("i1"),
        "branch_nu": branches["nu"].values.astype("f4"),
        "branch_max": branches["y_max_rel"].values.astype("f4"),
        "branch_min": branches["y_min_rel"].values.astype("f4"),
        "special_variant": np.array([place[row["variant"]] for row in rows], "u2"),
        "special_kind": np.array([KINDS.index(row["kind"]) for row in rows], "i1"),
        "special_periods": np.array([row["periods"] for row in rows], "u2"),
        "special_nu": np.array([row["nu"] for row in rows], "f8"),
        "special_max": np.array([row["y_max_rel"] for row in rows], "f4"),
        "special_min": np.array([row["y_min_rel"] for row in rows], "f4"),
    }
