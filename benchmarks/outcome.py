"""What every solver has to deliver for a run, and how far it is from a reference."""

from dataclasses import dataclass

import numpy as np

SAMPLES_PER_PERIOD = 256


@dataclass(frozen=True, slots=True)
class Outcome:
    """The outputs asked of every solver, in static deflections and 1/Ω_s.

    Attributes
    ----------
    extremum_y : ndarray, shape (n_extrema,)
        All extrema of y in the kept periods, in order of time.
    strobe_y, strobe_v : ndarray, shape (n_periods + 1,)
        y and y' at the boundaries of the mesh periods.
    sample_y, sample_v : ndarray, shape (n_kept * SAMPLES_PER_PERIOD,), or None
        y and y' at equal steps over the kept periods; None where they were not asked for.
    """

    extremum_y: np.ndarray
    strobe_y: np.ndarray
    strobe_v: np.ndarray
    sample_y: np.ndarray | None
    sample_v: np.ndarray | None


@dataclass(frozen=True, slots=True)
class Deviation:
    """Distance of an outcome from the reference.

    Attributes
    ----------
    error : float
        Largest difference of any stroboscopic point, sample or extremum, in static deflections.
    extrema_agree : bool
        Whether both have equally many extrema; where not, `error` leaves the extrema out.
    """

    error: float
    extrema_agree: bool


def deviation(outcome: Outcome, reference: Outcome) -> Deviation:
    """Compare `outcome` with `reference`."""
    pairs = [
        (outcome.strobe_y, reference.strobe_y),
        (outcome.strobe_v, reference.strobe_v),
    ]
    if outcome.sample_y is not None and reference.sample_y is not None:
        pairs += [
            (outcome.sample_y, reference.sample_y),
            (outcome.sample_v, reference.sample_v),
        ]
    agree = len(outcome.extremum_y) == len(reference.extremum_y)
    if agree and len(reference.extremum_y):
        pairs.append((outcome.extremum_y, reference.extremum_y))
    error = max(float(np.max(np.abs(a - b))) for a, b in pairs)
    return Deviation(error if np.isfinite(error) else np.inf, agree)
