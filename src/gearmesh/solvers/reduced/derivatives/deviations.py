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

import math

from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes.operations import (
    COARSENESS,
    WIDEST,
    coarse_exp2,
    coarse_log2,
    lane_numbers,
    least_lane,
    magnitude,
    select,
    spread,
)
from gearmesh.solvers.lanes.rows import load, store
from gearmesh.solvers.lanes.unrolling import unrolled

ORDER = 22
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
    LINEAR,  # (-1 - 2 mu) k_1
    QUADRATIC,  # (-1 - 2 mu) k_2 sign(v), twice for a deviation
    CUBIC,  # (-1 - 2 mu) k_3, three times for a deviation
    RECOIL_LINEAR,  # -2 mu k_1, and so on
    RECOIL_QUADRATIC,
    RECOIL_CUBIC,
    LOAD,  # 1 for the motion
    STEP,  # the step
    PLACES,  # shares of the step, evenly from 0 to 1
    PLACE_Y,  # y, v and y'' of the motion there
    PLACE_V,
    PLACE_A,
    BEND,  # bound of |v''| in the step
) = range(5 * (ORDER + 1), 5 * (ORDER + 1) + 17)

N_ROWS = BEND + 1
"""Rows of a workspace."""

WORKSPACE = (N_ROWS + 1) * WIDEST
"""Numbers that hold a workspace wherever its first row begins at a cache line."""


def _product(rows, left, right, newest_left, newest_right, k):
    """Return the k-th coefficient of a product of series; the newest coefficients come last.

    The left factor, from row `left` on, is that of the motion.
    """
    total = None
    for i in sorted(range(1, k), key=lambda i: abs(2 * i - k)):
        a, b = rows.first(left + i), rows[right + k - i]
        total = a * b if total is None else a.times_plus(b, total)
    if k == 0:
        return newest_left * newest_right
    first = rows.first(left)
    outer = first * newest_right if total is None else first.times_plus(newest_right, total)
    return newest_left.times_plus(rows[right], outer)


def _expand(rows, powers):
    """Write the series from their coefficients of degree 0, with damping of the given powers.

    Each coefficient of v waits for the one before, so what depends on it is added last.
    """
    y, v, b, rate = rows[Y], rows[V], rows[B], rows[RATE]
    for k in range(ORDER):
        part = 1.0 / (k + 1.0)
        bearing = rate.times_plus(rows[DAMPED], rows[SUPPORT] * b)
        changes = []
        for stiffness, linear in ((STIFFNESS, LINEAR), (RECOIL_STIFFNESS, RECOIL_LINEAR)):
            known = y.times_plus(rows[stiffness], bearing)
            if k == 0 and stiffness == STIFFNESS:
                known = known + rows[LOAD]
            changes.append(v.times_plus(rows[linear] * part, known * part))
        dampers = []
        if powers > 1:
            square = _product(rows, V, V, v.first(), v, k)
            dampers.append((square, QUADRATIC, RECOIL_QUADRATIC))
        if powers > 2:
            cube = _product(rows, SQUARE, V, square.first(), v, k)
            dampers.append((cube, CUBIC, RECOIL_CUBIC))
            rows[SQUARE + k] = square
        for power, own, recoil in dampers:
            changes = [
                power.times_plus(rows[factor] * part, change)
                for factor, change in zip((own, recoil), changes, strict=True)
            ]
        y, b = v * part, rate * part
        v, rate = changes
        rows[Y + k + 1], rows[V + k + 1], rows[B + k + 1], rows[RATE + k + 1] = y, v, b, rate
        rows.settle()


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
    store(work, LINEAR, spread(like, share * law[0]))
    store(work, RECOIL_LINEAR, spread(like, recoil * law[0]))
    quadratic = select(is_motion, one, 2.0 * one) * (law[1] * direction)
    store(work, QUADRATIC, quadratic * share)
    store(work, RECOIL_QUADRATIC, quadratic * recoil)
    cubic = select(is_motion, one, 3.0 * one) * law[2]
    store(work, CUBIC, cubic * share)
    store(work, RECOIL_CUBIC, cubic * recoil)
    store(work, LOAD, select(is_motion, one, spread(like, 0.0)))
    if law[2] != 0.0:
        _expand_cubic(like, work)
    elif law[1] != 0.0:
        _expand_quadratic(like, work)
    else:
        _expand_linear(like, work)


@inner
def room_of(tolerance):
    """Return log2 of the share of the radius of convergence that a step may take."""
    return math.log2(tolerance) / (ORDER + 1.0) - COARSENESS


@inner
def longest_step(like, work, room, longest):
    """Return the step, at most `longest`, at which the first terms left out reach the tolerance.

    The last terms that are kept give the radius of convergence of each series (Jorba and Zou).
    """
    size, step = spread(like, 1.0), spread(like, longest)
    for row in (Y, V, B, RATE):
        size = _greater(size, magnitude(load(like, work, row)))
    log_size = coarse_log2(size) - COARSENESS
    for k in range(ORDER - 2, ORDER + 1):
        last = spread(like, 1e-290)
        for row in (Y, V, B, RATE):
            last = _greater(last, magnitude(load(like, work, row + k)))
        bound = coarse_exp2((log_size - coarse_log2(last)) * (1.0 / k) + room)
        step = select(bound < step, bound, step)
    return least_lane(step)


@inner
def _greater(a, b):
    return select(a > b, a, b)


def _advance(rows):
    """Replace the coefficients of degree 0 by the values at the end of the step."""
    values, step = [rows[row + ORDER] for row in (Y, V, B, RATE)], rows[STEP]
    for k in range(ORDER - 1, -1, -1):
        values = [
            value.times_plus(step, rows[row + k])
            for row, value in zip((Y, V, B, RATE), values, strict=True)
        ]
    for row, value in zip((Y, V, B, RATE), values, strict=True):
        rows[row] = value


def _evaluate_places(rows):
    """Write the motion at the places of the step, and the bound of |v''|."""
    step = rows[STEP]
    places = rows[PLACES] * step
    y, v, a, bend = rows.first(Y + ORDER), rows.first(V + ORDER), None, None
    for k in range(ORDER - 1, -1, -1):
        a = v if a is None else a.times_plus(places, v)
        if k > 0:
            bent = rows.first(V + k + 1).magnitude() * (k * (k + 1.0))
            bend = bent if bend is None else bend.times_plus(step, bent)
        y = y.times_plus(places, rows.first(Y + k))
        v = v.times_plus(places, rows.first(V + k))
    rows[PLACE_Y], rows[PLACE_V], rows[PLACE_A], rows[BEND] = y, v, a, bend


advance = unrolled(_advance)
evaluate_places = unrolled(_evaluate_places)
