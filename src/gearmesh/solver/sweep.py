"""The compiled sweep: many runs of the reduced system, a lane each, from event to event.

Every lane goes its own way: it stops at its own switches, pitch points, boundaries, turning
points and contact crossings, and takes the next run of the list as soon as it has finished one.
The arithmetic between two stops is common (`taylor`, `events`); what follows a stop is told lane by
lane here.
"""

import numpy as np
from numba import njit

from gearmesh.motion import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH
from gearmesh.response import (
    EXTREMUM_OVERFLOW,
    MAXIMUM,
    MEASURED,
    MINIMUM,
    NOT_FINITE,
    OK,
    STEP_LIMIT,
)
from gearmesh.solver.events import bracket, crossing, fall
from gearmesh.solver.lanes import (
    any_lane,
    fma,
    lane_bits,
    lane_numbers,
    load,
    lowest_bit,
    magnitude,
    select,
    spread,
    store,
    store_at,
    width_of,
)
from gearmesh.solver.taylor import (
    BEARING_DAMPING,
    BEARING_STIFFNESS,
    CUBIC,
    ELASTIC,
    EVENT,
    FRICTION,
    GUARD,
    GUARDED,
    INVERSE,
    INVERSE_TIME,
    KEPT,
    LENGTH,
    LEVEL_ABOVE,
    LEVEL_BELOW,
    LINEAR,
    LOAD,
    LOG_TOLERANCE,
    LONGEST,
    LONGEST_ANGLE,
    LOSS_TIME,
    LOST,
    MOST_STEPS,
    N_ROWS,
    OFFSET,
    ORDER,
    QUADRATIC,
    REMAINING,
    SIGN,
    SINCE_BOUNDARY,
    SINCE_STOP,
    SQUARE_INTEGRAL,
    STEP,
    STEPS,
    TAKEN,
    TWO_MU,
    B,
    U,
    Y,
    choose_step,
    direction,
    evaluate,
    evaluate_with_slope,
    expand,
)

# What ends a step.
_PASSED, _TURNED, _CROSSED, _STOPPED = 0.0, 1.0, 2.0, 3.0

N_SAMPLE_ROWS = 8
"""Rows of samples: y, v, a, C/C_s, C (H1 + H2)/C_s, F_dyn, F_T, regime."""

MAX_SEGMENTS = 6
"""Most stretches of constant stiffness and friction sign in a mesh period."""

RUN = np.dtype(
    [
        ("segments", np.int64),
        ("length", np.float64, MAX_SEGMENTS),
        ("stiffness", np.float64, MAX_SEGMENTS),
        ("friction", np.float64, MAX_SEGMENTS),
        ("coulomb", np.float64, MAX_SEGMENTS),
        ("period", np.float64),
        ("periods", np.int64),
        ("first_kept", np.int64),
        ("material", np.float64, 3),
        ("lubricant", np.float64, 3),
        ("backlash", np.float64),
        ("two_mu", np.float64),
        ("bearing_stiffness", np.float64),
        ("bearing_damping", np.float64),
        ("start", np.float64, 4),
        ("log_tolerance", np.float64),
    ]
)
"""One run as the kernel takes it, times in tau_s.

For each stretch of constant stiffness and friction sign in a mesh period: its length, C/C_s, the
share of the elastic force that friction adds to u'' and the ratio of the friction force (6) to
the elastic force. `start` is (u, u', b, b').
"""

SUMMARY = np.dtype([*MEASURED, ("final", np.float64, 4)])
"""What the kernel measures on a run, and (u, u', b, b') at its end."""

PLACE = np.dtype(
    [
        ("run", np.int64),
        ("period", np.int64),
        ("segment", np.int64),
        ("regime", np.int64),
        ("sample", np.int64),
    ]
)
"""Where a lane stands."""

MOST_STEPS_PER_PERIOD = 2000
_FAR = 1e12

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_NODES = 0.5 * (_NODES + 1.0)
_WEIGHTS = 0.5 * _WEIGHTS


@njit
def _set(work, width, row, lane, value):
    work[row * width + lane] = value


@njit
def _get(work, width, row, lane):
    return work[row * width + lane]


