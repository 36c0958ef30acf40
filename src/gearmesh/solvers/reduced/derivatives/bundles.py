"""Motions side by side, a lane each, with their deviations.

The motions are those of the sweep (`gearmesh.solvers.reduced.sweep`), which is faster with eight of
them than `variational` with one. The deviations are those of `deviations`: four that belong to the
coordinates of the state, and the derivative with respect to the logarithm of the mesh period.

The equations of a deviation are linear, and the motion gives their coefficients. So one matrix, the
propagator of the step, moves all deviations to the end of the step. Its columns are the deviations
that are 1 in one coordinate at the start and 0 in the others. Time is measured in steps here, so
the value of a series at the end of the step is the sum of its coefficients.
"""

import numpy as np

from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes.operations import (
    any_lane,
    fma,
    lowest_bit,
    magnitude,
    select,
    spread,
    width_of,
)
from gearmesh.solvers.lanes.rows import get, load, put, store
from gearmesh.solvers.lanes.unrolling import unrolled
from gearmesh.solvers.reduced.derivatives.deviations import DEVIATIONS, SIZE
from gearmesh.solvers.reduced.events import CROSSED, SEGMENT_ENDED, find_event
from gearmesh.solvers.reduced.measures import turn
from gearmesh.solvers.reduced.records import begin, finish, idle
from gearmesh.solvers.reduced.sweep import all_empty, highest_power, settle, take_step
from gearmesh.solvers.reduced.taylor import choose_step, expand
from gearmesh.solvers.reduced.transitions import enter
from gearmesh.solvers.reduced.workspace import (
    BEARING_DAMPING,
    BEARING_STIFFNESS,
    CUBIC,
    ELASTIC,
    EVENT,
    FRICTION,
    LENGTH,
    LINEAR,
    LOAD,
    N_ROWS,
    OFFSET,
    ORDER,
    QUADRATIC,
    REMAINING,
    SIGN,
    TAKEN,
    TWO_MU,
    B,
    Y,
)

APART = N_ROWS
"""First of the rows of the deviations: dy of all of them, then dv, db and db'."""

DAMPING = APART + SIZE * DEVIATIONS
"""Row of the integral of the slope D of the damping law."""

_PROPAGATOR = DAMPING + 1  # by rows: the ends of dy for unit dy, dv, db and db', then those of dv

_SIDE_BY_SIDE = 2
"""Columns of the propagator that are expanded at once. One waits for its own results, four need
more registers than a processor has."""

_COLUMNS = _PROPAGATOR + SIZE * SIZE  # the columns that are being expanded, by rows
_KNOWN = _COLUMNS + SIZE * _SIDE_BY_SIDE  # the series of dv in these columns
_SLOPES = _KNOWN + ORDER * _SIDE_BY_SIDE  # the series of D
_PARTS = _SLOPES + ORDER  # the step divided by 1, 2, 3, ...
ALL_ROWS = _PARTS + ORDER
"""Number of rows of the workspace."""


def _slopes(rows, powers, step):
    """Return the series of D."""
    v, power = [rows[Y + 1]], None
    for k in range(1, ORDER):
        power = step if power is None else power * step
        v.append(rows[Y + k + 1] * (power * (k + 1.0)))
    slopes = [rows[LINEAR]]
    if powers > 1:
        quadratic = rows[QUADRATIC] * rows[SIGN] * 2.0
        slopes = [quadratic.times_plus(v[0], slopes[0]), *(quadratic * one for one in v[1:])]
    if powers > 2:
        cubic = rows[CUBIC] * 3.0
        for k in range(ORDER):
            square = v[0] * v[k]
            for i in range(1, k + 1):
                square = v[i].times_plus(v[k - i], square)
            slopes[k] = cubic.times_plus(square, slopes[k])
    return slopes


def _prepare(rows, powers):
    """Write the series of D and the parts of the step, and add the integral of D."""
    step, integral = rows[TAKEN], rows[DAMPING]
    for k in range(ORDER):
        rows[_PARTS + k] = step * (1.0 / (k + 1.0))
    for k, slope in enumerate(_slopes(rows, powers, step)):
        integral = slope.times_plus(step * (1.0 / (k + 1.0)), integral)
        rows[_SLOPES + k] = slope
    rows[DAMPING] = integral


