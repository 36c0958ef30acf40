"""Quantities that the sweep measures during a run: extrema, the integral of y^2 and samples."""

import numpy as np

from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes.operations import (
    fma,
    lane_bits,
    lane_numbers,
    lowest_bit,
    spread,
    width_of,
    zeros8,
)
from gearmesh.solvers.lanes.rows import get, load, store, store_at
from gearmesh.solvers.reduced.events import SEGMENT_ENDED
from gearmesh.solvers.reduced.records import take_value
from gearmesh.solvers.reduced.taylor import direction, evaluate
from gearmesh.solvers.reduced.workspace import (
    EVENT,
    KEPT,
    ORDER,
    PERIOD,
    REMAINING,
    SEGMENT,
    SIGN,
    SINCE_BOUNDARY,
    SINCE_SEGMENT,
    SQUARE_INTEGRAL,
    TAKEN,
    B,
    Y,
)
from gearmesh.solvers.response import MAXIMUM, MINIMUM

SAMPLED = 5
"""Quantities that are sampled: y, v, a, b and b'."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)
_NODES = 0.5 * (_NODES + 1.0)
_WEIGHTS = 0.5 * _WEIGHTS


@inner
def turn(like, work, runs, indices, summaries, extrema):
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
        y = get(work, width, Y, lane)
        take_value(summary, y)
        if index >= extrema.shape[0]:
            continue
        n = summary.extrema
        summary.extrema = n + 1
        if n >= extrema.shape[1]:
            continue
        since_start = get(work, width, PERIOD, lane) * runs[index].period
        extremum = extrema[index, n]
        extremum.time = since_start + get(work, width, SINCE_BOUNDARY, lane)
        extremum.y = y
        extremum.kind = MINIMUM if get(work, width, SIGN, lane) > 0.0 else MAXIMUM


@inner
def integrate_square(like, work):
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
def sample(work, width, lane, run, samples, per_period):
    """Write the samples that fall on the step of one lane, a few at a time."""
    period = int(get(work, width, PERIOD, lane))
    if period < run.first_kept:
        return
    like = zeros8()
    spacing = run.period / per_period
    segment = int(get(work, width, SEGMENT, lane))
    since_boundary = get(work, width, SINCE_BOUNDARY, lane)
    since_stop = get(work, width, SINCE_SEGMENT, lane)
    taken = get(work, width, TAKEN, lane)
    # The samples of a segment are found by counting, so rounding has no effect.
    last = int(run.sample_end[segment])
    if since_stop > 0.0:
        first = int(np.ceil(since_boundary / spacing))
    else:
        first = int(run.sample_end[segment - 1]) if segment > 0 else 0
    if get(work, width, EVENT, lane) != SEGMENT_ENDED and get(work, width, REMAINING, lane) > taken:
        last = min(last, int(np.ceil((since_boundary + taken) / spacing)))
    begin = (period - int(run.first_kept)) * per_period
    zero = spread(like, 0.0)
    # A chunk may write beyond `last`: the next step writes there again, rows have spare room.
    for i in range(first, last, width_of(like)):
        time = (lane_numbers(like) + float(i)) * spacing - since_boundary
        y = v = half_a = b = b_rate = zero
        for k in range(ORDER, -1, -1):
            half_a = fma(half_a, time, v)
            v = fma(v, time, y)
            y = fma(y, time, spread(like, get(work, width, Y + k, lane)))
            b_rate = fma(b_rate, time, b)
            b = fma(b, time, spread(like, get(work, width, B + k, lane)))
        store_at(samples[0], begin + i, y)
        store_at(samples[1], begin + i, v)
        store_at(samples[2], begin + i, half_a * 2.0)
        store_at(samples[3], begin + i, b)
        store_at(samples[4], begin + i, b_rate)
