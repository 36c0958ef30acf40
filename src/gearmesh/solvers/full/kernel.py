"""One run in the six coordinates, from event to event.

A step ends at the first of: a jump of C(t) or gamma(t), a boundary of the mesh periods, a turning
point of y, the level of y that ends the regime, a change of a sign in eq. (6), the end of a spell
of sticking, the length that the tolerance allows. Turning points come first: up to the first one
y is monotone, so its end value tells whether it passes a level, and no touch of a level is lost.

What acts after an event follows from discrete facts, never from how close a number is to 0. The
event makes the quantity that located it exactly 0 (`general_series.MODE`); the sign of the first
coefficient of its series that does not vanish says where it goes from there. A quantity that has
the wrong sign at the start of a step, left over by rounding, counts as such a 0 too. Only a motion
as small as the rounding errors themselves, of a mesh at rest, has no direction and no extrema.

Sticking
--------
With run-out, F_T = -A sign(z_3' - z_2') with A = f_T E gamma times the first sign of eq. (6).
Where A > 0 it opposes the sliding. Then at z_3' = z_2' the flanks stick (Filippov) while the force
that holds them, half of what the bearings pull with, is within <-A; A>; F_T takes that value.
Where A < 0, eq. (6) drives the sliding and nothing can hold it: from z_3' = z_2' the flanks go
where the bearings pull them, and from exact rest in the direction of sign +1.

The first sign could stick too, where friction turns its bracket back to 0 from both sides. It takes
run-outs that cancel each other, or friction far beyond what is known of gears, and is not treated:
such a run ends as one that takes too many steps.
"""

import numpy as np

from gearmesh.model.motion import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH, Z_2, Z_3
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.full.roots import (
    TABLE_SHAPE,
    evaluate,
    evaluate_with_slope,
    first_change,
    refine,
)
from gearmesh.solvers.full.series import (
    BRACKET,
    ELASTIC,
    FRICTION,
    SERIES_SHAPE,
    STIFFNESS,
    V,
    Y,
    begin,
    elastic_coefficient,
    expand,
    level,
)
from gearmesh.solvers.response import (
    EXTREMUM_OVERFLOW,
    MAXIMUM,
    MEASURED,
    MINIMUM,
    NOT_FINITE,
    OK,
    STEP_LIMIT,
)

SUMMARY = np.dtype([*MEASURED, ("samples", np.int64)])
"""What is measured on a run, and how many samples were taken."""

SAMPLE = np.dtype(
    [(name, np.float64) for name in ("time", "y", "v", "a", "stiffness", "friction", "regime")]
)

_PASSED, _STOPPED, _TURNED, _CROSSED, _BRACKET, _SLIP, _RELEASED = range(7)

# Motion of less than this many times the rounding of the coordinates is rest: it has no direction.
_REST = 32.0 * np.finfo(np.float64).eps

# Beyond this relative motion, in y_st, a run counts as lost.
_FAR = 1e9

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_NODES = 0.5 * (_NODES + 1.0)
_WEIGHTS = 0.5 * _WEIGHTS


@inner
def _take_value(summary, y):
    summary.y_max = max(summary.y_max, y)
    summary.y_min = min(summary.y_min, y)


@inner
def _record_extremum(case, mode, y, extrema, summary):
    if mode.period < case.first_kept:
        return
    n = summary.extrema
    if n == extrema.size:
        summary.status = EXTREMUM_OVERFLOW
        return
    extremum = extrema[n]
    extremum.time = mode.period * case.period + mode.time
    extremum.y = y
    extremum.kind = MAXIMUM if mode.direction > 0.0 else MINIMUM
    summary.extrema = n + 1
    _take_value(summary, y)


@inner
def _cross(case, mode, summary):
    """Enter the next regime in the direction of motion."""
    mode.level = level(case, mode.regime, mode.direction)
    mode.on_level = True
    if mode.regime == CONTACT_LOSS:
        mode.regime = NORMAL_MESH if mode.direction > 0.0 else INVERSE_MESH
    else:
        mode.regime = CONTACT_LOSS
        if mode.period >= case.first_kept:
            summary.contact_losses += 1


@inner
def _first_sign(case, stretch, mode, fourier, series):
    """Return the sign of the first coefficient of y' that does not vanish, 0 if all do."""
    expand(case, stretch, mode, fourier, series, case.order)
    for k in range(case.order):
        if series[V, k] != 0.0:
            return np.sign(series[V, k])
    return 0.0


