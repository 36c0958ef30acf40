"""The compiled sweep: many runs of the reduced system, a lane each, from event to event.

Every lane goes its own way: it stops at its own switches, pitch points, boundaries, turning
points and contact crossings, and takes the next run of the list as soon as it has finished one.
The arithmetic between two stops (`taylor`, `events`) and what follows a stop (`stops`) is common
to all lanes; what is recorded of a run, and where it begins and ends, is told lane by lane here.
"""

import numpy as np

from gearmesh.model.motion import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes import (
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
    zeros8,
)
from gearmesh.solvers.reduced.events import CROSSED, STOPPED, TURNED, find_event
from gearmesh.solvers.reduced.stops import cross_level, enter, next_segment
from gearmesh.solvers.reduced.taylor import (
    LONGEST_ANGLE,
    choose_step,
    direction,
    evaluate,
    evaluate_with_slope,
    expand,
)
from gearmesh.solvers.reduced.workspace import (
    BACKLASH,
    BEARING_DAMPING,
    BEARING_STIFFNESS,
    CONTACT_LOSSES,
    CUBIC,
    EVENT,
    FIRST_KEPT,
    INVERSE_TIME,
    KEPT,
    LENGTH,
    LOAD,
    LOG_TOLERANCE,
    LONGEST,
    LOSS_TIME,
    LUBRICANT,
    MATERIAL,
    MAX_SEGMENTS,
    MOST_STEPS,
    N_PLACES,
    N_ROWS,
    ORDER,
    PERIOD,
    PERIODS,
    QUADRATIC,
    REGIME,
    REMAINING,
    SEEN_V,
    SEEN_Y,
    SEGMENT,
    SEGMENT_FRICTION,
    SEGMENT_LENGTH,
    SEGMENT_STIFFNESS,
    SEGMENTS,
    SIGN,
    SINCE_BOUNDARY,
    SINCE_STOP,
    SQUARE_INTEGRAL,
    STEPS,
    TAKEN,
    TWO_MU,
    B,
    Y,
)
from gearmesh.solvers.response import (
    EXTREMUM_OVERFLOW,
    MAXIMUM,
    MEASURED,
    MINIMUM,
    NOT_FINITE,
    STEP_LIMIT,
)

SAMPLED = 3
"""Courses that are sampled: y, v and a."""

RUN = np.dtype(
    [
        ("segments", np.float64),
        ("length", np.float64, MAX_SEGMENTS),
        ("stiffness", np.float64, MAX_SEGMENTS),
        ("friction", np.float64, MAX_SEGMENTS),
        ("sample_end", np.float64, MAX_SEGMENTS),
        ("period", np.float64),
        ("periods", np.float64),
        ("first_kept", np.float64),
        ("material", np.float64, 3),
        ("lubricant", np.float64, 3),
        ("backlash", np.float64),
        ("two_mu", np.float64),
        ("bearing_stiffness", np.float64),
        ("bearing_damping", np.float64),
        ("start", np.float64, 4),
        ("log_tolerance", np.float64),
        ("most_extrema", np.float64),
    ]
)
"""One run as the kernel takes it, times in tau_s; whole numbers too are kept as floating ones.

For each stretch of constant stiffness and friction sign in a mesh period: its length, C/C_s, the
share of the elastic force that friction adds to u'', and the number of the first sample of the
period behind it. `start` is (u, u', b, b'); with more than `most_extrema` the run fails.
"""

SUMMARY = np.dtype([*MEASURED, ("final", np.float64, 4)])
"""What the kernel measures on a run, and (u, u', b, b') at its end."""

MOST_STEPS_PER_PERIOD = 2000
_FAR = 1e12

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)
_NODES = 0.5 * (_NODES + 1.0)
_WEIGHTS = 0.5 * _WEIGHTS


@inner
def _set(work, width, row, lane, value):
    work[row * width + lane] = value


@inner
def _get(work, width, row, lane):
    return work[row * width + lane]


@inner
def _take_value(summary, y):
    summary.y_max = max(summary.y_max, y)
    summary.y_min = min(summary.y_min, y)


@inner
def _record_strobe(strobes, index, boundary, y, v):
    if index < strobes.shape[0]:
        strobes[index, boundary, 0] = y
        strobes[index, boundary, 1] = v


