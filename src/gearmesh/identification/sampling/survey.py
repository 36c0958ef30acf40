"""Measure every claim of the ledger on samples of the open parameters."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, cast

import numpy as np
import xarray as xr

from gearmesh.data import casefile
from gearmesh.identification.sampling import store
from gearmesh.identification.sampling.curves import SampledCurve, scan_all
from gearmesh.identification.sampling.design import Sample, pair_of, samples
from gearmesh.identification.settings import Settings
from gearmesh.reproduction.claims.checking import MEASURES
from gearmesh.reproduction.claims.evidence import Evidence, NotInStudy, NotLocated
from gearmesh.reproduction.claims.fig6 import LESS, MORE
from gearmesh.reproduction.frequencies import CROSSING, FIG_4
from gearmesh.reproduction.thresholds import NONLINEAR, locate_on
from gearmesh.study.pair import Pair

VARIANTS = (
    *(f"{letter}-lubricant" for letter in ("b", *NONLINEAR)),
    "b-material",
    "b-both",
    *(f"{letter}-{symbol}" for letter in NONLINEAR for symbol in ("material", "both")),
    "c-material-5x",
)
"""Variants with claims that depend on the open parameters."""

TIME_COURSES = (
    *(("c-lubricant", nu) for nu in FIG_4),
    (LESS, CROSSING),
    (MORE, CROSSING),
)
"""Cases whose time course a claim uses."""

_GROUP = 16

Measured = dict[str, float]
"""Column such as ``F2.3|near 0.66|c-lubricant`` -> what was measured; NaN if it does not exist."""


def tested_claims() -> list[str]:
    """Return the ids of the claims that may depend on the open parameters.

    A second reading of a claim (F3.4b) is no further evidence, so it is left out.
    """
    return [name for name in MEASURES if not name.startswith("P") and name[-1].isdigit()]


def compute(
    settings: Settings, study: Pair, name: str, index: int, places: np.ndarray
) -> xr.Dataset:
    """Measure the claims on one batch of a design.

    Parameters
    ----------
    settings : Settings
        Ranges and designs.
    study : Pair
        Values of all parameters that the design does not vary.
    name : str
        The design.
    index : int
        The batch, from 0.
    places : ndarray, shape (points, varied factors)
        Points of the whole design in the unit cube.
    """
    design = settings.designs[name]
    size = design.points_per_job
    part = places[index * size : (index + 1) * size]
    drawn = samples(part, design, settings, study)
    return store.dataset(name, design, part, drawn, list(measure(drawn, study)))


def measure(drawn: Sequence[Sample], study: Pair) -> Iterator[Measured]:
    """Yield what the claims of the ledger measure on each sample.

    Parameters
    ----------
    drawn : sequence of Sample
        Values of the open parameters.
    study : Pair
        All other parameters.
    """
    for first in range(0, len(drawn), _GROUP):
        group = drawn[first : first + _GROUP]
        curves = [{name: SampledCurve(s, study, name) for name in VARIANTS} for s in group]
        scan_all([c for of_sample in curves for c in of_sample.values()])
        for sample, of_sample in zip(group, curves, strict=True):
            yield measure_curves(of_sample, pair_of(sample, study))


def measure_curves(curves: Mapping[str, SampledCurve], pair: Pair) -> Measured:
    """Return what the claims measure on the curves of one sample."""
    evidence = Evidence(
        pair=pair,
        thresholds=locate_on(curves, pair),
        time_courses=dict(_time_courses(curves, pair)),
    )
    found: Measured = {}
    for claim in tested_claims():
        try:
            measured, _ = MEASURES[claim](evidence)
        except (NotInStudy, NotLocated, ArithmeticError, ValueError):
            # The quantity of the claim does not exist in this motion.
            continue
        found.update(_columns(claim, measured))
    return found


def _time_courses(
    curves: Mapping[str, SampledCurve], pair: Pair
) -> Iterator[tuple[tuple[str, float], xr.Dataset]]:
    for name, nu in TIME_COURSES:
        response = curves[name].time_course(nu)
        if response.status == "ok":
            record = casefile.record(response, pair)
            variables = {key: xr.Variable(("",) * a.ndim, a) for key, a in record.items()}
            # The checks read variables by name only, and a real dataset takes long to build.
            yield (name, nu), cast(xr.Dataset, variables)


def _columns(name: str, measured: Any) -> Iterator[tuple[str, float]]:
    if isinstance(measured, Mapping):
        for key, value in measured.items():
            yield from _columns(f"{name}|{key}", value)
    else:
        yield name, float("nan") if measured is None else float(measured)
