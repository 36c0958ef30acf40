"""What is measured on a run in the six coordinates: extrema, shares and samples."""

from typing import NamedTuple

import numpy as np

from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.full.roots import evaluate, evaluate_with_slope
from gearmesh.solvers.full.speeds import time_of_boundary, time_within
from gearmesh.solvers.full.tape import (
    BEARINGS,
    FRICTION,
    NORMAL,
    STIFFNESS,
    TRANSMISSION,
    V,
    Y,
)
from gearmesh.solvers.response import MAXIMUM, MEASURED, MINIMUM

EXTREMAL = (NORMAL, TRANSMISSION, *BEARINGS)
"""Rows whose least and greatest values are located, if the run is sampled."""

SUMMARY = np.dtype(
    [
        *MEASURED,
        ("least_contact_force", np.float64),
        ("extremes", np.float64, (len(EXTREMAL), 2)),
        ("samples", np.int64),
    ]
)
"""What is measured on a run, and how many samples were taken."""

SAMPLE = np.dtype(
    [
        (name, np.float64)
        for name in (
            *("time", "y", "v", "a", "stiffness", "friction", "regime"),
            *("normal", "transmission_error"),
            *("bearing_3", "bearing_2", "bearing_3_z", "bearing_2_z"),
        )
    ]
)


class Step(NamedTuple):
    """A step of a run.

    Attributes
    ----------
    start, duration : float
        In tau_s; `start` counts from the start of the run.
    period, segment : int
        The mesh period, and the place of the segment in it.
    y, gap : ndarray, shape (order + 1,)
        Taylor coefficients of y and, if the backlash varies, of y + s(t), from the start of the
        step.
    """

    start: float
    duration: float
    period: int
    segment: int
    y: np.ndarray
    gap: np.ndarray


_GRID = 8
_MOST_ITERATIONS = 20

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_NODES = 0.5 * (_NODES + 1.0)
_WEIGHTS = 0.5 * _WEIGHTS


@inner
def take_value(summary, y):
    """Update y_max and y_min with `y`."""
    summary.y_max = max(summary.y_max, y)
    summary.y_min = min(summary.y_min, y)


@inner
def record_extremum(case, mode, y, extrema, summary):
    """Record an extremum of y; once `extrema` is full, further ones are only counted."""
    if mode.period < case.first_kept:
        return
    n = summary.extrema
    summary.extrema = n + 1
    take_value(summary, y)
    if n >= extrema.size:
        return
    extremum = extrema[n]
    extremum.time = time_of_boundary(case, mode.period) + mode.time
    extremum.y = y
    extremum.kind = MAXIMUM if mode.direction > 0.0 else MINIMUM


@inner
def sample(case, mode, series, until, samples, per_period, summary):
    """Write the samples before `until`."""
    first = (mode.period - case.first_kept) * per_period
    while summary.samples - first < per_period:
        time = time_within(case, mode.period, summary.samples - first, per_period)
        if time >= until:
            return
        since = time - mode.time
        sample = samples[summary.samples]
        sample.time = time_of_boundary(case, mode.period) + time
        sample.y = evaluate(series[Y], case.order, since)
        sample.v, sample.a = evaluate_with_slope(series[V], case.order - 1, since)
        degree = case.order - 2
        sample.stiffness = evaluate(series[STIFFNESS], degree, since)
        sample.friction = evaluate(series[FRICTION], degree, since)
        sample.regime = CONTACT_LOSS if mode.parted else mode.regime
        sample.normal = evaluate(series[NORMAL], degree, since)
        sample.transmission_error = evaluate(series[TRANSMISSION], degree, since)
        sample.bearing_3 = evaluate(series[BEARINGS[0]], degree, since)
        sample.bearing_2 = evaluate(series[BEARINGS[1]], degree, since)
        sample.bearing_3_z = evaluate(series[BEARINGS[2]], degree, since)
        sample.bearing_2_z = evaluate(series[BEARINGS[3]], degree, since)
        summary.samples += 1


@inner
def measure(case, mode, series, duration, summary):
    """Add the step to the sums over the kept revolutions, and find the least contact force."""
    total = 0.0
    for i in range(_NODES.size):
        y = evaluate(series[Y], case.order, duration * _NODES[i])
        total += _WEIGHTS[i] * y * y
    summary.square_integral += total * duration
    if mode.regime == CONTACT_LOSS or mode.parted:
        summary.loss_time += duration
    elif mode.regime == INVERSE_MESH:
        summary.inverse_time += duration
    if mode.regime != CONTACT_LOSS:
        least = _least(series[NORMAL], case.order - 2, duration, mode.regime)
        summary.least_contact_force = min(summary.least_contact_force, least)


@inner
def locate_extremes(case, series, duration, summary):
    """Update the least and greatest values of the rows in `EXTREMAL`."""
    for i in range(len(EXTREMAL)):
        row = series[EXTREMAL[i]]
        least = _least(row, case.order - 2, duration, 1.0)
        greatest = -_least(row, case.order - 2, duration, -1.0)
        summary.extremes[i, 0] = min(summary.extremes[i, 0], least)
        summary.extremes[i, 1] = max(summary.extremes[i, 1], greatest)


@inner
def _least(row, degree, duration, sign):
    """Return the least value of `sign` times a series in <0; duration>.

    The least value on an even grid is the start. Newton's method then improves it.
    """
    least = np.inf
    place = 0.0
    for i in range(_GRID + 1):
        at = duration * i / _GRID
        value = sign * evaluate(row, degree, at)
        if value < least:
            least, place = value, at
    for _ in range(_MOST_ITERATIONS):
        slope = bend = 0.0
        for k in range(degree, 0, -1):
            bend = bend * place + slope
            slope = slope * place + k * row[k]
        if sign * bend <= 0.0:
            return least
        place = min(max(place - slope / bend, 0.0), duration)
        value = sign * evaluate(row, degree, place)
        if not value < least:
            return least
        least = value
    return least
