"""One run in the six coordinates, from event to event.

A step ends at the first of: a jump of C(t) or gamma(t), the end of a mesh period, a turning point
of y, the end of the regime, the moment at which a pair of teeth touches or parts by itself, a
change of sign of the contact force, a change of a sign in eq. (6), the end of sticking, and the
length that the tolerance allows. Turning points come first: up to the first one
y is monotone, so its end value shows whether it passes a level, and no touch of a level is missed.

What acts after an event follows from discrete facts, never from how close a number is to 0. The
event makes the quantity that located it exactly 0 (`series.MODE`); the sign of the first
coefficient of its series that does not vanish shows where it goes from there. A quantity that has
the wrong sign at the start of a step, left over by rounding, counts as such a 0 too. Only a motion
as small as the rounding errors themselves, of a mesh at rest, has no direction and no extrema.
"""

import numpy as np

from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH, regime_of
from gearmesh.model.motion import Z_2, Z_3
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.full.measures import (
    locate_extremes,
    measure,
    record_extremum,
    sample,
    take_value,
)
from gearmesh.solvers.full.roots import TABLE_ROWS, evaluate, evaluate_with_slope, refine
from gearmesh.solvers.full.series import NEW, UNDER_WAY, begin, expand, expand_outputs, level
from gearmesh.solvers.full.signs import (
    BRACKET_TURNED,
    RELEASED,
    REST,
    SLIP,
    first,
    first_of_signs,
    needed_force,
    settle_signs,
)
from gearmesh.solvers.full.tape import BRACKET, CONTACT, DEPTH, GAP, V, Y
from gearmesh.solvers.lanes.rows import unowned
from gearmesh.solvers.response import DIVERGED, FRICTION_UNDEFINED, STEP_LIMIT

PASSED, SEGMENT_ENDED, TURNED, CROSSED = range(4)
GAP_CROSSED, PARTED, PAIR_TURNED = 7, 8, 9
"""Events that end a step, beside those of `signs`."""

_SHORT = 0.1
"""In steps below this length the errors of the rates, not of the coordinates, limit the step."""

_regime_of = inner(regime_of)


@inner
def _count_loss(case, mode, summary):
    """Count a contact loss in a kept revolution; parted flanks have lost contact already."""
    if mode.period >= case.first_kept and not mode.parted:
        summary.contact_losses += 1


@inner
def _cross(case, mode, summary):
    """Enter the next regime in the direction of motion."""
    mode.level = level(case, mode.regime, mode.direction)
    mode.on_level = True
    if mode.regime == CONTACT_LOSS:
        mode.regime = NORMAL_MESH if mode.direction > 0.0 else INVERSE_MESH
    else:
        mode.regime = CONTACT_LOSS
        _count_loss(case, mode, summary)
    mode.parted = mode.on_force = False


@inner
def _settle_pairs(case, mode, pairs, series, summary):
    """Find which pairs of teeth press in the segment that has just begun."""
    for j in range(3):
        mode.pressing[j] = 1.0 if j < pairs and series[DEPTH + j, 0] >= 0.0 else 0.0
    mode.entered = False
    _settle_regime(case, mode, summary)


@inner
def _settle_regime(case, mode, summary):
    """Enter normal mesh if a pair of teeth presses, and leave it if none does."""
    presses = mode.pressing[0] + mode.pressing[1] + mode.pressing[2] > 0.0
    if presses == (mode.regime == NORMAL_MESH):
        return
    if not presses:
        _count_loss(case, mode, summary)
    mode.regime = NORMAL_MESH if presses else CONTACT_LOSS
    mode.parted = False


@inner
def _first_sign(case, mode, tape, variant, series):
    """Return the sign of the first coefficient of y' that does not vanish, 0 if all do."""
    expand(case, mode, tape, variant, series, case.order)
    for k in range(case.order):
        if series[V, k] != 0.0:
            return np.sign(series[V, k])
    return 0.0


@inner
def _settle_direction(case, mode, tape, variant, series, rest, extrema, summary):
    """Find the direction of motion and the regime, and record an extremum where y has turned."""
    if mode.direction * series[V, 0] < 0.0:
        # The turning point that was just passed; rounding has left its velocity off 0.
        mode.turns = True
        series[V, 0] = 0.0
    now = np.sign(series[V, 0])
    if abs(series[V, 0]) < rest:
        # Damping vanishes with y', so the acceleration does not depend on the direction.
        expand(case, mode, tape, variant, series, 2)
        if now == 0.0:
            now = np.sign(series[V, 1])
        if abs(series[V, 1]) < rest:
            mode.direction = now if now != 0.0 else _first_sign(case, mode, tape, variant, series)
            return
    if now != 0.0 and now != mode.direction:
        if mode.direction != 0.0:
            record_extremum(case, mode, series[Y, 0], extrema, summary)
        mode.direction = now
    if mode.direction == 0.0:
        return
    while mode.direction * (series[Y, 0] - level(case, mode.regime, mode.direction)) >= 0.0:
        _cross(case, mode, summary)
        series[Y, 0] = mode.level


