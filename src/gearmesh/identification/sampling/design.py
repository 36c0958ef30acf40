"""Samples of the open parameters: low-discrepancy designs, and what a sample means."""

from collections.abc import Mapping, Sequence

import numpy as np

from gearmesh.identification.factors import FACTORS, KINDS, OF_THE_PAIR, scales
from gearmesh.identification.settings import Design, Settings
from gearmesh.study.pair import Pair

Sample = dict[str, float | str]
"""Factor -> value, in the scale of the factor."""

FROM_REST: Sample = {"initial_velocity": 0.0, "kind": KINDS[0]}
"""Runs of the natural reading: each starts from rest."""

_WHEELS = ("eccentricity_3", "eccentricity_2")


def stated(pair: Pair) -> Sample:
    """Return the sample that a study states."""
    values = dict(zip(_WHEELS, pair.eccentricity, strict=True))
    values |= {name: getattr(pair, name) for name in OF_THE_PAIR if name not in _WHEELS}
    sizes = scales(pair)
    return FROM_REST | {name: values[name] / sizes[FACTORS[name].scale] for name in OF_THE_PAIR}


def pair_of(sample: Mapping[str, float | str], study: Pair) -> Pair:
    """Return the pair of a study with the values of a sample.

    The initial velocity and the kind of run are set by the response curves of the sample.
    """
    sizes = scales(study)
    values = {name: float(sample[name]) * sizes[FACTORS[name].scale] for name in OF_THE_PAIR}
    eccentricity = tuple(values.pop(name) for name in _WHEELS)
    # Not validated: the ranges of the settings lie inside those of the model.
    return study.model_copy(update=values | {"eccentricity": eccentricity})


def left_alone(design: Design, study: Pair) -> str:
    """Return a digest of all parameters of a study that a design does not vary."""
    sample = stated(study) | dict.fromkeys(design.vary, 0.0)
    return pair_of(sample, study).digest()


def unit_points(design: Design) -> np.ndarray:
    """Return the scrambled Sobol' points of a design, shape (points, varied factors).

    If a sample varies one factor only, the coordinates of the others are NaN.
    """
    # This import is slow, and the pipeline reads designs without drawing samples.
    from scipy.stats import qmc

    points = qmc.Sobol(len(design.vary), seed=design.seed).random(design.points)
    if design.one_at_a_time:
        # Each factor gets a block of the sequence, because only consecutive points spread evenly.
        turn = np.arange(design.points) * len(design.vary) // design.points
        points[turn[:, None] != np.arange(len(design.vary))] = np.nan
    return points


def samples(points: np.ndarray, design: Design, settings: Settings, study: Pair) -> list[Sample]:
    """Turn points of the unit cube, one row each, into samples.

    Factors that a point does not set keep the value of the study.
    """
    base = stated(study) | design.fixed
    return [base | _values(row, design.vary, settings) for row in points]


def _values(row: Sequence[float], vary: Sequence[str], settings: Settings) -> Sample:
    values: Sample = {}
    for name, unit in zip(vary, row, strict=True):
        if np.isnan(unit):
            continue
        if name == "kind":
            values[name] = KINDS[min(int(unit * len(KINDS)), len(KINDS) - 1)]
        else:
            values[name] = settings.ranges[name].value(float(unit))
    return values
