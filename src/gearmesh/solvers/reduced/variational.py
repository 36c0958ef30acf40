"""Integration of the reduced equations of motion and their variational equations, event by event.

The equations are those of `gearmesh.solvers.reduced.taylor`, with y = u + b, v = y' and

    y'' = 1 + g E - (1 + 2 mu) N - 2 zeta w b' - w^2 b,    b'' = -2 mu N - 2 zeta w b' - w^2 b.

The deviations of the motion (`gearmesh.solvers.reduced.deviations`) are carried along, so the
Jacobian of the flow is as accurate as the flow. At a contact event the vector field changes at a
time that depends on the state, so the deviations jump (`saltation`). C(t) and gamma(t) jump at
fixed times, so the deviations stay continuous there.
"""

import numpy as np

from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.reduced.deviations import (
    DEVIATIONS,
    FORCE_PLACES,
    ORDER,
    SIZE,
    expand,
    least_force_in,
    longest_step,
    write_deviations,
)

TURN, CROSSING, SWITCH = range(3)
"""Kinds of events: an extremum of y, a change of regime, a jump of C(t) or gamma(t)."""

TIME, KIND, HEIGHT, VELOCITY, BEFORE, AFTER, REGIME, SEGMENT, EVENT_SIZE = range(9)
"""Columns of a recorded event: its time, its kind, y, v, y'' before and after it, the regime
and the segment of the mesh period after it."""

COMPLETE, TOO_MANY_STEPS, TOO_MANY_EVENTS, DIVERGED = range(4)
"""Outcomes of `propagate`."""

_REST = 1e-14  # velocities and accelerations below this are rounding errors of a body at rest
_NARROWEST = 1e-8  # share of a step; roots closer than this are not separated
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
    rate = np.sum(gradient * before)
    n = before.size
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
    rates = np.empty(SIZE)
    rates[0] = v
    rates[1] = 1.0 + g * elastic - (1.0 + bearings[0]) * normal + bearing
    rates[2] = state[3]
    rates[3] = bearing - bearings[0] * normal
    return rates


@inner
def value_and_slope(polynomial, s):
    """Return a polynomial, lowest coefficient first, and its slope at `s`."""
    value, slope = 0.0, 0.0
    for k in range(polynomial.size - 1, -1, -1):
        slope = slope * s + value
        value = value * s + polynomial[k]
    return value, slope


@inner
def root_between(polynomial, low, high):
    """Return the root of a polynomial that is monotone between `low` and `high`."""
    falling = value_and_slope(polynomial, low)[0] > value_and_slope(polynomial, high)[0]
    s = 0.5 * (low + high)
    for _ in range(80):
        value, slope = value_and_slope(polynomial, s)
        if value == 0.0:
            break
        if (value > 0.0) == falling:
            low = s
        else:
            high = s
        following = s - value / slope if slope != 0.0 else low
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - s) <= 1e-16 * high:
            s = following
            break
        s = following
    return s