@inner
def _settle_direction(case, stretch, mode, fourier, series, rest, extrema, summary):
    """Find the direction of motion and the regime, and record an extremum where y has turned."""
    if mode.direction * series[V, 0] < 0.0:
        # The turning point just passed, but for rounding.
        mode.turns = True
        series[V, 0] = 0.0
    now = np.sign(series[V, 0])
    if abs(series[V, 0]) < rest:
        # With y' damping vanishes, and the acceleration does not depend on the direction.
        expand(case, stretch, mode, fourier, series, 2)
        if now == 0.0:
            now = np.sign(series[V, 1])
        if abs(series[V, 1]) < rest:
            mode.direction = (
                now if now != 0.0 else _first_sign(case, stretch, mode, fourier, series)
            )
            return
    if now != 0.0 and now != mode.direction:
        if mode.direction != 0.0:
            _record_extremum(case, mode, series[Y, 0], extrema, summary)
        mode.direction = now
    if mode.direction == 0.0:
        return
    while mode.direction * (series[Y, 0] - level(case, mode.regime, mode.direction)) >= 0.0:
        _cross(case, mode, summary)
        series[Y, 0] = mode.level


@inner
def _needed_force(case, state):
    """Return the F_T that holds z_3' = z_2'."""
    return 0.5 * case.bearing_stiffness * (state[Z_3] - state[Z_2])


@inner
def _settle_slip(case, stretch, mode, fourier, state, series):
    """Find the sign of z_3' - z_2', or that the flanks stick."""
    slip = state[6 + Z_3] - state[6 + Z_2]
    if mode.released or mode.slip_sign * slip > 0.0:
        return
    mean = 0.5 * (state[6 + Z_3] + state[6 + Z_2])
    for i in (Z_3, Z_2):
        state[6 + i] = series[i, 1] = mean
    if abs(_needed_force(case, state)) < _REST:
        mean = 0.5 * (state[Z_3] + state[Z_2])
        for i in (Z_3, Z_2):
            state[i] = series[i, 0] = mean
    elastic = elastic_coefficient(case, stretch, mode, series, fourier, 0)
    available = case.friction * elastic * stretch.gamma * mode.run_out_sign
    opposes = available > 0.0
    if mode.on_level and mode.regime != CONTACT_LOSS:
        # The elastic force is 0 only now; where y goes, it goes.
        opposes = mode.direction * stretch.gamma * mode.run_out_sign > 0.0
    needed = _needed_force(case, state)
    if opposes and abs(needed) <= available:
        mode.slip_sign = 0.0
    else:
        mode.slip_sign = 1.0 if needed <= 0.0 else -1.0


@inner
def _settle_signs(case, stretch, mode, fourier, state, series):
    """Find both signs of eq. (6); return whether there are any.

    Where friction pushes the bracket back to 0 from both sides, neither sign lasts.
    """
    if mode.run_out_sign * series[BRACKET, 0] < 0.0:
        mode.on_bracket = True
        series[BRACKET, 0] = 0.0
    if not mode.on_bracket:
        _settle_slip(case, stretch, mode, fourier, state, series)
        return True
    slip_sign = mode.slip_sign
    for _ in range(2):
        mode.run_out_sign = -mode.run_out_sign
        mode.slip_sign = slip_sign
        _settle_slip(case, stretch, mode, fourier, state, series)
        expand(case, stretch, mode, fourier, series, 2)
        if mode.run_out_sign * series[BRACKET, 1] >= 0.0:
            return True
    return False


@inner
def _choose_step(case, series, remaining):
    """Return the step for which the last two terms stay below the tolerance, to the next stop."""
    step = min(remaining, case.longest_step)
    for k in range(case.order - 1, case.order + 1):
        size = abs(series[Y, k])
        for i in range(6):
            size = max(size, abs(series[i, k]))
        if size > 0.0:
            # The rates have k times the terms of the coordinates.
            step = min(step, (case.tolerance / (k * size)) ** (1.0 / k))
    return step


@inner
def _first(row, degree, step, sign, scaled, table):
    """Return the share of the step up to the first change of sign of the series in `row`."""
    power = 1.0
    for k in range(degree + 1):
        scaled[k] = row[k] * power
        power *= step
    return first_change(scaled, degree, sign, table)


