"""Taylor series of a motion and of its deviations, within one branch of all laws.

The equations are those of `variational`. The motion is in the first lane of a vector, and each of
the next lanes holds a deviation (dy, dv, db, db') of the state. Deviations obey the linearised
equations: c dy stands in place of E, c dy + D dv in place of N, and 0 in place of the constant 1,
where D = k_1 + 2 k_2 |v| + 3 k_3 v^2. In the series of v^2 and v^3 the motion has the factors v v
and v^2 v, a deviation v dv and v^2 dv. Both therefore obey one recurrence, in which the last factor
is that of the lane, and the weights of a deviation are 2 and 3.

Five deviations are carried. Four belong to the coordinates of the state. The fifth is the
derivative with respect to the logarithm of the mesh period, which stretches all segments. Within a
segment the law does not depend on time, so the motion ends ahead by its rate times the change of
the segment's length, and this is carried on like any other deviation.
"""

from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes.operations import (
    WIDEST,
    any_lane,
    fma,
    lane_numbers,
    magnitude,
    select,
    spread,
)
from gearmesh.solvers.lanes.rows import get, load, store
from gearmesh.solvers.lanes.unrolling import unrolled

ORDER = 20
"""Degree of the Taylor polynomials."""

SIZE = 4
"""Size of the state (y, v, b, b')."""

DEVIATIONS = 5
"""Number of deviations, in the lanes after that of the motion."""

Y, V, B, RATE, SQUARE = (i * (ORDER + 1) for i in range(5))
"""First rows of the series of y, v, b, b' and v^2; y is measured from the level y_0."""

(
    STIFFNESS,  # (g - 1 - 2 mu) c
    RECOIL_STIFFNESS,  # -2 mu c
    SUPPORT,  # -w^2
    DAMPED,  # -2 zeta w
    SHARE,  # -1 - 2 mu
    RECOIL,  # -2 mu
    LINEAR,  # k_1
    QUADRATIC,  # k_2 sign(v), twice for a deviation
    CUBIC,  # k_3, three times for a deviation
    LOAD,  # 1 for the motion
) = range(5 * (ORDER + 1), 5 * (ORDER + 1) + 10)

N_ROWS = LOAD + 1
"""Rows of a workspace."""

_SHORTER = 0.875  # of a step whose last terms are too large


def _product(left, right, newest_left, newest_right, k):
    """Return the k-th coefficient of a product of series; the newest coefficients come last."""
    total = None
    for i in sorted(range(1, k), key=lambda i: abs(2 * i - k)):
        total = left[i] * right[k - i] if total is None else left[i].times_plus(right[k - i], total)
    outer = left[0] * newest_right
    outer = outer if total is None else left[0].times_plus(newest_right, total)
    return outer if k == 0 else newest_left.times_plus(right[0], outer)


def _expand(rows, powers):
    """Write the series from their coefficients of degree 0, with damping of the given powers."""
    stiffness, recoil_stiffness = rows[STIFFNESS], rows[RECOIL_STIFFNESS]
    support, damped = rows[SUPPORT], rows[DAMPED]
    share, recoil, linear = rows[SHARE], rows[RECOIL], rows[LINEAR]
    y, b, rate = rows[Y], rows[B], rows[RATE]
    v, motion, square, motion_square = [rows[V]], [], [], []
    for k in range(ORDER):
        part = 1.0 / (k + 1.0)
        bearing = rate.times_plus(damped, support * b)
        v_known = y.times_plus(stiffness, bearing)
        rate_known = y.times_plus(recoil_stiffness, bearing)
        if k == 0:
            v_known = v_known + rows[LOAD]
        damper = v[k] * linear
        if powers > 1:
            motion.append(v[k].first())
            square.append(_product(motion, v, motion[k], v[k], k))
            damper = square[k].times_plus(rows[QUADRATIC], damper)
        if powers > 2:
            motion_square.append(square[k].first())
            cube = _product(motion_square, v, motion_square[k], v[k], k)
            damper = cube.times_plus(rows[CUBIC], damper)
            rows[SQUARE + k] = square[k]
        y, b = v[k] * part, rate * part
        v.append(damper.times_plus(share, v_known) * part)
        rate = damper.times_plus(recoil, rate_known) * part
        rows[Y + k + 1], rows[V + k + 1], rows[B + k + 1], rows[RATE + k + 1] = y, v[-1], b, rate