@inner
def first_root(polynomial, end):
    """Return the first change of sign of a polynomial in (0; end), or infinity.

    A bound of the second derivative proves that a piece of the interval holds no root, or at most
    one. Other pieces are halved. A root at 0 itself does not count.
    """
    first = 0
    while first < polynomial.size - 1 and polynomial[first] == 0.0:
        first += 1
    f = polynomial[first:]
    bend = 0.0
    for k in range(f.size - 1, 1, -1):
        bend = bend * end + k * (k - 1.0) * abs(f[k])
    low, width = 0.0, end
    while low < end:
        width = min(width, end - low)
        half = 0.5 * width
        value, slope = value_and_slope(f, low + half)
        curved = bend * half
        if abs(value) <= (abs(slope) + 0.5 * curved) * half:
            if abs(slope) > curved:
                before, after = value_and_slope(f, low)[0], value_and_slope(f, low + width)[0]
                if (before > 0.0) != (after > 0.0):
                    return root_between(f, low, low + width)
            elif width > _NARROWEST * end:
                width = half
                continue
        low += width
        width *= 2.0
    return np.inf


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

    Returns
    -------
    outcome, n_events : int
    damping : float
        Integral of D over the time.
    least_force : float
        Least force between flanks that touch; infinity if none do.
    """
    motion = np.empty((SIZE, ORDER + 1))
    deviations = np.empty((ORDER + 1, SIZE * DEVIATIONS))
    slope, square, push = np.zeros(ORDER + 1), np.zeros(ORDER + 1), np.zeros(DEVIATIONS)
    heights, speeds = np.empty(FORCE_PLACES), np.empty(FORCE_PLACES)
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
        law = laws[abs(regime)]
        previous = segments[(number - 1) % len(segments)]
        if previous[1] != segments[number, 1] or previous[2] != g:
            if n_events == len(events):
                return TOO_MANY_EVENTS, n_events, damping, least_force
            old, _ = _touching(regime, backlash, previous[1])
            sign = np.sign(state[1])
            before = vector_field(state, sign, old, offset, previous[2], law, bearings)
            after = vector_field(state, sign, c, offset, g, law, bearings)
            event = events[n_events]
            event[TIME], event[KIND], event[HEIGHT] = begun, SWITCH, state[0]
            event[VELOCITY], event[BEFORE], event[AFTER] = state[1], before[1], after[1]
            event[REGIME], event[SEGMENT] = regime, number
            n_events += 1
        since = 0.0
        while since < length:
            steps += 1
            if steps > visits * _MOST_STEPS_PER_SEGMENT:
                return TOO_MANY_STEPS, n_events, damping, least_force
            if not abs(state[0]) + abs(state[2]) < _FARTHEST:
                return DIVERGED, n_events, damping, least_force
            rates = vector_field(state, np.sign(state[1]), c, offset, g, law, bearings)
            direction = _direction(state, rates)
            at_rest = abs(state[1]) <= _REST and abs(rates[1]) <= _REST
            motion[:, 0] = state
            deviations[0] = jacobian.reshape(SIZE * DEVIATIONS)
            expand(motion, deviations, slope, square, push, direction, c, offset, g, law, bearings)
            step = min(longest_step(motion, deviations, tolerance, longest), length - since)
            kind = -1
            # Up to the first extremum y is monotone, so its value there shows whether it has
            # passed the level ahead.
            turn = np.inf if at_rest else first_root(motion[1], step)
            if turn < step:
                step, kind = turn, TURN
            level = _level_ahead(regime, direction, backlash)
            if not at_rest and direction * (value_and_slope(motion[0], step)[0] - level) > 0.0:
                motion[0, 0] -= level
                step, kind = root_between(motion[0], 0.0, step), CROSSING
                motion[0, 0] += level
            while n_samples < len(samples):
                s = n_samples * spacing - begun - since
                if s >= step - _SAMPLE_EDGE * spacing:
                    break
                s = max(s, 0.0)
                samples[n_samples, 0] = value_and_slope(motion[0], s)[0]
                velocity, acceleration = value_and_slope(motion[1], s)
                samples[n_samples, 1], samples[n_samples, 2] = velocity, acceleration
                samples[n_samples, 3] = regime
                n_samples += 1
            if regime != CONTACT_LOSS:
                least = least_force_in(
                    motion, step, direction, c, offset, law, regime, heights, speeds
                )
                least_force = min(least_force, least)
            total = 0.0
            for k in range(ORDER, -1, -1):
                total = total * step + slope[k] / (k + 1.0)
            damping += total * step
            for row in range(SIZE):
                state[row] = value_and_slope(motion[row], step)[0]
            write_deviations(deviations, step, jacobian)
            since = length if kind == -1 and step == length - since else since + step
            if kind == -1:
                continue
            if n_events == len(events):
                return TOO_MANY_EVENTS, n_events, damping, least_force
            if kind == TURN:
                state[1] = 0.0
            else:
                state[0] = level
            before = vector_field(state, direction, c, offset, g, law, bearings)
            if kind == CROSSING:
                regime += 1 if direction > 0.0 else -1
                c, offset = _touching(regime, backlash, segments[number, 1])
                law = laws[abs(regime)]
            after = vector_field(state, direction, c, offset, g, law, bearings)
            if kind == CROSSING and state[1] != 0.0:
                jacobian[:, :] = saltation(before, after, front) @ jacobian
            event = events[n_events]
            event[TIME], event[KIND], event[HEIGHT] = begun + since, kind, state[0]
            event[VELOCITY], event[BEFORE], event[AFTER] = state[1], before[1], after[1]
            event[REGIME], event[SEGMENT] = regime, number
            n_events += 1
        begun += length
        rates = vector_field(state, np.sign(state[1]), c, offset, g, law, bearings)
        jacobian[:, SIZE] += length * rates
    return COMPLETE, n_events, damping, least_force
