"""Taylor series of the reduced equations of motion, eight runs at a time.

Without run-out, and with equal wheels and bearings, the relative motion y = u + b obeys a smaller
system than the six coordinates: u = R_b (phi_3 + phi_2) and b = y_3 - y_2,

    u'' = 1 - N + g E,        b'' = -2 mu N - 2 zeta w b' - w^2 b,
    E = c (y - y_0),          N = E + k_1 v + k_2 |v| v + k_3 v^3,    v = y',

where y_0 is 0 in normal mesh and -s in inverse mesh, c is 0 in contact loss, g = f_T tan(alpha)
gamma is the friction's share of the elastic force (`gearmesh.friction`), mu = m_red/m,
w^2 = mu c_b/C_s. Between two events c, y_0, the k_i and the sign of v are constants, so the
solution is analytic and its Taylor coefficients follow from a recurrence with at most two Cauchy
products (Jorba and Zou, Experimental Mathematics 14, 2005).

The workspace is one flat float64 array of rows, one element of a row for each lane; the names
below are row numbers.
"""

from numba import njit

from gearmesh.solver.lanes import (
    coarse_exp2,
    coarse_log2,
    fma,
    load,
    magnitude,
    select,
    spread,
    store,
    unrolled,
)

ORDER = 16
"""Degree of the Taylor polynomials."""

_SPAN = ORDER + 1
U, B, Y, V, WATCHED = (_SPAN * i for i in range(5))
"""First rows of the series of u, b, y, v and of what is watched for events; the state is U, U + 1,
B, B + 1."""

_FIRST = 5 * _SPAN
(
    ELASTIC,  # c, 0 in contact loss
    OFFSET,  # y_0
    LINEAR,  # k_1
    QUADRATIC,  # k_2
    CUBIC,  # k_3
    FRICTION,  # g
    LOAD,  # 1; 0 in an idle lane
    TWO_MU,  # 2 m_red/m
    BEARING_STIFFNESS,  # w^2
    BEARING_DAMPING,  # 2 zeta w
    LEVEL_ABOVE,  # level that a rising y crosses into the next regime
    LEVEL_BELOW,  # level that a falling y crosses
    GUARD,  # 1 or -1: watch y, which must stay above or below GUARDED; 0: watch v
    GUARDED,  # level that ends the contact
    REMAINING,  # time to the next switch, pitch point or boundary
    LONGEST,  # bound of a step
    LOG_TOLERANCE,  # log2 of the local error tolerance
    SIGN,  # direction of motion, sign of v
    STEP,  # length of the expansion
    TAKEN,  # what is taken of it, up to the first event
    EVENT,  # what ends the step, see `gearmesh.integrator`
    SINCE_STOP,  # time since the stretch of constant stiffness began
    LENGTH,  # of that stretch
    SINCE_BOUNDARY,  # time since the mesh period began
    KEPT,  # 1 in the kept revolutions, else 0
    LOST,  # 1 in contact loss, else 0
    SQUARE_INTEGRAL,  # of y^2 over the kept time
    LOSS_TIME,  # kept time in contact loss
    INVERSE,  # 1 in inverse mesh, else 0
    INVERSE_TIME,  # kept time in inverse mesh
    STEPS,  # steps taken
    MOST_STEPS,  # steps after which the run is given up
    SCRATCH,  # three rows
) = range(_FIRST, _FIRST + 33)
N_ROWS = SCRATCH + 3

REST = 1e-14
"""Velocities and accelerations below this are rounding errors of a body at rest."""

LONGEST_ANGLE = 2.0
"""Bound of a step times the highest natural frequency.

It keeps the sampling of a step for events fine, and the series of a mode that is hardly excited
within its convergence: such a mode would grow from rounding errors unseen by the tolerance.
"""


@njit(inline="never")
def direction(like, work):
    """Return the sign of v, where v rests that of the acceleration, where both rest the last."""
    y = load(like, work, U) + load(like, work, B)
    v = load(like, work, U + 1) + load(like, work, B + 1)
    elastic = load(like, work, ELASTIC) * (y - load(like, work, OFFSET))
    push = load(like, work, LOAD) - elastic + load(like, work, FRICTION) * elastic
    bearing = load(like, work, TWO_MU) * elastic
    bearing = fma(load(like, work, BEARING_STIFFNESS), load(like, work, B), bearing)
    bearing = fma(load(like, work, BEARING_DAMPING), load(like, work, B + 1), bearing)
    acceleration = push - bearing
    zero = spread(like, 0.0)
    rest = spread(like, REST)
    leading = select(magnitude(v) <= rest, acceleration, v)
    one = spread(like, 1.0)
    before = load(like, work, SIGN)
    before = select(before == zero, one, before)
    now = select(leading < zero, -one, one)
    return select(magnitude(leading) <= rest, before, now)


