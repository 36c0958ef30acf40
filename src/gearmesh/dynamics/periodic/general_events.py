"""Events along an orbit of the general solver, located on the Taylor series of its steps.

Each step ends where a law jumps, so its series holds for the whole step: events are found on it as
exactly as the motion itself is known.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.polynomial import polynomial

from gearmesh.model.mesh import mesh_stiffness
from gearmesh.model.problem import Problem
from gearmesh.model.segments import segments
from gearmesh.solvers.full.measures import Step
from gearmesh.solvers.reduced.derivatives.variational import (
    AFTER,
    BEFORE,
    EVENT_SIZE,
    HEIGHT,
    KIND,
    SEGMENT,
    SWITCH,
    TIME,
    VELOCITY,
)

_GRID = np.linspace(0.0, 1.0, 9)  # places in a step between which a rate changes sign once
_SAME = 1e-12  # difference of stiffnesses that are equal but for rounding


def stiffness_jumps(problem: Problem, steps: Sequence[Step]) -> np.ndarray:
    """Return the events at which C(t) jumps.

    Their columns are those of `gearmesh.solvers.reduced.derivatives.variational`; that of the
    regime is not filled in. A jump at the initial phase is the last event.
    """
    parts = segments(problem)
    middles = [problem.initial_phase + 0.5 * (part.start + part.end) for part in parts]
    found = []
    for step, following in pairwise([*steps, steps[0]]):
        if (step.period, step.segment) == (following.period, following.segment) and len(steps) > 1:
            continue
        phase = problem.initial_phase + step.period + parts[step.segment].end
        sides = [
            mesh_stiffness(problem, phase, one.period + middles[one.segment])
            for one in (step, following)
        ]
        if abs(sides[0] - sides[1]) < _SAME:
            continue
        event = np.zeros(EVENT_SIZE)
        event[TIME], event[KIND] = step.start + step.duration, SWITCH
        for column, order in ((HEIGHT, 0), (VELOCITY, 1), (BEFORE, 2)):
            event[column] = polynomial.polyval(step.duration, polynomial.polyder(step.y, order))
        event[AFTER], event[SEGMENT] = 2.0 * following.y[2], following.segment
        found.append(event)
    return np.array(found).reshape(-1, EVENT_SIZE)


def gap_extrema(steps: Sequence[Step]) -> np.ndarray:
    """Return the extrema of y + s(t), shape (n, 3): time, height, kind (1 or -1)."""
    found = []
    rate = 0.0
    for step in steps:
        slopes = polynomial.polyder(step.gap)
        for time, kind in _turns(step, slopes, rate):
            found.append((step.start + time, polynomial.polyval(time, step.gap), kind))
        rate = float(polynomial.polyval(step.duration, slopes))
    return np.array(found).reshape(-1, 3)


def _turns(step: Step, slopes: np.ndarray, rate: float) -> Iterator[tuple[float, float]]:
    """Yield times in a step at which a rate changes sign, and its sign before.

    `rate` is the rate at the end of the step before. Rounding may leave the change of sign between
    two steps.
    """
    from scipy.optimize import brentq  # here, because it takes long to import

    times = step.duration * _GRID
    rates = polynomial.polyval(times, slopes)
    if rate * rates[0] < 0.0:
        yield 0.0, float(np.sign(rate))
    for i in np.flatnonzero(rates[:-1] * rates[1:] < 0.0):
        time = brentq(polynomial.polyval, times[i], times[i + 1], (slopes,), xtol=1e-15)
        yield time, float(np.sign(rates[i]))