@njit
def _enter_regime(work, width, lane, run, place):
    """Write the coefficients that act in the regime and stretch where the lane stands."""
    lost = place.regime == CONTACT_LOSS
    law = run.lubricant if lost else run.material
    _set(work, width, ELASTIC, lane, 0.0 if lost else run.stiffness[place.segment])
    _set(work, width, OFFSET, lane, -run.backlash if place.regime == INVERSE_MESH else 0.0)
    _set(work, width, LINEAR, lane, law[0])
    _set(work, width, QUADRATIC, lane, law[1])
    _set(work, width, CUBIC, lane, law[2])
    _set(work, width, FRICTION, lane, run.friction[place.segment])
    _set(work, width, LOST, lane, 1.0 if lost else 0.0)
    _set(work, width, INVERSE, lane, 1.0 if place.regime == INVERSE_MESH else 0.0)
    above, below = np.inf, -np.inf
    if place.regime == NORMAL_MESH:
        below = 0.0
    elif lost:
        above, below = 0.0, -run.backlash
    else:
        above = -run.backlash
    _set(work, width, LEVEL_ABOVE, lane, above)
    _set(work, width, LEVEL_BELOW, lane, below)
    # Turning points matter where they are kept, and where |v| v bends the damping.
    watches_v = lost or law[1] != 0.0 or _get(work, width, KEPT, lane) != 0.0
    _set(work, width, GUARD, lane, 0.0 if watches_v else float(place.regime))
    _set(work, width, GUARDED, lane, above if place.regime == INVERSE_MESH else 0.0)


@njit
def _take_value(summary, y):
    summary.y_max = max(summary.y_max, y)
    summary.y_min = min(summary.y_min, y)


@njit
def _record_strobe(strobes, index, boundary, y, v):
    if index < strobes.shape[0]:
        strobes[index, boundary, 0] = y
        strobes[index, boundary, 1] = v


@njit
def _begin(work, width, lane, runs, places, summaries, strobes, index):
    """Put run `index` into the lane."""
    run = runs[index]
    place = places[lane]
    place.run = index
    place.period = 0
    place.segment = 0
    place.sample = 0
    for row in range(N_ROWS):
        _set(work, width, row, lane, 0.0)
    for i in range(2):
        _set(work, width, U + i, lane, run.start[i])
        _set(work, width, B + i, lane, run.start[2 + i])
    y = run.start[0] + run.start[2]
    place.regime = NORMAL_MESH
    if y < 0.0:
        place.regime = INVERSE_MESH if y <= -run.backlash else CONTACT_LOSS
    _set(work, width, LOAD, lane, 1.0)
    _set(work, width, TWO_MU, lane, run.two_mu)
    _set(work, width, BEARING_STIFFNESS, lane, run.bearing_stiffness)
    _set(work, width, BEARING_DAMPING, lane, run.bearing_damping)
    _set(work, width, LOG_TOLERANCE, lane, run.log_tolerance)
    stiffest = 0.0
    for i in range(run.segments):
        stiffest = max(stiffest, run.stiffness[i])
    highest = np.sqrt(stiffest * (1.0 + run.two_mu) + run.bearing_stiffness)
    _set(work, width, LONGEST, lane, LONGEST_ANGLE / highest)
    _set(work, width, LENGTH, lane, run.length[0])
    _set(work, width, REMAINING, lane, run.length[0])
    _set(work, width, MOST_STEPS, lane, float(MOST_STEPS_PER_PERIOD * run.periods))
    _set(work, width, KEPT, lane, 1.0 if run.first_kept == 0 else 0.0)
    # SIGN stays 0, no direction yet: the first step must not be taken for a turning point.
    _enter_regime(work, width, lane, run, place)
    if run.first_kept == 0:
        _take_value(summaries[index], y)
    _record_strobe(strobes, index, 0, y, run.start[1] + run.start[3])