def _carry(rows, nonlinear):
    """Move some columns of the propagator to the end of the step."""
    n = _SIDE_BY_SIDE

    def repeated(row):
        return rows[row].repeated(n)

    elastic, recoil, slope = repeated(ELASTIC), -repeated(TWO_MU), repeated(_SLOPES)
    support, damped = -repeated(BEARING_STIFFNESS), -repeated(BEARING_DAMPING)
    friction, share = repeated(FRICTION) * elastic, recoil - 1.0
    y, v, b, rate = ends = [rows.several(_COLUMNS + i * n, n) for i in range(SIZE)]
    for k in range(ORDER):
        rows[_KNOWN + k * n] = v
        normal = elastic * y
        for i in range(k if nonlinear else 0, 0, -1):
            normal = repeated(_SLOPES + i).times_plus(rows.several(_KNOWN + (k - i) * n, n), normal)
        normal = slope.times_plus(v, normal)
        bearing = damped.times_plus(rate, support * b)
        v_change = share.times_plus(normal, friction.times_plus(y, bearing))
        rate_change = recoil.times_plus(normal, bearing)
        part = repeated(_PARTS + k)
        y, v, b, rate = (part * change for change in (v, v_change, rate, rate_change))
        ends = [end + one for end, one in zip(ends, (y, v, b, rate), strict=True)]
        rows.settle()
    for i, end in enumerate(ends):
        rows[_COLUMNS + i * n] = end


def _propagate(rows):
    """Move all deviations to the end of the step."""
    propagator = [[rows[_PROPAGATOR + i * SIZE + j] for j in range(SIZE)] for i in range(SIZE)]
    for k in range(APART, APART + DEVIATIONS):
        before = [rows[k + i * DEVIATIONS] for i in range(SIZE)]
        for i, factors in enumerate(propagator):
            after = factors[0] * before[0]
            for factor, one in zip(factors[1:], before[1:], strict=True):
                after = factor.times_plus(one, after)
            rows[k + i * DEVIATIONS] = after


_prepare_linear = unrolled(lambda rows: _prepare(rows, 1))
_prepare_quadratic = unrolled(lambda rows: _prepare(rows, 2))
_prepare_cubic = unrolled(lambda rows: _prepare(rows, 3))
_carry_linear = unrolled(lambda rows: _carry(rows, False))
_carry_nonlinear = unrolled(lambda rows: _carry(rows, True))
_move = unrolled(_propagate)


@inner(inline="never")
def _carry_over(like, work, powers):
    """Move the deviations to the end of the step, under damping of the given powers."""
    if powers == 1:
        _prepare_linear(like, work)
    elif powers == 2:
        _prepare_quadratic(like, work)
    else:
        _prepare_cubic(like, work)
    for first in range(0, SIZE, _SIDE_BY_SIDE):
        for i in range(SIZE):
            for j in range(_SIDE_BY_SIDE):
                unit = spread(like, 1.0 if i == first + j else 0.0)
                store(work, _COLUMNS + i * _SIDE_BY_SIDE + j, unit)
        if powers == 1:
            _carry_linear(like, work)
        else:
            _carry_nonlinear(like, work)
        for i in range(SIZE):
            for j in range(_SIDE_BY_SIDE):
                end = load(like, work, _COLUMNS + i * _SIDE_BY_SIDE + j)
                store(work, _PROPAGATOR + i * SIZE + first + j, end)
    _move(like, work)


@inner
def _stretch(like, work, ended):
    """Add the effect of a longer mesh period on the state at the end of a segment.

    The segment is longer too, and the motion goes on for that time.
    """
    v, rate = load(like, work, Y + 1), load(like, work, B + 1)
    elastic = load(like, work, ELASTIC) * (load(like, work, Y) - load(like, work, OFFSET))
    slope = fma(load(like, work, CUBIC), v, load(like, work, QUADRATIC) * load(like, work, SIGN))
    normal = fma(fma(slope, v, load(like, work, LINEAR)), v, elastic)
    recoil = load(like, work, TWO_MU) * normal
    bearing = load(like, work, BEARING_STIFFNESS) * load(like, work, B)
    bearing = fma(load(like, work, BEARING_DAMPING), rate, bearing) + recoil
    push = load(like, work, LOAD) + load(like, work, FRICTION) * elastic
    length = select(ended, load(like, work, LENGTH), spread(like, 0.0))
    last = APART + DEVIATIONS - 1
    store(work, last, fma(length, v, load(like, work, last)))
    last += DEVIATIONS
    store(work, last, fma(length, push - normal - bearing, load(like, work, last)))
    last += DEVIATIONS
    store(work, last, fma(length, rate, load(like, work, last)))
    last += DEVIATIONS
    store(work, last, fma(length, -bearing, load(like, work, last)))


