"""Samples of the open parameters: low-discrepancy designs, and what a sample means."""

from collections.abc import Mapping, Sequence

import numpy as np

from gearmesh.identification.settings import KINDS, Design, Settings
from gearmesh.study.pair import Pair

Sample = dict[str, float | str]
"""Factor -> value; all lengths in static deflections, masses in m_red, stiffnesses in C_s."""

NEUTRAL: Sample = {
    "initial_phase": 0.0,
    "initial_velocity": 0.0,
    "kind": KINDS[0],
    "eccentricity_3": 0.0,
    "eccentricity_2": 0.0,
    "eccentricity_angle": 0.0,
}
"""Values that remove an effect: they hold where a design says nothing."""


def stated(pair: Pair) -> Sample:
    """Return the sample that a study states."""
    y_st = pair.static_deflection
    eccentricity_3, eccentricity_2 = pair.eccentricity
    return NEUTRAL | {
        "backlash": pair.backlash / y_st,
        "damping_length": pair.damping_length / y_st,
        "body_mass": pair.body_mass / pair.reduced_mass,
        "bearing_stiffness": pair.bearing_stiffness / pair.stiffness_mean,
        "bearing_damping_ratio": pair.bearing_damping_ratio,
        "friction_coefficient": pair.friction_coefficient,
        "initial_phase": pair.initial_phase,
        "eccentricity_3": eccentricity_3 / y_st,
        "eccentricity_2": eccentricity_2 / y_st,
        "eccentricity_angle": pair.eccentricity_angle,
    }


def pair_of(sample: Mapping[str, float | str], study: Pair) -> Pair:
    """Return the parameters of a study with the values of a sample in place of its own.

    The initial velocity and the kind of run are no parameters of a study; they are left out.
    """
    y_st = study.static_deflection
    scales = {
        "backlash": y_st,
        "damping_length": y_st,
        "body_mass": study.reduced_mass,
        "bearing_stiffness": study.stiffness_mean,
        "bearing_damping_ratio": 1.0,
        "friction_coefficient": 1.0,
        "initial_phase": 1.0,
        "eccentricity_angle": 1.0,
    }
    changes: dict[str, object] = {
        name: float(sample[name]) * scale for name, scale in scales.items()
    }
    changes["eccentricity"] = tuple(
        float(sample[f"eccentricity_{wheel}"]) * y_st for wheel in (3, 2)
    )
    # No validation: the ranges of the settings are inside those of the model.
    return study.model_copy(update=changes)


def left_alone(design: Design, study: Pair) -> str:
    """Return a digest of all parameters of a study that a design leaves alone."""
    sample = stated(study) | dict.fromkeys(design.vary, 0.0)
    return pair_of(sample, study).digest()


def unit_points(design: Design) -> np.ndarray:
    """Return the scrambled Sobol' points of a design, shape (points, varied factors).

    Where a sample varies one factor only, the places of the others are NaN.
    """
    # Imported here: the pipeline looks at designs without drawing them, and this takes its time.
    from scipy.stats import qmc

    points = qmc.Sobol(len(design.vary), seed=design.seed).random(design.points)
    if design.one_at_a_time:
        # In turn by blocks: only neighbours in the sequence spread evenly.
        turn = np.arange(design.points) * len(design.vary) // design.points
        points[turn[:, None] != np.arange(len(design.vary))] = np.nan
    return points


def samples(points: np.ndarray, design: Design, settings: Settings, study: Pair) -> list[Sample]:
    """Turn points of the unit cube, one row each, into samples.

    What a point says nothing about has the value of the study, or the one that removes its effect.
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
