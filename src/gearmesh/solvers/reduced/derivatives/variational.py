"""Integration of the reduced equations of motion and their variational equations, event by event.

The equations are those of `gearmesh.solvers.reduced.taylor`, with y = u + b, v = y' and

    y'' = 1 + g E - (1 + 2 mu) N - 2 zeta w b' - w^2 b,    b'' = -2 mu N - 2 zeta w b' - w^2 b.

The deviations of the motion (`deviations`) are carried along, so the Jacobian of the flow is as
accurate as the flow. At a contact event the vector field changes at a time that depends on the
state, so the deviations jump (`saltation`). C(t) and gamma(t) jump at fixed times, so the
deviations stay continuous there.
"""

import numpy as np

from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes.operations import (
    WIDEST,
    any_lane,
    fma,
    lane_numbers,
    least_lane,
    magnitude,
    select,
    spread,
    zeros8,
)
from gearmesh.solvers.lanes.rows import load, pointer_to, store, unowned
from gearmesh.solvers.reduced.derivatives.deviations import (
    BEND,
    DEVIATIONS,
    N_ROWS,
    ORDER,
    PLACE_A,
    PLACE_V,
    PLACE_Y,
    PLACES,
    RATE,
    SIZE,
    SQUARE,
    STEP,
    B,
    V,
    Y,
    advance,
    evaluate_places,
    expand,
    longest_step,
    room_of,
)
from gearmesh.solvers.reduced.derivatives.polynomials import (
    first_root,
    root_between,
    value_and_slope,
)

TURN, CROSSING, SWITCH = range(3)
"""Kinds of events: an extremum of y, a change of regime, a jump of C(t) or gamma(t)."""

TIME, KIND, HEIGHT, VELOCITY, BEFORE, AFTER, REGIME, SEGMENT, EVENT_SIZE = range(9)
"""Columns of a recorded event: its time, its kind, y, v, y'' before and after it, the regime
and the segment of the mesh period after it."""

COMPLETE, TOO_MANY_STEPS, TOO_MANY_EVENTS, DIVERGED = range(4)
"""Outcomes of `propagate`."""

_REST = 1e-14  # velocities and accelerations below this are rounding errors of a body at rest
_SAMPLE_EDGE = 1e-9  # share of the sampling interval
_MOST_STEPS_PER_SEGMENT = 1000
_FARTHEST = 1e9


@inner
def saltation(before, after, gradient):
    """Return the saltation matrix of an event on a fixed surface in state space.

    Parameters
    ----------
    before, after : ndarray, shape (n,)
        Vector field before and after the event.
    gradient : ndarray, shape (n,)
        Gradient of the event function, whose rate along `before` is not 0.
    """
    rate, n = 0.0, len(gradient)
    for i in range(n):
        rate += gradient[i] * before[i]
    matrix = np.eye(n)
    for i in range(n):
        for j in range(n):
            matrix[i, j] += (after[i] - before[i]) * gradient[j] / rate
    return matrix


@inner
def vector_field(state, direction, c, offset, g, law, bearings):
    """Return the rates of (y, v, b, b') for the given branches of the laws.

    Parameters
    ----------
    state : ndarray, shape (4,)
    direction : float
        Sign of v.
    c, offset, g : float
        Stiffness (0 in contact loss), level y_0, friction's share of the elastic force.
    law : ndarray, shape (3,)
        k_1, k_2, k_3.
    bearings : ndarray, shape (3,)
        2 mu, w^2, 2 zeta w.
    """
    v = state[1]
    elastic = c * (state[0] - offset)
    normal = elastic + (law[0] + (law[1] * direction + law[2] * v) * v) * v
    bearing = -bearings[1] * state[2] - bearings[2] * state[3]
    acceleration = 1.0 + g * elastic - (1.0 + bearings[0]) * normal + bearing
    return v, acceleration, state[3], bearing - bearings[0] * normal


@inner
def _touching(regime, backlash, c):
    """Return the stiffness that acts in a regime, and the level where its flanks touch."""
    if regime == CONTACT_LOSS:
        return 0.0, 0.0
    return c, -backlash if regime == INVERSE_MESH else 0.0


@inner
def _direction(state, rates):
    """Return the sign of v, or that of v' if v is 0."""
    leading = state[1] if state[1] != 0.0 else rates[1]
    return -1.0 if leading < 0.0 else 1.0


@inner
def _level_ahead(regime, direction, backlash):
    """Return the level at which motion in this direction leaves the regime."""
    if regime == NORMAL_MESH:
        return 0.0 if direction < 0.0 else np.inf
    if regime == CONTACT_LOSS:
        return -backlash if direction < 0.0 else 0.0
    return -backlash if direction > 0.0 else -np.inf