@inner
def _first_of_signs(case, stretch, mode, state, step, series, scaled, table):
    """Return the share of the step up to the first change in eq. (6), and what it is."""
    degree = case.order - 1
    end = _first(series[BRACKET], degree, step, mode.run_out_sign, scaled, table)
    event = _BRACKET
    row = np.zeros(degree + 1)
    if mode.slip_sign != 0.0:
        for k in range(degree + 1):
            row[k] = (k + 1) * (series[Z_3, k + 1] - series[Z_2, k + 1])
        if row[0] == 0.0 and mode.slip_sign * row[1] < 0.0:
            # The end of sticking: friction still balances the bearings, but for rounding.
            row[1] = 0.0
        slips = _first(row, degree, step, mode.slip_sign, scaled, table)
        return (slips, _SLIP) if slips < end else (end, event)
    for k in range(degree):
        row[k] = case.friction * stretch.gamma * mode.run_out_sign * series[ELASTIC, k]
    row[0] -= abs(_needed_force(case, state))
    gives_way = _first(row, degree - 1, step, 1.0, scaled, table)
    return (gives_way, _RELEASED) if gives_way < end else (end, event)


@inner
def _rounding(state):
    """Return the scale of the rounding errors of y' and y'', with forces of 1 and more."""
    total = 1.0
    for i in range(12):
        total += abs(state[i])
    return total


@inner
def _rests(row, degree, step, rest):
    """Return whether a series stays below `rest` throughout the step."""
    total = 0.0
    power = 1.0
    for k in range(degree + 1):
        total += abs(row[k]) * power
        if total >= rest:
            return False
        power *= step
    return True


@inner
def _find_event(case, stretch, mode, state, step, series, rest, scaled, table):
    """Return the share of the step up to its first event, and what that is."""
    end = 1.0
    event = _STOPPED if step == stretch.end - mode.time else _PASSED
    if not _rests(series[V], case.order - 1, step, rest):
        turn = _first(series[V], case.order - 1, step, mode.direction, scaled, table)
        if turn <= 1.0:
            end, event = turn, _TURNED
    if case.follows_run_out:
        signs, kind = _first_of_signs(case, stretch, mode, state, step, series, scaled, table)
        if signs < end:
            end, event = signs, kind
    passed = level(case, mode.regime, mode.direction)
    y = evaluate(series[Y], case.order, end * step)
    if mode.direction != 0.0 and mode.direction * (y - passed) >= 0.0:
        power = step
        scaled[0] = series[Y, 0] - passed
        for k in range(1, case.order + 1):
            scaled[k] = series[Y, k] * power
            power *= step
        end = refine(scaled, case.order, 0.0, end, -mode.direction)
        event = _CROSSED
    return end, event


@inner
def _sample(case, stretch, mode, fourier, series, until, samples, per_period, summary):
    """Write the samples before `until`."""
    first = (mode.period - case.first_kept) * per_period
    while summary.samples - first < per_period:
        time = (summary.samples - first) * (case.period / per_period)
        if time >= until:
            return
        since = time - mode.time
        sample = samples[summary.samples]
        sample.time = mode.period * case.period + time
        sample.y = evaluate(series[Y], case.order, since)
        sample.v, sample.a = evaluate_with_slope(series[V], case.order - 1, since)
        sample.stiffness = stretch.stiffness
        if fourier:
            sample.stiffness = evaluate(series[STIFFNESS], case.order, since)
        sample.friction = 0.0
        if case.friction != 0.0:
            sample.friction = evaluate(series[FRICTION], case.order - 2, since)
        sample.regime = mode.regime
        summary.samples += 1


@inner
def _measure(case, mode, series, duration, summary):
    """Add the step to the sums over the kept revolutions."""
    total = 0.0
    for i in range(_NODES.size):
        y = evaluate(series[Y], case.order, duration * _NODES[i])
        total += _WEIGHTS[i] * y * y
    summary.square_integral += total * duration
    if mode.regime == CONTACT_LOSS:
        summary.loss_time += duration
    elif mode.regime == INVERSE_MESH:
        summary.inverse_time += duration


@inner
def _advance(case, mode, state, series, duration):
    """Move the state along the series; forget what was exactly 0 before."""
    if mode.time + duration == mode.time:
        return
    for i in range(6):
        state[i], state[6 + i] = evaluate_with_slope(series[i], case.order, duration)
    mode.time += duration
    mode.turns = mode.on_level = mode.on_bracket = mode.released = False