@inner
def _slope_of_chord(like, work):
    """Return the damping force divided by v."""
    v = magnitude(load(like, work, Y + 1))
    slope = fma(load(like, work, CUBIC), v, load(like, work, QUADRATIC))
    return fma(slope, v, load(like, work, LINEAR))


@inner
def _jump(like, work, crossed, before):
    """Let the deviations jump where the regime has changed, from `before` of `_slope_of_chord`."""
    moves = ~(load(like, work, Y + 1) == spread(like, 0.0))
    change = select(crossed & moves, _slope_of_chord(like, work) - before, spread(like, 0.0))
    recoil = -load(like, work, TWO_MU) * change
    for i in range(APART, APART + DEVIATIONS):
        apart = load(like, work, i)
        v, rate = i + DEVIATIONS, i + 3 * DEVIATIONS
        store(work, v, fma(apart, recoil - change, load(like, work, v)))
        store(work, rate, fma(apart, recoil, load(like, work, rate)))


@inner
def _enter_lane(work, width, lane, runs, summaries, strobes, index):
    """Put run `index` into the lane, with unit deviations."""
    begin(work, width, lane, runs, summaries, strobes, index)
    for row in range(APART, ALL_ROWS):
        put(work, width, row, lane, 0.0)
    for i in range(SIZE):
        put(work, width, APART + i * DEVIATIONS + i, lane, 1.0)


@inner
def _leave_lane(work, width, lane, summary, jacobian):
    """Record the end of a run, and its Jacobian, shape (SIZE * DEVIATIONS,)."""
    finish(work, width, lane, summary)
    for i in range(SIZE * DEVIATIONS):
        jacobian[i] = get(work, width, APART + i, lane)


@inner
def bundle(like, work, runs, count, summaries, strobes, extrema, jacobians, dampings):
    """Integrate the first `count` runs with their deviations.

    Parameters
    ----------
    like, runs, summaries, strobes, extrema
        As for the sweep.
    work : pointer
        ALL_ROWS rows.
    count : int
    jacobians : ndarray, shape (n, SIZE * DEVIATIONS)
    dampings : ndarray, shape (n,)
        Integral of D over the time.
    """
    width = width_of(like)
    indices = -np.ones(width, np.int64)
    following, ended = 0, (1 << width) - 1
    while True:
        while ended:
            lane = lowest_bit(ended)
            ended &= ended - 1
            index = indices[lane]
            if index >= 0:
                _leave_lane(work, width, lane, summaries[index], jacobians[index])
                dampings[index] = get(work, width, DAMPING, lane)
            if following < count:
                indices[lane] = following
                _enter_lane(work, width, lane, runs, summaries, strobes, following)
                following += 1
            else:
                indices[lane] = -1
                idle(work, width, lane)
            if not ended:
                enter(like, work)
                if all_empty(indices):
                    return
        turn(like, work, runs, indices, summaries, extrema)
        powers = highest_power(like, work)
        expand(like, work, powers)
        choose_step(like, work)
        find_event(like, work)
        _carry_over(like, work, powers)
        take_step(like, work)
        event = load(like, work, EVENT)
        crossed = event == spread(like, CROSSED)
        over = (event == spread(like, SEGMENT_ENDED)) | ~(
            load(like, work, REMAINING) > spread(like, 0.0)
        )
        if any_lane(over):
            _stretch(like, work, over)
        before = _slope_of_chord(like, work)
        ended = settle(like, work, indices, summaries, strobes)
        if any_lane(crossed):
            _jump(like, work, crossed, before)