@njit
def _idle(work, width, lane, places):
    """Leave the lane without a run: nothing moves in it, and it never stops."""
    places[lane].run = -1
    for row in range(N_ROWS):
        _set(work, width, row, lane, 0.0)
    _set(work, width, MOST_STEPS, lane, np.inf)
    _set(work, width, LONGEST, lane, 1.0)
    _set(work, width, LENGTH, lane, np.inf)
    _set(work, width, REMAINING, lane, np.inf)
    _set(work, width, LEVEL_ABOVE, lane, np.inf)
    _set(work, width, LEVEL_BELOW, lane, -np.inf)


@njit
def _cross(work, width, lane, run, place, summary):
    """Change the regime and put y on the level exactly."""
    rising = _get(work, width, SIGN, lane) > 0.0
    if place.regime != CONTACT_LOSS:
        rising = place.regime == INVERSE_MESH
    level = _get(work, width, LEVEL_ABOVE if rising else LEVEL_BELOW, lane)
    _set(work, width, U, lane, level - _get(work, width, B, lane))
    if place.regime == CONTACT_LOSS:
        place.regime = NORMAL_MESH if rising else INVERSE_MESH
    else:
        place.regime = CONTACT_LOSS
        if place.period >= run.first_kept:
            summary.contact_losses += 1
    _enter_regime(work, width, lane, run, place)


@njit
def _next_segment(work, width, lane, run, place, summary, strobes):
    """Pass a switch, a pitch point or a boundary; return whether the run is over."""
    place.segment += 1
    if place.segment == run.segments:
        place.segment = 0
        place.period += 1
        place.sample = 0
        y = _get(work, width, U, lane) + _get(work, width, B, lane)
        v = _get(work, width, U + 1, lane) + _get(work, width, B + 1, lane)
        _record_strobe(strobes, place.run, place.period, y, v)
        _set(work, width, SINCE_BOUNDARY, lane, 0.0)
        if place.period == run.first_kept:
            _set(work, width, KEPT, lane, 1.0)
            # Before, directions were not followed: no extremum is to be seen in a change here.
            _set(work, width, SIGN, lane, 0.0)
            _take_value(summary, y)
        if place.period == run.periods:
            _take_value(summary, y)
            summary.square_integral = _get(work, width, SQUARE_INTEGRAL, lane)
            summary.loss_time = _get(work, width, LOSS_TIME, lane)
            summary.inverse_time = _get(work, width, INVERSE_TIME, lane)
            for i in range(2):
                summary.final[i] = _get(work, width, U + i, lane)
                summary.final[2 + i] = _get(work, width, B + i, lane)
            summary.steps = int(_get(work, width, STEPS, lane))
            return True
    _set(work, width, SINCE_STOP, lane, 0.0)
    _set(work, width, LENGTH, lane, run.length[place.segment])
    _set(work, width, REMAINING, lane, run.length[place.segment])
    _enter_regime(work, width, lane, run, place)
    return False


@njit
def _has_failed(work, width, lane, summary):
    """Record why the run of a lane cannot go on, if so."""
    if not abs(_get(work, width, U, lane) + _get(work, width, B, lane)) < _FAR:
        summary.status = NOT_FINITE
    elif not _get(work, width, STEPS, lane) < _get(work, width, MOST_STEPS, lane):
        summary.status = STEP_LIMIT
    return summary.status != OK


@njit
def _turn(like, work, runs, places, summaries, extrema):
    """Find the direction of motion, and record an extremum where it has changed."""
    width = width_of(like)
    now = direction(like, work)
    before = load(like, work, SIGN)
    store(work, SIGN, now)
    turned = (before * now < spread(like, 0.0)) & (load(like, work, KEPT) > spread(like, 0.0))
    waiting = lane_bits(turned)
    while waiting:
        lane = lowest_bit(waiting)
        waiting &= waiting - 1
        place = places[lane]
        summary = summaries[place.run]
        y = _get(work, width, U, lane) + _get(work, width, B, lane)
        _take_value(summary, y)
        if place.run >= extrema.shape[0]:
            continue
        n = summary.extrema
        if n == extrema.shape[1]:
            summary.status = EXTREMUM_OVERFLOW
            continue
        since_start = place.period * runs[place.run].period
        extremum = extrema[place.run, n]
        extremum.time = since_start + _get(work, width, SINCE_BOUNDARY, lane)
        extremum.y = y
        extremum.kind = MINIMUM if _get(work, width, SIGN, lane) > 0.0 else MAXIMUM
        summary.extrema = n + 1