@inner
def _choose_step(case, series, remaining):
    """Return the step, up to `remaining`, for which the last two terms are below the tolerance."""
    step = min(remaining, case.longest_step)
    for k in range(case.order - 1, case.order + 1):
        size = abs(series[Y, k])
        for i in range(case.acting):
            size = max(size, abs(series[i, k]))
        if size > 0.0:
            # A term of a rate is that of its coordinate times k and divided by the step.
            bound = case.tolerance / (k * size)
            step = min(step, bound ** (1.0 / k))
            if step < _SHORT:
                step = min(step, (bound / _SHORT) ** (1.0 / (k - 1)))
    return step


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
    total, power = 0.0, 1.0
    for k in range(degree + 1):
        total += abs(row[k]) * power
        if total >= rest:
            return False
        power *= step
    return True


@inner
def _find_event(case, segment, mode, state, step, series, rest, scaled, table):
    """Return the share of the step before its first event, and the event."""
    end = 1.0
    event = SEGMENT_ENDED if step == segment.end - mode.time else PASSED
    if not _rests(series[V], case.order - 1, step, rest):
        turn = first(series[V], case.order - 1, step, mode.direction, scaled, table)
        if turn <= 1.0:
            end, event = turn, TURNED
    if case.follows_run_out:
        signs, kind = first_of_signs(case, segment, mode, state, step, series, scaled, table)
        if signs < end:
            end, event = signs, kind
    if case.varying_backlash and mode.regime != NORMAL_MESH:
        sign = 1.0 if mode.regime == CONTACT_LOSS else -1.0
        crossing = first(series[GAP], case.order, step, sign, scaled, table)
        if crossing < end:
            end, event = crossing, GAP_CROSSED
    if case.single_pairs and mode.regime != INVERSE_MESH:
        for j in range(segment.pairs):
            sign = 2.0 * mode.pressing[j] - 1.0
            turns = first(series[DEPTH + j], case.order, step, sign, scaled, table)
            if turns < end:
                end, event = turns, PAIR_TURNED + j
    if case.non_adhesive and mode.regime != CONTACT_LOSS:
        sign = -mode.regime if mode.parted else mode.regime
        parts = first(series[CONTACT], case.order - 2, step, sign, scaled, table)
        if parts < end:
            end, event = parts, PARTED
    passed = level(case, mode.regime, mode.direction)
    y = evaluate(series[Y], case.order, end * step)
    if mode.direction != 0.0 and mode.direction * (y - passed) >= 0.0:
        power = step
        scaled[0] = series[Y, 0] - passed
        for k in range(1, case.order + 1):
            scaled[k] = series[Y, k] * power
            power *= step
        end = refine(scaled, case.order, 0.0, end, -mode.direction)
        event = CROSSED
    return end, event


@inner
def _advance(case, mode, state, series, duration):
    """Move the state along the series, and clear the marks of what was exactly 0 before."""
    if mode.time + duration == mode.time:
        return
    for i in range(case.coordinates):
        state[i], state[6 + i] = evaluate_with_slope(series[i], case.order, duration)
    mode.time += duration
    mode.turns = mode.on_level = mode.on_bracket = mode.released = False
    mode.on_gap = mode.on_force = False
    mode.on_pair[:] = 0.0


@inner
def _follow(case, segment, mode, state, event, summary):
    """Apply the changes of an event."""
    if event == SEGMENT_ENDED:
        mode.time = segment.end
    elif event == TURNED:
        mode.turns = True
    elif event == CROSSED:
        _cross(case, mode, summary)
    elif event == GAP_CROSSED:
        mode.on_gap = True
        leaves = mode.regime == INVERSE_MESH
        if leaves:
            _count_loss(case, mode, summary)
        mode.regime = CONTACT_LOSS if leaves else INVERSE_MESH
        mode.parted = False
    elif event == PARTED:
        mode.on_force = True
        _count_loss(case, mode, summary)
        mode.parted = not mode.parted
    elif event >= PAIR_TURNED:
        pair = event - PAIR_TURNED
        mode.on_pair[pair] = 1.0
        mode.pressing[pair] = 1.0 - mode.pressing[pair]
        _settle_regime(case, mode, summary)
    elif event == BRACKET_TURNED:
        mode.on_bracket = True
    elif event == SLIP:
        state[6 + Z_3] = state[6 + Z_2] = 0.5 * (state[6 + Z_3] + state[6 + Z_2])
    elif event == RELEASED:
        mode.slip_sign = 1.0 if needed_force(case, state) <= 0.0 else -1.0
        mode.released = True


@inner
def _pass_boundary(case, mode, state, tape, variant, series, strobes, summary):
    """Enter the next mesh period and write its stroboscopic point."""
    mode.period += 1
    mode.time, mode.segment = 0.0, 0
    mode.entered = True
    begin(case, mode, state, tape, variant, series)
    strobes[mode.period, 0] = series[Y, 0]
    strobes[mode.period, 1] = series[V, 0]
    if mode.period == case.first_kept or mode.period == case.periods:
        take_value(summary, series[Y, 0])


