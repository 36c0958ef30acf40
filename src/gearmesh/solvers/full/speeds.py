"""The mesh phase over time in the compiled solver, where the speed may change linearly.

`gearmesh.model.speeds` states the formulas.
"""

import math

from gearmesh.model.stiffness import TURN
from gearmesh.solvers.compilation import inner


@inner
def _frequency(case, periods):
    """Return nu after so many mesh periods of the run."""
    return math.sqrt(case.nu * case.nu + 2.0 * TURN * case.acceleration * periods)


@inner
def time_of_boundary(case, period):
    """Return tau_s from the start of the run to that of the mesh period `period`."""
    if case.acceleration == 0.0:
        return period * case.period
    return 2.0 * TURN * period / (case.nu + _frequency(case, period))


@inner
def time_within(case, period, part, parts):
    """Return how long the first `part` of so many equal `parts` of a mesh period lasts.

    The parts are equal in the mesh phase.
    """
    if case.acceleration == 0.0:
        return part * (case.period / parts)
    share = part / parts
    begins, ends = _frequency(case, period), _frequency(case, period + share)
    return 2.0 * TURN * share / (begins + ends)


@inner
def write_phase(case, mode, row):
    """Write the first terms of the mesh phase, in mesh periods from t = 0."""
    periods = case.start_period + mode.period + case.initial_phase
    if case.acceleration == 0.0:
        row[0] = periods + mode.time / case.period
        row[1] = 1.0 / case.period
        return
    nu = _frequency(case, mode.period)
    gained = case.acceleration * mode.time
    row[0] = periods + mode.time * (nu + 0.5 * gained) / TURN
    row[1] = (nu + gained) / TURN
    row[2] = 0.5 * case.acceleration / TURN