@njit
def _highest_power(work, width):
    """Return the highest power of v in the damping that acts in some lane."""
    quadratic = False
    for lane in range(width):
        if _get(work, width, CUBIC, lane) != 0.0:
            return 3
        quadratic |= _get(work, width, QUADRATIC, lane) != 0.0
    return 2 if quadratic else 1


@njit
def _find_event(like, work):
    """Write how far the step goes, up to its first event, and what that event is."""
    zero = spread(like, 0.0)
    step = load(like, work, STEP)
    sign = load(like, work, SIGN)
    guard = load(like, work, GUARD)
    guards = ~(guard == zero)
    end = step
    falling = select(guards, guard, sign)
    found, low, high, guess = bracket(like, work, falling)
    if any_lane(found):
        end = select(found, fall(like, work, falling, found, low, high, guess), step)
    stopped = step >= load(like, work, REMAINING)
    event = select(stopped, spread(like, _STOPPED), spread(like, _PASSED))
    fallen = select(guards, spread(like, _CROSSED), spread(like, _TURNED))
    event = select(found, fallen, event)
    level = select(sign > zero, load(like, work, LEVEL_ABOVE), load(like, work, LEVEL_BELOW))
    last = evaluate(like, work, Y, ORDER + 1, end)
    crossed = (sign * (last - level) > zero) & ~guards
    if any_lane(crossed):
        end = select(crossed, crossing(like, work, level, crossed, end), end)
        event = select(crossed, spread(like, _CROSSED), event)
    store(work, TAKEN, end)
    store(work, EVENT, event)


@njit
def _integrate_square(like, work):
    """Add the integral of y^2 over the step that is taken (Gauss-Legendre, 8 nodes)."""
    end = load(like, work, TAKEN)
    total = spread(like, 0.0)
    for i in range(_NODES.size):
        y = evaluate(like, work, Y, ORDER + 1, end * _NODES[i])
        total = fma(y * y, spread(like, _WEIGHTS[i]), total)
    kept_duration = end * load(like, work, KEPT)
    integral = fma(total, kept_duration, load(like, work, SQUARE_INTEGRAL))
    store(work, SQUARE_INTEGRAL, integral)


@njit
def _take_step(like, work):
    """Move every lane to the end of its step; return those that need more, as bits."""
    duration = load(like, work, TAKEN)
    u, u_slope = evaluate_with_slope(like, work, U, ORDER + 1, duration)
    b, b_slope = evaluate_with_slope(like, work, B, ORDER + 1, duration)
    store(work, U, u)
    store(work, B, b)
    store(work, B + 1, b_slope)
    event = load(like, work, EVENT)
    turned = event == spread(like, _TURNED)
    # v is 0 at a turning point, to the last bit.
    store(work, U + 1, select(turned, -b_slope, u_slope))
    since_stop = load(like, work, SINCE_STOP) + duration
    remaining = load(like, work, LENGTH) - since_stop
    store(work, SINCE_STOP, since_stop)
    store(work, REMAINING, remaining)
    store(work, SINCE_BOUNDARY, load(like, work, SINCE_BOUNDARY) + duration)
    kept = load(like, work, KEPT) * duration
    store(work, LOSS_TIME, fma(load(like, work, LOST), kept, load(like, work, LOSS_TIME)))
    store(work, INVERSE_TIME, fma(load(like, work, INVERSE), kept, load(like, work, INVERSE_TIME)))
    steps = load(like, work, STEPS) + 1.0
    store(work, STEPS, steps)
    # Negated comparisons, so that a value that is not a number asks for attention too.
    quiet = (event < spread(like, _CROSSED)) & (remaining > spread(like, 0.0))
    quiet = quiet & (steps < load(like, work, MOST_STEPS))
    quiet = quiet & (magnitude(u) < spread(like, _FAR)) & (magnitude(b) < spread(like, _FAR))
    return lane_bits(~quiet)