@inner
def _turns_nowhere(like, work, step):
    """Return whether the bound of v'' proves that v has no root in the step.

    The proof covers the neighbourhood of each of the evenly spaced places.
    """
    v, a, bend = load(like, work, PLACE_V), load(like, work, PLACE_A), load(like, work, BEND)
    half = 0.5 * step / (WIDEST - 1)
    return not any_lane(magnitude(v) <= (magnitude(a) + 0.5 * half * bend) * half)


@inner
def _least_force(like, work, c, law, regime):
    """Return the least force at the places of a step between flanks that touch."""
    y, v = load(like, work, PLACE_Y), load(like, work, PLACE_V)
    speed = magnitude(v)
    slope = fma(speed, spread(like, law[2]), spread(like, law[1]))
    damper = v * fma(slope, speed, spread(like, law[0]))
    return least_lane(regime * fma(spread(like, c), y, damper))


@inner
def propagate(
    segments,
    laws,
    backlash,
    bearings,
    visits,
    longest,
    tolerance,
    state,
    jacobian,
    events,
    samples,
    per_period,
    workspace,
):
    """Move `state` and its `jacobian` over the segments of the mesh period, in place.

    Parameters
    ----------
    segments : ndarray, shape (m, 3)
        Length in tau_s, C/C_s and g of each segment of the mesh period.
    laws : ndarray, shape (2, 3)
        k_1, k_2, k_3 in contact loss and where flanks touch.
    backlash : float
    bearings : ndarray, shape (3,)
        2 mu, w^2, 2 zeta w.
    visits : int
        Number of segments to pass; the first segment of the period follows the last one.
    longest, tolerance : float
        Bounds of a step and of its relative error.
    state : ndarray, shape (4,)
        y, v, b, b'.
    jacobian : ndarray, shape (4, DEVIATIONS)
    events : ndarray, shape (room, EVENT_SIZE)
    samples : ndarray, shape (n, 4)
        Filled with y, v, y'' and the regime at `per_period` times in a mesh period.
    workspace : ndarray, shape (WORKSPACE,)

    Returns
    -------
    outcome, n_events : int
    damping : float
        Integral of D over the time.
    least_force : float
        Least force between flanks that touch; infinity if none do.
    """
    segments, laws, events = unowned(segments), unowned(laws), unowned(events)
    bearings, samples = unowned(bearings), unowned(samples)
    first = -workspace.ctypes.data % (8 * WIDEST) // 8  # no row straddles two cache lines
    series = unowned(workspace[first : first + N_ROWS * WIDEST].reshape((N_ROWS, WIDEST)))
    like, work, room = zeros8(), pointer_to(series), room_of(tolerance)
    height, velocity = series[Y : Y + ORDER + 1, 0], series[V : V + ORDER + 1, 0]
    square, now = series[SQUARE : SQUARE + ORDER, 0], series[: RATE + 1 : ORDER + 1]
    place = now[:, 0]
    for row in range(SIZE):
        place[row] = state[row]
        for lane in range(1, WIDEST):
            now[row, lane] = jacobian[row, lane - 1] if lane <= DEVIATIONS else 0.0
    store(work, PLACES, lane_numbers(like) * (1.0 / (WIDEST - 1)))
    deviates = lane_numbers(like) > spread(like, 0.0)
    front = np.zeros(SIZE)
    front[0] = 1.0
    regime = CONTACT_LOSS
    if state[0] > 0.0 or (state[0] == 0.0 and state[1] >= 0.0):
        regime = NORMAL_MESH
    elif state[0] < -backlash or (state[0] == -backlash and state[1] <= 0.0):
        regime = INVERSE_MESH
    n_events, n_samples, steps = 0, 0, 0
    damping, least_force, begun = 0.0, np.inf, 0.0
    spacing = np.inf
    if per_period > 0:
        spacing = np.sum(segments[:, 0]) / per_period
    for visit in range(visits):
        number = visit % len(segments)
        length, g = segments[number, 0], segments[number, 2]
        c, offset = _touching(regime, backlash, segments[number, 1])
        law = unowned(laws[abs(regime)])
        previous = segments[(number - 1) % len(segments)]
        if previous[1] != segments[number, 1] or previous[2] != g:
            if n_events == len(events):
                return TOO_MANY_EVENTS, n_events, damping, least_force
            old, _ = _touching(regime, backlash, previous[1])
            sign = np.sign(velocity[0])
            before = vector_field(place, sign, old, offset, previous[2], law, bearings)
            after = vector_field(place, sign, c, offset, g, law, bearings)
            event = events[n_events]
            event[TIME], event[KIND], event[HEIGHT] = begun, SWITCH, height[0]
            event[VELOCITY], event[BEFORE], event[AFTER] = velocity[0], before[1], after[1]
            event[REGIME], event[SEGMENT] = regime, number
            n_events += 1
        since = 0.0
        while since < length:
            steps += 1
            if steps > visits * _MOST_STEPS_PER_SEGMENT:
                return TOO_MANY_STEPS, n_events, damping, least_force
            if not abs(height[0]) + abs(series[B, 0]) < _FARTHEST:
                return DIVERGED, n_events, damping, least_force
            rates = vector_field(place, np.sign(velocity[0]), c, offset, g, law, bearings)
            direction = _direction(place, rates)
            at_rest = abs(velocity[0]) <= _REST and abs(rates[1]) <= _REST
            begin = height[0]
            height[0] -= offset
            expand(like, work, direction, c, g, law, bearings)
            step = longest_step(like, work, room, min(longest, length - since))
            store(work, STEP, spread(like, step))
            evaluate_places(like, work)
            kind = -1
            # Up to the first extremum y is monotone, so its value there shows whether it has
            # passed the level ahead.
            if not at_rest and not _turns_nowhere(like, work, step):
                turn = first_root(velocity, step)
                if turn < step:
                    step, kind = turn, TURN
            away = _level_ahead(regime, direction, backlash) - offset
            y = load(like, work, PLACE_Y)
            if kind == TURN:
                y = spread(like, value_and_slope(height, step)[0])
            beyond = (y - spread(like, away)) * direction > spread(like, 0.0)
            if not at_rest and any_lane(beyond):
                height[0] -= away
                step, kind = root_between(height, 0.0, step), CROSSING
                height[0] += away
            while n_samples < len(samples):
                s = n_samples * spacing - begun - since
                if s >= step - _SAMPLE_EDGE * spacing:
                    break
                s = max(s, 0.0)
                samples[n_samples, 0] = value_and_slope(height, s)[0] + offset
                samples[n_samples, 1], samples[n_samples, 2] = value_and_slope(velocity, s)
                samples[n_samples, 3] = regime
                n_samples += 1
            if kind != -1:
                store(work, STEP, spread(like, step))
            if regime != CONTACT_LOSS:
                if kind != -1:
                    evaluate_places(like, work)
                least_force = min(least_force, _least_force(like, work, c, law, regime))
            if law[2] != 0.0:
                total = 0.0
                for k in range(ORDER - 1, -1, -1):
                    total = total * step + square[k] / (k + 1.0)
                damping += 3.0 * law[2] * total * step
            advance(like, work)
            height[0] += offset
            since = length if kind == -1 and step == length - since else since + step
            if kind == TURN:
                velocity[0] = 0.0
            elif kind == CROSSING:
                height[0] = away + offset
            damping += law[0] * step + 2.0 * law[1] * abs(height[0] - begin)
            if kind == -1:
                continue
            if n_events == len(events):
                return TOO_MANY_EVENTS, n_events, damping, least_force
            before = vector_field(place, direction, c, offset, g, law, bearings)
            if kind == CROSSING:
                regime += 1 if direction > 0.0 else -1
                c, offset = _touching(regime, backlash, segments[number, 1])
                law = unowned(laws[abs(regime)])
            after = vector_field(place, direction, c, offset, g, law, bearings)
            if kind == CROSSING and velocity[0] != 0.0:
                jump = saltation(before, after, front)
                apart = select(deviates, load(like, work, Y), spread(like, 0.0))
                store(work, V, fma(apart, spread(like, jump[1, 0]), load(like, work, V)))
                store(work, RATE, fma(apart, spread(like, jump[3, 0]), load(like, work, RATE)))
            event = events[n_events]
            event[TIME], event[KIND], event[HEIGHT] = begun + since, kind, height[0]
            event[VELOCITY], event[BEFORE], event[AFTER] = velocity[0], before[1], after[1]
            event[REGIME], event[SEGMENT] = regime, number
            n_events += 1
        begun += length
        rates = vector_field(place, np.sign(velocity[0]), c, offset, g, law, bearings)
        for row in range(SIZE):
            now[row, DEVIATIONS] += length * rates[row]
    for row in range(SIZE):
        state[row] = place[row]
        for lane in range(1, DEVIATIONS + 1):
            jacobian[row, lane - 1] = now[row, lane]
    return COMPLETE, n_events, damping, least_force