_expand_linear = unrolled(lambda rows: _expand(rows, 1))
_expand_quadratic = unrolled(lambda rows: _expand(rows, 2))
_expand_cubic = unrolled(lambda rows: _expand(rows, 3))


@inner
def expand(like, work, direction, c, g, law, bearings):
    """Write the series from their coefficients of degree 0.

    Parameters
    ----------
    like : lanes
    work : pointer
        N_ROWS rows.
    direction : float
        Sign of v.
    c, g : float
        Stiffness (0 in contact loss), and friction's share of the elastic force.
    law, bearings : ndarray, shape (3,)
        k_1, k_2, k_3, and 2 mu, w^2, 2 zeta w.
    """
    one = spread(like, 1.0)
    is_motion = lane_numbers(like) == spread(like, 0.0)
    share, recoil = -1.0 - bearings[0], -bearings[0]
    store(work, STIFFNESS, spread(like, (g + share) * c))
    store(work, RECOIL_STIFFNESS, spread(like, recoil * c))
    store(work, SUPPORT, spread(like, -bearings[1]))
    store(work, DAMPED, spread(like, -bearings[2]))
    store(work, SHARE, spread(like, share))
    store(work, RECOIL, spread(like, recoil))
    store(work, LINEAR, spread(like, law[0]))
    store(work, QUADRATIC, select(is_motion, one, 2.0 * one) * (law[1] * direction))
    store(work, CUBIC, select(is_motion, one, 3.0 * one) * law[2])
    store(work, LOAD, select(is_motion, one, spread(like, 0.0)))
    if law[2] != 0.0:
        _expand_cubic(like, work)
    elif law[1] != 0.0:
        _expand_quadratic(like, work)
    else:
        _expand_linear(like, work)


@inner
def longest_step(like, work, tolerance, longest):
    """Return the step, at most `longest`, at which the last terms of all series are small."""
    step = longest
    size = spread(like, 1.0)
    for row in (Y, V, B, RATE):
        size = _greater(size, magnitude(load(like, work, row)))
    bound = tolerance * size
    for k in range(ORDER - 2, ORDER + 1):
        last = spread(like, 0.0)
        for row in (Y, V, B, RATE):
            last = _greater(last, magnitude(load(like, work, row + k)))
        while any_lane(last * step**k > bound):
            step *= _SHORTER
    return step


@inner
def _greater(a, b):
    return select(a > b, a, b)


@inner
def advance(like, work, s):
    """Replace the coefficients of degree 0 by the values at `s`."""
    at = spread(like, s)
    y, v = load(like, work, Y + ORDER), load(like, work, V + ORDER)
    b, rate = load(like, work, B + ORDER), load(like, work, RATE + ORDER)
    for k in range(ORDER - 1, -1, -1):
        y = fma(y, at, load(like, work, Y + k))
        v = fma(v, at, load(like, work, V + k))
        b = fma(b, at, load(like, work, B + k))
        rate = fma(rate, at, load(like, work, RATE + k))
    store(work, Y, y)
    store(work, V, v)
    store(work, B, b)
    store(work, RATE, rate)


@inner
def motion_at(like, work, s):
    """Return y, v and y'' of the motion at times `s`, one in each lane."""
    y = spread(like, get(work, WIDEST, Y + ORDER, 0))
    v = spread(like, get(work, WIDEST, V + ORDER, 0))
    a = spread(like, 0.0)
    for k in range(ORDER - 1, -1, -1):
        a = fma(a, s, v)
        y = fma(y, s, spread(like, get(work, WIDEST, Y + k, 0)))
        v = fma(v, s, spread(like, get(work, WIDEST, V + k, 0)))
    return y, v, a
