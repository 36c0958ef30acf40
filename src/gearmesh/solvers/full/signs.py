"""Both signs of eq. (6) with run-out, and sticking.

`gearmesh.model.friction` states the rules. Here they act on the series of a step: they find which
sign holds at its start, and where in it a sign changes or sticking ends.
"""

import numpy as np

from gearmesh.model.contact import CONTACT_LOSS
from gearmesh.model.friction import holding_force
from gearmesh.model.motion import Z_2, Z_3
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.full.roots import first_change
from gearmesh.solvers.full.series import expand
from gearmesh.solvers.full.tape import BRACKET, ELASTIC, FRICTION

REST = 32.0 * np.finfo(np.float64).eps
"""Motion of less than this many times the rounding of the coordinates is rest."""

BRACKET_TURNED, SLIP, RELEASED = 4, 5, 6
"""Events that change a sign: the bracket of eq. (6) turns, sliding ends, sticking ends."""

_holding_force = inner(holding_force)


@inner
def needed_force(case, state):
    """Return the F_T that holds z_3' = z_2'."""
    pull_3 = case.pulls[0, 0] * state[Z_3] + case.pulls[0, 1] * state[6 + Z_3]
    pull_2 = case.pulls[1, 0] * state[Z_2] + case.pulls[1, 1] * state[6 + Z_2]
    return _holding_force(pull_3, pull_2, case.masses[0], case.masses[1])


@inner
def _settle_slip(case, segment, mode, tape, variant, state, series):
    """Find the sign of z_3' - z_2', or that the flanks stick."""
    slip = state[6 + Z_3] - state[6 + Z_2]
    if mode.released or mode.slip_sign * slip > 0.0:
        return
    mean = 0.5 * (state[6 + Z_3] + state[6 + Z_2])
    for i in (Z_3, Z_2):
        state[6 + i] = series[i, 1] = series[6 + i, 0] = mean
    if abs(needed_force(case, state)) < REST:
        mean = 0.5 * (state[Z_3] + state[Z_2])
        for i in (Z_3, Z_2):
            state[i] = series[i, 0] = mean
    expand(case, mode, tape, variant, series, 2)
    available = case.friction * series[ELASTIC, 0] * segment.gamma * mode.run_out_sign
    opposes = available > 0.0
    if mode.on_level and mode.regime != CONTACT_LOSS:
        # The elastic force is 0 at this moment only; its sign afterwards is that of y'.
        opposes = mode.direction * segment.gamma * mode.run_out_sign > 0.0
    needed = needed_force(case, state)
    if opposes and abs(needed) <= available:
        mode.slip_sign = 0.0
    else:
        mode.slip_sign = 1.0 if needed <= 0.0 else -1.0


@inner
def settle_signs(case, segment, mode, tape, variant, state, series):
    """Find both signs of eq. (6); return whether there are any.

    Where friction pushes the bracket back to 0 from both sides, neither sign lasts.
    """
    if mode.run_out_sign * series[BRACKET, 0] < 0.0:
        mode.on_bracket = True
        series[BRACKET, 0] = 0.0
    if not mode.on_bracket:
        _settle_slip(case, segment, mode, tape, variant, state, series)
        return True
    slip_sign = mode.slip_sign
    for _ in range(2):
        mode.run_out_sign = -mode.run_out_sign
        mode.slip_sign = slip_sign
        _settle_slip(case, segment, mode, tape, variant, state, series)
        expand(case, mode, tape, variant, series, 2)
        if mode.run_out_sign * series[BRACKET, 1] >= 0.0:
            return True
    return False


@inner
def first(row, degree, step, sign, scaled, table):
    """Return the share of the step up to the first change of sign of the series in `row`."""
    power = 1.0
    for k in range(degree + 1):
        scaled[k] = row[k] * power
        power *= step
    return first_change(scaled, degree, sign, table)


@inner
def first_of_signs(case, segment, mode, state, step, series, scaled, table):
    """Return the share of the step up to the first change in eq. (6), and what it is."""
    degree = case.order - 1
    end = first(series[BRACKET], degree, step, mode.run_out_sign, scaled, table)
    event = BRACKET_TURNED
    row = np.zeros(degree + 1)
    if mode.slip_sign != 0.0:
        for k in range(degree + 1):
            row[k] = (k + 1) * (series[Z_3, k + 1] - series[Z_2, k + 1])
        if row[0] == 0.0 and mode.slip_sign * row[1] < 0.0:
            # Sticking has just ended: up to rounding, friction still balances the bearings.
            row[1] = 0.0
        slips = first(row, degree, step, mode.slip_sign, scaled, table)
        return (slips, SLIP) if slips < end else (end, event)
    # Friction holds while the force that it takes is within what is available, on either side.
    gives_way = 1.0 + end
    for side in (1.0, -1.0):
        for k in range(degree):
            available = case.friction * segment.gamma * mode.run_out_sign * series[ELASTIC, k]
            row[k] = available - side * series[FRICTION, k]
        gives_way = min(gives_way, first(row, degree - 1, step, 1.0, scaled, table))
    return (gives_way, RELEASED) if gives_way < end else (end, event)