def _product(left, right, k):
    """Return the k-th coefficient of a product of series, the newest coefficients last."""
    total = None
    for i in range(k // 2, -1, -1):
        for a, b in {(i, k - i), (k - i, i)}:
            total = left[a] * right[b] if total is None else left[a].times_plus(right[b], total)
    return total


def _square(series, k):
    """Return the k-th coefficient of the square of a series, the newest coefficients last."""
    total = None
    for i in range((k - 1) // 2, -1, -1):
        term = series[i], series[k - i]
        total = term[0] * term[1] if total is None else term[0].times_plus(term[1], total)
    if k % 2 == 1:
        return total * 2.0
    middle = series[k // 2] * series[k // 2]
    return middle if total is None else total.times_plus(2.0, middle)


def _expand(rows, powers):
    """Write the series from the state, with damping of the given powers."""
    y, v, square = [rows[U] + rows[B]], [rows[U + 1] + rows[B + 1]], []
    b = [rows[B], rows[B + 1]]
    y.append(v[0])
    rate = {1: rows[LINEAR], 2: rows[QUADRATIC] * rows[SIGN], 3: rows[CUBIC]}
    # y'' = u'' + b'' in one line of sums keeps the chain from v_k to v_k+1 short.
    share = -(rows[TWO_MU] + 1.0)
    elastic_share = rows[FRICTION] + share
    for k in range(ORDER - 1):
        elastic = rows[ELASTIC] * (y[0] - rows[OFFSET] if k == 0 else y[k])
        bearing = rows[BEARING_STIFFNESS] * b[k]
        bearing = (rows[BEARING_DAMPING] * (k + 1.0)).times_plus(b[k + 1], bearing)
        known = elastic.times_plus(elastic_share, -bearing)
        if k == 0:
            known = known + rows[LOAD]
        damping = rate[1] * v[k]
        if powers > 1:
            square.append(_square(v, k))
            damping = rate[2].times_plus(square[k], damping)
        if powers > 2:
            damping = rate[3].times_plus(_product(square, v, k), damping)
        acceleration = share.times_plus(damping, known)
        v.append(acceleration * (1.0 / (k + 1.0)))
        y.append(acceleration * (1.0 / ((k + 1.0) * (k + 2.0))))
        recoil = rows[TWO_MU].times_plus(elastic + damping, bearing)
        b.append(recoil * (-1.0 / ((k + 1.0) * (k + 2.0))))
    for k in range(ORDER + 1):
        rows[Y + k] = y[k]
        rows[B + k] = b[k]
        rows[U + k] = y[k] - b[k]
    for k in range(ORDER + 1):
        height = y[k] - rows[GUARDED] if k == 0 else y[k]
        rows[WATCHED + k] = rows[GUARD].choose(height, v[k] if k < ORDER else 0.0)


_expand_linear = unrolled(lambda rows: _expand(rows, 1))
_expand_quadratic = unrolled(lambda rows: _expand(rows, 2))
_expand_cubic = unrolled(lambda rows: _expand(rows, 3))


@njit(inline="never")
def expand(like, work, powers):
    """Fill the series from the state; `powers` of v that act in some lane."""
    if powers == 1:
        _expand_linear(like, work)
    elif powers == 2:
        _expand_quadratic(like, work)
    else:
        _expand_cubic(like, work)


@njit(inline="never")
def choose_step(like, work):
    """Write the step for which the last terms stay below the tolerance, to the next stop."""
    log_tolerance = load(like, work, LOG_TOLERANCE)
    tiny = spread(like, 1e-290)
    longest = load(like, work, LONGEST)
    step = load(like, work, REMAINING)
    step = select(longest < step, longest, step)
    # Three terms: from a turning point on, cubic damping leaves every third one only.
    for back in range(3):
        degree = ORDER - back
        size = magnitude(load(like, work, Y + degree)) + magnitude(load(like, work, U + degree))
        room = (log_tolerance - coarse_log2(size + tiny)) * (1.0 / degree)
        bound = coarse_exp2(room)
        step = select(bound < step, bound, step)
    store(work, STEP, step)


@njit(inline="always")
def evaluate(like, work, series, n, s):
    """Return the polynomial with `n` coefficients from row `series` at `s`."""
    value = load(like, work, series + n - 1)
    for k in range(n - 2, -1, -1):
        value = fma(value, s, load(like, work, series + k))
    return value


@njit(inline="always")
def evaluate_with_slope(like, work, series, n, s):
    """Return the polynomial with `n` coefficients from row `series`, and its slope, at `s`."""
    value = load(like, work, series + n - 1)
    slope = spread(like, 0.0)
    for k in range(n - 2, -1, -1):
        slope = fma(slope, s, value)
        value = fma(value, s, load(like, work, series + k))
    return value, slope


@njit(inline="always")
def evaluate_with_bend(like, work, series, n, s):
    """Return the polynomial from row `series`, its slope and half its curvature at `s`."""
    value = load(like, work, series + n - 1)
    slope = spread(like, 0.0)
    bend = slope
    for k in range(n - 2, -1, -1):
        bend = fma(bend, s, slope)
        slope = fma(slope, s, value)
        value = fma(value, s, load(like, work, series + k))
    return value, slope, bend