@inner
def _follow(case, stretch, mode, state, event, summary):
    """Change what the event changes."""
    if event == _STOPPED:
        mode.time = stretch.end
    elif event == _TURNED:
        mode.turns = True
    elif event == _CROSSED:
        _cross(case, mode, summary)
    elif event == _BRACKET:
        mode.on_bracket = True
    elif event == _SLIP:
        state[6 + Z_3] = state[6 + Z_2] = 0.5 * (state[6 + Z_3] + state[6 + Z_2])
    elif event == _RELEASED:
        mode.slip_sign = 1.0 if _needed_force(case, state) <= 0.0 else -1.0
        mode.released = True


@inner
def _pass_boundary(case, mode, state, waves, deviation, series, strobes, summary):
    """Enter the next mesh period and write its strobe."""
    mode.period += 1
    mode.time = 0.0
    mode.stretch = 0
    begin(case, mode, state, waves, deviation, series)
    strobes[mode.period, 0] = series[Y, 0]
    strobes[mode.period, 1] = series[V, 0]
    if mode.period == case.first_kept or mode.period == case.periods:
        _take_value(summary, series[Y, 0])


@inner
def _start(case, mode, state, waves, deviation, series, strobes, summary):
    """Set the branches of all laws in the state at the start."""
    begin(case, mode, state, waves, deviation, series)
    y = series[Y, 0]
    strobes[0, 0] = y
    strobes[0, 1] = series[V, 0]
    mode.regime = NORMAL_MESH
    if y < 0.0:
        mode.regime = CONTACT_LOSS if y > -case.backlash else INVERSE_MESH
    mode.run_out_sign = 1.0
    mode.slip_sign = 1.0
    if case.follows_run_out and series[BRACKET, 0] < 0.0:
        mode.run_out_sign = -1.0
    if case.first_kept == 0:
        _take_value(summary, y)


@inner
def run(
    cases,
    stretches,
    waves,
    deviation,
    state,
    modes,
    strobes,
    extrema,
    samples,
    per_period,
    summaries,
):
    """Integrate one run.

    Parameters
    ----------
    cases : ndarray of `CASE`, shape (1,)
    stretches : ndarray of `STRETCH`
        Of a mesh period, in their order; the last one ends with it.
    waves, deviation : ndarray, shape (n, 2)
        Amplitudes (cosine, sine) of the truncated series of C(t), empty for the rectangular wave,
        and of the profile deviation.
    state : ndarray, shape (12,)
        Coordinates and rates at the start; at the end of the run afterwards.
    modes : ndarray of `MODE`, shape (1,)
        Workspace, zero. (A record that numba takes from an array does not keep it alive.)
    strobes : ndarray, shape (periods + 1, 2)
    extrema : ndarray of `EXTREMUM`
    samples : ndarray of `SAMPLE`
    per_period : int
        Samples in a kept period, 0 for none.
    summaries : ndarray of `SUMMARY`, shape (1,)
        y_max and y_min start from -inf and inf.
    """
    case = cases[0]
    summary = summaries[0]
    mode = modes[0]
    series = np.zeros(SERIES_SHAPE)
    scaled = np.zeros(SERIES_SHAPE[1])
    table = np.zeros(TABLE_SHAPE)
    fourier = waves.shape[0] > 0
    _start(case, mode, state, waves, deviation, series, strobes, summary)
    while summary.status == OK:
        stretch = stretches[mode.stretch]
        if mode.time >= stretch.end:
            mode.stretch += 1
            if mode.stretch == stretches.size:
                _pass_boundary(case, mode, state, waves, deviation, series, strobes, summary)
                if mode.period == case.periods:
                    return
            continue
        begin(case, mode, state, waves, deviation, series)
        if not abs(series[Y, 0]) < _FAR:
            summary.status = NOT_FINITE
            return
        settled = True
        if case.follows_run_out:
            settled = _settle_signs(case, stretch, mode, fourier, state, series)
        summary.steps += 1
        if not settled or summary.steps > case.most_steps:
            summary.status = STEP_LIMIT
            return
        rest = _REST * _rounding(state)
        _settle_direction(case, stretch, mode, fourier, series, rest, extrema, summary)
        expand(case, stretch, mode, fourier, series, case.order)
        step = _choose_step(case, series, stretch.end - mode.time)
        share, event = _find_event(case, stretch, mode, state, step, series, rest, scaled, table)
        duration = share * step
        if mode.period >= case.first_kept:
            _measure(case, mode, series, duration, summary)
            if per_period:
                until = stretch.end if event == _STOPPED else mode.time + duration
                _sample(case, stretch, mode, fourier, series, until, samples, per_period, summary)
        _advance(case, mode, state, series, duration)
        _follow(case, stretch, mode, state, event, summary)