@inner
def _begin(work, width, lane, runs, summaries, strobes, index):
    """Put run `index` into the lane; `enter` has to follow."""
    run = runs[index]
    for row in range(N_ROWS):
        _set(work, width, row, lane, 0.0)
    y = run.start[0] + run.start[2]
    v = run.start[1] + run.start[3]
    _set(work, width, Y, lane, y)
    _set(work, width, Y + 1, lane, v)
    _set(work, width, B, lane, run.start[2])
    _set(work, width, B + 1, lane, run.start[3])
    regime = NORMAL_MESH
    if y < 0.0:
        regime = INVERSE_MESH if y <= -run.backlash else CONTACT_LOSS
    _set(work, width, REGIME, lane, regime)
    _set(work, width, BACKLASH, lane, run.backlash)
    _set(work, width, LOAD, lane, 1.0)
    _set(work, width, TWO_MU, lane, run.two_mu)
    _set(work, width, BEARING_STIFFNESS, lane, run.bearing_stiffness)
    _set(work, width, BEARING_DAMPING, lane, run.bearing_damping)
    _set(work, width, LOG_TOLERANCE, lane, run.log_tolerance)
    for power in range(3):
        _set(work, width, MATERIAL + power, lane, run.material[power])
        _set(work, width, LUBRICANT + power, lane, run.lubricant[power])
    stiffest = 0.0
    for i in range(int(run.segments)):
        stiffest = max(stiffest, run.stiffness[i])
        _set(work, width, SEGMENT_LENGTH + i, lane, run.length[i])
        _set(work, width, SEGMENT_STIFFNESS + i, lane, run.stiffness[i])
        _set(work, width, SEGMENT_FRICTION + i, lane, run.friction[i])
    highest = np.sqrt(stiffest * (1.0 + run.two_mu) + run.bearing_stiffness)
    _set(work, width, LONGEST, lane, LONGEST_ANGLE / highest)
    _set(work, width, LENGTH, lane, run.length[0])
    _set(work, width, REMAINING, lane, run.length[0])
    _set(work, width, SEGMENTS, lane, run.segments)
    _set(work, width, PERIODS, lane, run.periods)
    _set(work, width, FIRST_KEPT, lane, run.first_kept)
    _set(work, width, MOST_STEPS, lane, MOST_STEPS_PER_PERIOD * run.periods)
    # SIGN stays 0, no direction yet: the first step must not be taken for a turning point.
    if run.first_kept == 0:
        _set(work, width, KEPT, lane, 1.0)
        _take_value(summaries[index], y)
    _record_strobe(strobes, index, 0, y, v)


@inner
def _idle(work, width, lane):
    """Leave the lane without a run: nothing moves in it, and it never stops."""
    for row in range(N_ROWS):
        _set(work, width, row, lane, 0.0)
    _set(work, width, REGIME, lane, NORMAL_MESH)
    _set(work, width, MOST_STEPS, lane, np.inf)
    _set(work, width, LONGEST, lane, 1.0)
    _set(work, width, LENGTH, lane, np.inf)
    _set(work, width, REMAINING, lane, np.inf)


@inner
def _pass_boundary(work, width, lane, index, summaries, strobes):
    """Record what belongs to the boundary of a mesh period."""
    period = _get(work, width, PERIOD, lane)
    y = _get(work, width, Y, lane)
    _record_strobe(strobes, index, int(period), y, _get(work, width, Y + 1, lane))
    if period == _get(work, width, FIRST_KEPT, lane):
        _set(work, width, KEPT, lane, 1.0)
        # Before, directions were not followed: no extremum is to be seen in a change here.
        _set(work, width, SIGN, lane, 0.0)
        _take_value(summaries[index], y)


@inner
def _finish(work, width, lane, summary):
    """Record what was measured on a run, and why it ends."""
    y, v = _get(work, width, Y, lane), _get(work, width, Y + 1, lane)
    b, rate = _get(work, width, B, lane), _get(work, width, B + 1, lane)
    summary.steps = int(_get(work, width, STEPS, lane))
    if not abs(y) + abs(b) < _FAR:
        summary.status = NOT_FINITE
    elif _get(work, width, PERIOD, lane) < _get(work, width, PERIODS, lane):
        summary.status = STEP_LIMIT
    else:
        _take_value(summary, y)
        summary.contact_losses = int(_get(work, width, CONTACT_LOSSES, lane))
        summary.square_integral = _get(work, width, SQUARE_INTEGRAL, lane)
        summary.loss_time = _get(work, width, LOSS_TIME, lane)
        summary.inverse_time = _get(work, width, INVERSE_TIME, lane)
        summary.final[0], summary.final[1] = y - b, v - rate
        summary.final[2], summary.final[3] = b, rate