@njit
def _settle(work, width, lane, runs, places, summaries, strobes):
    """Follow what ended the step of a lane; return whether its run is over."""
    place = places[lane]
    run = runs[place.run]
    summary = summaries[place.run]
    event = _get(work, width, EVENT, lane)
    if _has_failed(work, width, lane, summary):
        return True
    if event == _CROSSED:
        _cross(work, width, lane, run, place, summary)
    if event == _STOPPED or not _get(work, width, REMAINING, lane) > 0.0:
        return _next_segment(work, width, lane, run, place, summary, strobes)
    return False


@njit
def _sample(like, work, lane, runs, places, samples, per_period):
    """Write the samples of y, v and a that fall on the step of one lane, a few at a time."""
    width = width_of(like)
    place = places[lane]
    run = runs[place.run]
    if place.period < run.first_kept:
        return
    spacing = run.period / per_period
    since_boundary = _get(work, width, SINCE_BOUNDARY, lane)
    end = since_boundary + _get(work, width, TAKEN, lane)
    first = place.sample
    last = min(int(np.ceil(end / spacing)), per_period)
    if place.segment + 1 == run.segments and _get(work, width, EVENT, lane) == _STOPPED:
        last = per_period
    stiffness = run.stiffness[place.segment]
    engaged = _get(work, width, ELASTIC, lane)
    shift = engaged * _get(work, width, OFFSET, lane)
    gamma = run.coulomb[place.segment]
    rows = samples[place.run]
    row = rows.size // N_SAMPLE_ROWS
    begin = (place.period - run.first_kept) * per_period
    zero = spread(like, 0.0)
    # A chunk may write beyond `last`: the next step writes there again, rows have spare room.
    for i in range(first, last, width):
        time = (lane_numbers(like) + float(i)) * spacing - since_boundary
        y = v = half_a = zero
        for k in range(ORDER, -1, -1):
            half_a = fma(half_a, time, v)
            v = fma(v, time, y)
            y = fma(y, time, spread(like, _get(work, width, Y + k, lane)))
        at = begin + i
        store_at(rows, at, y)
        store_at(rows, at + row, v)
        store_at(rows, at + 2 * row, half_a * 2.0)
        store_at(rows, at + 3 * row, spread(like, stiffness))
        store_at(rows, at + 4 * row, spread(like, engaged))
        store_at(rows, at + 5 * row, y * stiffness)
        store_at(rows, at + 6 * row, (y * engaged - shift) * gamma)
        store_at(rows, at + 7 * row, spread(like, float(place.regime)))
    place.sample = max(first, last)


@njit
def sweep(like, work, runs, summaries, strobes, extrema, samples, samples_per_period):
    """Integrate all `runs` (see `RUN`); results stand at the index of the run.

    `work` has N_ROWS rows of as many elements as there are lanes, best aligned to one row.
    `summaries` has one row for each run. `strobes` of shape (l, periods + 1, 2), `extrema` of shape
    (m, capacity) and `samples` of shape (n, N_SAMPLE_ROWS * row) serve the first l, m and n runs;
    a row of samples has room for one chunk of lanes more than it holds.
    """
    width = width_of(like)
    places = np.zeros(width, dtype=PLACE)
    pending = 0
    active = 0
    for lane in range(width):
        if pending < runs.size:
            _begin(work, width, lane, runs, places, summaries, strobes, pending)
            pending += 1
            active += 1
        else:
            _idle(work, width, lane, places)
    while active > 0:
        _turn(like, work, runs, places, summaries, extrema)
        expand(like, work, _highest_power(work, width))
        choose_step(like, work)
        _find_event(like, work)
        if any_lane(load(like, work, KEPT) > spread(like, 0.0)):
            _integrate_square(like, work)
            for lane in range(width):
                if 0 <= places[lane].run < samples.shape[0]:
                    _sample(like, work, lane, runs, places, samples, samples_per_period)
        waiting = _take_step(like, work)
        while waiting:
            lane = lowest_bit(waiting)
            waiting &= waiting - 1
            if _settle(work, width, lane, runs, places, summaries, strobes):
                if pending < runs.size:
                    _begin(work, width, lane, runs, places, summaries, strobes, pending)
                    pending += 1
                else:
                    _idle(work, width, lane, places)
                    active -= 1
