"""Curves of special points over (ν_s, damping) and (ν_s, damping length)."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray as xr

from gearmesh.dynamics.continuation import branches, special_curves
from gearmesh.dynamics.continuation.special_points import SpecialPoint
from gearmesh.dynamics.periodic import orbits
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.model.variants import variant
from gearmesh.reproduction.mechanisms.tables import Row
from gearmesh.study.pair import Pair

FROM, TO = 0.5, 1.2
"""Range of ν_s of the curves."""

TIMES = (0.05, 8.0)
"""Range of the damping and of the damping length, in multiples of the study's."""

_BEGIN = 0.78
_SEARCHED = (0.6, 0.9)
"""Where the orbit in contact is found, and the range of ν_s in which it is followed, at another
multiple of a parameter."""


class Wanted(NamedTuple):
    """A curve: the special point that it goes through, and what changes along it.

    `times` is the multiple of the parameter at which the special point is found. The folds of b-□
    have two curves, because the walk along one may stop at the cusp.
    """

    variant: str
    kind: str
    near: float
    parameter: str
    times: float = 1.0


DAMPING, LENGTH = "damping", "damping_length"

WANTED = (
    Wanted("c-material", "switching", 0.64, DAMPING),
    Wanted("b-material", "fold", 0.82, DAMPING),
    Wanted("b-material", "fold", 0.70, DAMPING, 1.8),
    Wanted("b-material", "grazing_front", 0.80, DAMPING),
    Wanted("c-material", "grazing_front", 0.82, DAMPING),
    Wanted("c-material", "grazing_front", 0.82, LENGTH),
    Wanted("c-material", "fold", 0.80, DAMPING, 0.4),
    Wanted("c-material", "fold", 0.80, LENGTH, 6.0),
    Wanted("c-lubricant", "flip", 0.655, DAMPING),
    Wanted("c-lubricant", "flip", 0.67, DAMPING),
    Wanted("c-lubricant", "grazing_front", 0.79, DAMPING),
    Wanted("c-lubricant", "fold", 0.805, DAMPING),
    Wanted("c-lubricant", "fold", 0.705, LENGTH),
    Wanted("c-lubricant", "grazing_front", 1.13, DAMPING),
)
"""The curves of the study. Curves of other variants that a study does not follow are left out."""


def curves(pair: Pair, rows: Iterable[Row]) -> xr.Dataset:
    """Follow the special points of the study in two parameters.

    Parameters
    ----------
    pair : Pair
        The gear pair.
    rows : iterable of dict
        The special points of its branches.

    Returns
    -------
    xarray.Dataset
        Over ``point``: `curve` (its number), `variant`, `kind`, `parameter`, `nu`,
        `damping_ratio`, `damping_length_rel`, `y_max_rel`, `y_min_rel`, `cusp` (1 at a cusp).
    """
    rows = [row for row in rows if "parameters" not in row and row["periods"] == 1]
    pieces: list[xr.Dataset] = []
    for wanted in WANTED:
        try:
            points = _points(pair, wanted, rows)
            if points:
                nearest = min(points, key=lambda point: abs(point.nu - wanted.near))
                pieces.append(_curve(pair, wanted, nearest, len(pieces)))
        except NoOrbit:
            continue
    return xr.concat(pieces, "point") if pieces else _columns(pair, [], [], [], None, 0)


def _points(pair: Pair, wanted: Wanted, rows: Iterable[Row]) -> list[SpecialPoint]:
    """Return the special points of a variant that a curve may go through.

    They are those of the study, or are located at another multiple of the parameter. A study that
    does not follow the variant has none.
    """
    own = [row for row in rows if row["variant"] == wanted.variant]
    family = _family(pair, wanted)
    if wanted.times == 1.0:
        return [
            SpecialPoint(row["kind"], row["nu"], {"nu": row["nu"]}, orbit)
            for row in own
            if row["kind"] == wanted.kind
            for orbit in (orbits.correct(family(row["nu"], 1.0), np.array(row["state"])),)
        ]
    if not own:
        return []
    begun = orbits.find_orbit(family(_BEGIN, wanted.times))
    branch = branches.follow(begun, "nu", _SEARCHED)
    return [point for point in branch.special if point.kind == wanted.kind]


def _curve(pair: Pair, wanted: Wanted, point: SpecialPoint, number: int) -> xr.Dataset:
    limits = (FROM, TO), TIMES
    family, values = _family(pair, wanted), (point.nu, wanted.times)
    found = special_curves.follow_special(point, ("nu", "times"), limits, family, values)
    cusps = [(one.parameters["nu"], one.parameters["times"]) for one in found.cusps]
    return _columns(
        pair,
        [*map(tuple, found.values.tolist()), *cusps],
        [*found.orbits, *(one.orbit for one in found.cusps)],
        [0] * len(found.orbits) + [1] * len(cusps),
        wanted,
        number,
    )


def _family(pair: Pair, wanted: Wanted) -> Callable[..., Problem]:
    """Return the problems over ν_s and a multiple of the parameter of the study.

    The force of the powers 1, 2 and 3 of the velocity is k, k/v_ref and k/v_ref² times the power,
    so a multiple of the damping multiplies all of them, and one of ℓ divides the higher ones.
    """
    begun = pair.problem(variant(wanted.variant), 1.0)

    def scaled(law: Sequence[float], times: float) -> tuple[float, float, float]:
        if wanted.parameter == DAMPING:
            return law[0] * times, law[1] * times, law[2] * times
        return law[0], law[1] / times, law[2] / times**2

    def problem(nu: float, times: float) -> Problem:
        material, lubricant = scaled(begun.material, times), scaled(begun.lubricant, times)
        return replace(begun, nu=nu, material=material, lubricant=lubricant)

    return problem


def _columns(
    pair: Pair,
    values: Sequence[tuple[float, ...]],
    found: Sequence[Shot],
    cusp: Sequence[int],
    wanted: Wanted | None,
    number: int,
) -> xr.Dataset:
    nu, times = np.reshape(np.array(values, float), (-1, 2)).T
    size = len(nu)
    name, kind, parameter = (wanted.variant, wanted.kind, wanted.parameter) if wanted else [""] * 3
    ratio, length = pair.damping_ratio, pair.damping_length / pair.static_deflection
    columns = {
        "curve": (np.full(size, number, np.int32), "number of the curve"),
        "variant": (np.full(size, name, object), "name of the damping variant"),
        "kind": (np.full(size, kind, object), "kind of the special point"),
        "parameter": (np.full(size, parameter, object), "parameter that changes along the curve"),
        "cusp": (np.array(cusp, np.int8), "1 at a cusp, where two folds meet"),
        "nu": (nu, "mesh frequency nu_s"),
        "damping_ratio": (
            ratio * (times if parameter == DAMPING else np.ones(size)),
            "damping ratio D = k/(2 sqrt(C_s m_red))",
        ),
        "damping_length_rel": (
            length * (times if parameter == LENGTH else np.ones(size)),
            "damping length l, in static deflections y_st",
        ),
        "y_max_rel": (
            np.array([one.y_max for one in found]),
            "maximum of y, in static deflections y_st",
        ),
        "y_min_rel": (
            np.array([one.y_min for one in found]),
            "minimum of y, in static deflections y_st",
        ),
    }
    dataset = xr.Dataset()
    for name, (stored, what) in columns.items():
        units = {} if stored.dtype == object else {"units": "1"}
        dataset[name] = ("point", stored, {**units, "long_name": what})
    return dataset