@inner
def _turn(like, work, runs, indices, summaries, extrema):
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
        index = indices[lane]
        summary = summaries[index]
        y = _get(work, width, Y, lane)
        _take_value(summary, y)
        if index >= extrema.shape[0]:
            continue
        n = summary.extrema
        if n == runs[index].most_extrema:
            summary.status = EXTREMUM_OVERFLOW
            continue
        since_start = _get(work, width, PERIOD, lane) * runs[index].period
        extremum = extrema[index, n]
        extremum.time = since_start + _get(work, width, SINCE_BOUNDARY, lane)
        extremum.y = y
        extremum.kind = MINIMUM if _get(work, width, SIGN, lane) > 0.0 else MAXIMUM
        summary.extrema = n + 1


@inner
def _highest_power(like, work):
    """Return the highest power of v in the damping that acts in some lane."""
    zero = spread(like, 0.0)
    if any_lane(~(load(like, work, CUBIC) == zero)):
        return 3
    return 2 if any_lane(~(load(like, work, QUADRATIC) == zero)) else 1


@inner
def _integrate_square(like, work):
    """Add the integral of y^2 over the step that is taken (Gauss-Legendre, 6 nodes)."""
    end = load(like, work, TAKEN)
    total = spread(like, 0.0)
    for i in range(_NODES.size):
        y = evaluate(like, work, end * _NODES[i])
        total = fma(y * y, spread(like, _WEIGHTS[i]), total)
    kept_duration = end * load(like, work, KEPT)
    integral = fma(total, kept_duration, load(like, work, SQUARE_INTEGRAL))
    store(work, SQUARE_INTEGRAL, integral)


@inner
def _take_step(like, work):
    """Move every lane to the end of its step."""
    zero = spread(like, 0.0)
    duration = load(like, work, TAKEN)
    turned = load(like, work, EVENT) == spread(like, TURNED)
    if any_lane(turned | (load(like, work, EVENT) == spread(like, CROSSED))):
        y, v = evaluate_with_slope(like, work, Y, duration)
        # v is 0 at a turning point, to the last bit.
        v = select(turned, zero, v)
    else:
        # The last place that was looked at is the end: the same numbers, sooner.
        y, v = load(like, work, SEEN_Y + N_PLACES - 1), load(like, work, SEEN_V + N_PLACES - 1)
    b, rate = evaluate_with_slope(like, work, B, duration)
    store(work, Y, y)
    store(work, Y + 1, v)
    store(work, B, b)
    store(work, B + 1, rate)
    since_stop = load(like, work, SINCE_STOP) + duration
    store(work, SINCE_STOP, since_stop)
    store(work, REMAINING, load(like, work, LENGTH) - since_stop)
    store(work, SINCE_BOUNDARY, load(like, work, SINCE_BOUNDARY) + duration)
    store(work, STEPS, load(like, work, STEPS) + 1.0)
    kept = load(like, work, KEPT) * duration
    regime = load(like, work, REGIME)
    lost = select(regime == spread(like, CONTACT_LOSS), kept, zero)
    inverse = select(regime == spread(like, INVERSE_MESH), kept, zero)
    store(work, LOSS_TIME, load(like, work, LOSS_TIME) + lost)
    store(work, INVERSE_TIME, load(like, work, INVERSE_TIME) + inverse)