@inner
def _start(case, mode, pairs, state, tape, variant, series, strobes, summary):
    """Write the first stroboscopic point; set the branches of all laws if none are known."""
    begin(case, mode, state, tape, variant, series)
    y = series[Y, 0]
    strobes[0, 0] = y
    strobes[0, 1] = series[V, 0]
    if mode.stage == NEW:
        gap = series[GAP, 0] - y if case.varying_backlash else case.backlash
        mode.regime = _regime_of(y, gap)
        mode.run_out_sign = mode.slip_sign = 1.0
        if case.follows_run_out and series[BRACKET, 0] < 0.0:
            mode.run_out_sign = -1.0
        if case.single_pairs:
            _settle_pairs(case, mode, pairs, series, summary)
        if case.non_adhesive and mode.regime != CONTACT_LOSS:
            expand(case, mode, tape, variant, series, 2)
            mode.parted = mode.regime * series[CONTACT, 0] < 0.0
    mode.entered = True
    mode.stage = UNDER_WAY
    if case.first_kept == 0:
        take_value(summary, y)


@inner
def run(
    cases,
    segments,
    variants,
    tape,
    state,
    modes,
    strobes,
    extrema,
    samples,
    per_period,
    summaries,
    most_turns,
    workspace,
):
    """Integrate one run, or continue it.

    Parameters
    ----------
    cases : ndarray of `CASE`, shape (1,)
    segments : ndarray of `SEGMENT`, shape (1 or periods, segments)
        Segments of a mesh period, of each one if the speed changes. The last ends with the period.
    variants : ndarray of int, shape (periods + 1,)
        The kind of each period. Periods differ if single teeth have factors.
    tape : tuple of ndarray
        Numbers and branches of `gearmesh.solvers.full.recurrences.Recurrences` for the segments of
        every kind of period.
    state : ndarray, shape (12,)
        Coordinates and, from the seventh place, rates at the start; at the end afterwards.
    modes : ndarray of `MODE`, shape (1,)
        Zero for a new run. (A record that numba takes from an array does not keep it alive.)
    strobes : ndarray, shape (periods + 1, 2)
    extrema : ndarray of `EXTREMUM`
    samples : ndarray of `SAMPLE`
    per_period : int
        Samples in a kept period, 0 for none.
    summaries : ndarray of `SUMMARY`, shape (1,)
        y_max and y_min start from -inf and inf.
    most_turns : int
        Steps after which the function returns, to be called again.
    workspace : ndarray, shape (rows, WIDTH)
        Zeros: the series, and `TABLE_ROWS` + 1 rows for the search of roots.

    Returns
    -------
    bool
        Whether the run is over.
    """
    case, summary, mode = cases[0], summaries[0], modes[0]
    # Counting references to the arrays would take as long as the series of a step.
    tape = unowned(tape[0]), unowned(tape[1])
    segments, variants, state = unowned(segments), unowned(variants), unowned(state)
    strobes, extrema, samples = unowned(strobes), unowned(extrema), unowned(samples)
    series = unowned(workspace)
    table, scaled = series[-TABLE_ROWS:], series[-TABLE_ROWS - 1]
    if mode.stage != UNDER_WAY:
        pairs, kind = segments[0, 0].pairs, variants[mode.period]
        _start(case, mode, pairs, state, tape, kind, series, strobes, summary)
    last = summary.steps + most_turns
    while summary.steps < last:
        segment = segments[mode.period % segments.shape[0], mode.segment]
        if mode.time >= segment.end:
            mode.segment += 1
            mode.entered = True
            if mode.segment == segments.shape[1]:
                following = variants[mode.period + 1]
                _pass_boundary(case, mode, state, tape, following, series, strobes, summary)
                if mode.period == case.periods:
                    return True
            continue
        variant = variants[mode.period]
        begin(case, mode, state, tape, variant, series)
        if not abs(series[Y, 0]) < case.farthest:
            summary.status = DIVERGED
            return True
        if mode.entered and case.single_pairs:
            _settle_pairs(case, mode, segment.pairs, series, summary)
            begin(case, mode, state, tape, variant, series)
        settled = True
        if case.follows_run_out:
            settled = settle_signs(case, segment, mode, tape, variant, state, series)
        if not settled:
            summary.status = FRICTION_UNDEFINED
            return True
        summary.steps += 1
        if summary.steps > case.most_steps:
            summary.status = STEP_LIMIT
            return True
        rest = REST * _rounding(state)
        _settle_direction(case, mode, tape, variant, series, rest, extrema, summary)
        expand(case, mode, tape, variant, series, case.order)
        step = _choose_step(case, series, segment.end - mode.time)
        share, event = _find_event(case, segment, mode, state, step, series, rest, scaled, table)
        duration = share * step
        if mode.period >= case.first_kept:
            expand_outputs(case, mode, tape, variant, per_period > 0, series)
            measure(case, mode, series, duration, summary)
            if per_period:
                locate_extremes(case, series, duration, summary)
                until = segment.end if event == SEGMENT_ENDED else mode.time + duration
                sample(case, mode, series, until, samples, per_period, summary)
        _advance(case, mode, state, series, duration)
        _follow(case, segment, mode, state, event, summary)
    return False
