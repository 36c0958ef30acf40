"""The long-run motion of every case of a study, and how long each case takes to settle on it."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from gearmesh.dynamics.attraction.kinds import KINDS
from gearmesh.interface.lengths import with_lengths
from gearmesh.model.variants import variant as read_variant
from gearmesh.study.cases import Study

if TYPE_CHECKING:  # code that only reads results imports this module, too, and needs no solver
    from gearmesh.dynamics.attraction.classification import LongRun

FLAGS = ("not_computed", *KINDS)
"""Values of the flag `kind`: that of a cell without a case comes first."""

_ABSENT = -1  # of whole numbers


def table(study: Study, runs: Mapping[str, Sequence["LongRun"]]) -> xr.Dataset:
    """Return the long-run motion of the cases over (variant, nu).

    Parameters
    ----------
    study : Study
    runs : mapping
        For each variant of the study the long-run motion at each of its frequencies, in their
        order.

    Returns
    -------
    xarray.Dataset
        `kind`, one of `FLAGS`; of the orbit on which a case ends, or which it still approaches, the
        least period (`periods`, 0 without an orbit) and the extremes `y_max` and `y_min` (mm, and
        ``_rel`` in static deflections, not-a-number without an orbit); and `settling_periods`, the
        mesh periods until the case has settled, missing if it does not. The attributes state how
        long a case is followed, and the limits of settled and of chaotic motion.
    """
    from gearmesh.dynamics.attraction.classification import CHECKED_AFTER, SETTLED
    from gearmesh.dynamics.attraction.growth import LEAST_GROWTH

    plan = study.plan.frequencies()
    nu = np.array(sorted({nu for _, nus in plan for nu in nus}))
    shape = len(plan), nu.size
    kind, periods = np.zeros(shape, np.int8), np.full(shape, _ABSENT, np.int32)
    settling, extremes = np.full(shape, _ABSENT, np.int32), np.full((*shape, 2), np.nan)
    for row, (variant, nus) in enumerate(plan):
        places = np.searchsorted(nu, nus).tolist()
        for place, run in zip(places, runs[variant.name], strict=True):
            cell, orbit = (row, place), run.orbit
            kind[cell] = FLAGS.index(run.attractor.kind)
            periods[cell] = orbit.periods if orbit else 0
            extremes[cell] = (orbit.y_max, orbit.y_min) if orbit else np.nan
            settling[cell] = _ABSENT if run.settled is None else run.settled
    axes = "variant", "nu"
    dataset = with_lengths(
        {
            "y_max": (axes, extremes[..., 0], "maximum of y on the orbit"),
            "y_min": (axes, extremes[..., 1], "minimum of y on the orbit"),
        },
        study.pair.static_deflection,
    )
    flags = {
        "flag_values": np.arange(len(FLAGS), dtype=np.int8),
        "flag_meanings": " ".join(FLAGS).replace("-", "_"),
    }
    absent = {"units": "1", "_FillValue": np.int32(_ABSENT)}
    columns: dict[str, tuple[np.ndarray, str, dict[str, Any]]] = {
        "kind": (kind, "kind of the long-run motion", {"units": "1", **flags}),
        "periods": (periods, "least period of the orbit, in mesh periods; 0 without one", absent),
        "settling_periods": (settling, "mesh periods until the case has settled", absent),
    }
    for name, (values, what, more) in columns.items():
        dataset[name] = (axes, values, {"long_name": what, **more})
    dataset.attrs = {
        "followed_mesh_periods": CHECKED_AFTER[-1],
        "settled_within_rel": SETTLED,
        "chaotic_growth_rel": LEAST_GROWTH,
    }
    names = [variant.name for variant, _ in plan]
    return dataset.assign_coords(
        variant=("variant", names, {"long_name": "name of the damping variant"}),
        nu=("nu", nu, {"units": "1", "long_name": "mesh frequency nu_s"}),
    )


class Share(NamedTuple):
    """How the cases of a variant end, or those of all variants that damp at the same place.

    Attributes
    ----------
    name : str
        Name of the variant, or ``all`` and the marker of Tab. 1.
    symbol : str
        Where the damping acts.
    kinds : dict
        Share of the cases, in %: `FLAGS`, and ``period 1`` and ``longer`` for the orbits of one and
        of several mesh periods.
    in_time : float
        Share of the cases, in %, that settle within the revolutions of the study.
    median, last : float
        Mesh periods until half of the cases that settle have settled, and all of them;
        not-a-number if none does.
    """

    name: str
    symbol: str
    kinds: dict[str, float]
    in_time: float
    median: float
    last: float


def shares(attractors: xr.Dataset, run: int) -> list[Share]:
    """Return how the cases end: of variant a, with □, with ×, and of each variant with •.

    Parameters
    ----------
    attractors : xarray.Dataset
        What `table` returns, read from its file.
    run : int
        Mesh periods of a case of the study.
    """
    groups = defaultdict(list)
    for name in map(str, attractors["variant"].values):
        chosen = read_variant(name)
        together = chosen.symbol in ("material", "both")
        label = f"all {chosen.marker}" if together else name
        groups[chosen.symbol, label].append(name)
    ordered = sorted(groups, key=lambda group: group[0] == "lubricant")
    return [_share(attractors.sel(variant=groups[one]), *one, run) for one in ordered]


def _share(cases: xr.Dataset, symbol: str, label: str, run: int) -> Share:
    kind = cases["kind"].values
    there = kind != FLAGS.index("not_computed")
    columns = (cases[name].values[there] for name in ("kind", "periods", "settling_periods"))
    kind, periods, settling = columns
    periodic = kind == FLAGS.index("periodic")
    members = {
        **{name: kind == value for value, name in enumerate(FLAGS)},
        "period 1": periodic & (periods == 1),
        "longer": periodic & (periods > 1),
    }
    settled = settling[~np.isnan(settling)]
    return Share(
        label,
        symbol,
        {name: _percent(chosen) for name, chosen in members.items()},
        _percent(settling <= run),
        float(np.quantile(settled, 0.5, method="inverted_cdf")) if settled.size else np.nan,
        float(settled.max()) if settled.size else np.nan,
    )


def _percent(chosen: np.ndarray) -> float:
    return 100.0 * float(chosen.mean())