@inner
def _settle(like, work, indices, summaries, strobes):
    """Follow what ended the steps; return the lanes whose runs are over, as bits."""
    width = width_of(like)
    event = load(like, work, EVENT)
    crossed = event == spread(like, CROSSED)
    stopped = (event == spread(like, STOPPED)) | ~(load(like, work, REMAINING) > spread(like, 0.0))
    if any_lane(crossed):
        cross_level(like, work, crossed)
    if any_lane(stopped):
        waiting = lane_bits(next_segment(like, work, stopped))
        while waiting:
            lane = lowest_bit(waiting)
            waiting &= waiting - 1
            _pass_boundary(work, width, lane, indices[lane], summaries, strobes)
    if any_lane(crossed | stopped):
        enter(like, work)
    # Negated comparisons, so that a value that is not a number ends a run too.
    size = magnitude(load(like, work, Y)) + magnitude(load(like, work, B))
    over = ~(size < spread(like, _FAR))
    over = over | ~(load(like, work, STEPS) < load(like, work, MOST_STEPS))
    over = over | (load(like, work, PERIOD) >= load(like, work, PERIODS))
    return lane_bits(over & (load(like, work, LOAD) > spread(like, 0.0)))


@inner
def _sample(work, width, lane, run, samples, per_period):
    """Write the samples of y, v and a that fall on the step of one lane, a few at a time."""
    period = int(_get(work, width, PERIOD, lane))
    if period < run.first_kept:
        return
    like = zeros8()
    spacing = run.period / per_period
    segment = int(_get(work, width, SEGMENT, lane))
    since_boundary = _get(work, width, SINCE_BOUNDARY, lane)
    since_stop = _get(work, width, SINCE_STOP, lane)
    taken = _get(work, width, TAKEN, lane)
    # Which samples belong to a stretch is a matter of counting, not of rounding.
    last = int(run.sample_end[segment])
    if since_stop > 0.0:
        first = int(np.ceil(since_boundary / spacing))
    else:
        first = int(run.sample_end[segment - 1]) if segment > 0 else 0
    if _get(work, width, EVENT, lane) != STOPPED and _get(work, width, REMAINING, lane) > taken:
        last = min(last, int(np.ceil((since_boundary + taken) / spacing)))
    begin = (period - int(run.first_kept)) * per_period
    zero = spread(like, 0.0)
    # A chunk may write beyond `last`: the next step writes there again, rows have spare room.
    for i in range(first, last, width_of(like)):
        time = (lane_numbers(like) + float(i)) * spacing - since_boundary
        y = v = half_a = zero
        for k in range(ORDER, -1, -1):
            half_a = fma(half_a, time, v)
            v = fma(v, time, y)
            y = fma(y, time, spread(like, _get(work, width, Y + k, lane)))
        store_at(samples[0], begin + i, y)
        store_at(samples[1], begin + i, v)
        store_at(samples[2], begin + i, half_a * 2.0)


@inner
def sweep(like, work, runs, summaries, strobes, extrema, samples, samples_per_period):
    """Integrate all `runs` (see `RUN`); results stand at the index of the run.

    `work` points to N_ROWS rows of as many elements as there are lanes, best aligned to one row.
    `summaries` has one row for each run. `strobes` of shape (l, periods + 1, 2), `extrema` of shape
    (m, capacity) and `samples` of shape (n, SAMPLED, row) serve the first l, m and n runs; a row
    of samples has room for `lanes.WIDEST` more than it holds.
    """
    width = width_of(like)
    indices = np.full(width, -1, np.int64)
    pending = 0
    ended = (1 << width) - 1
    idle = 0
    while True:
        # A lane takes the next run as soon as it has none.
        while ended:
            lane = lowest_bit(ended)
            ended &= ended - 1
            if indices[lane] >= 0:
                _finish(work, width, lane, summaries[indices[lane]])
            if pending < runs.size:
                indices[lane] = pending
                _begin(work, width, lane, runs, summaries, strobes, pending)
                pending += 1
            else:
                indices[lane] = -1
                _idle(work, width, lane)
                idle += 1
            if not ended:
                enter(like, work)
        if idle == width:
            break
        _turn(like, work, runs, indices, summaries, extrema)
        expand(like, work, _highest_power(like, work))
        choose_step(like, work)
        find_event(like, work)
        if any_lane(load(like, work, KEPT) > spread(like, 0.0)):
            _integrate_square(like, work)
            for lane in range(width):
                index = indices[lane]
                if 0 <= index < samples.shape[0]:
                    _sample(work, width, lane, runs[index], samples[index], samples_per_period)
        _take_step(like, work)
        ended = _settle(like, work, indices, summaries, strobes)
