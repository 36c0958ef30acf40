"""Taylor series of the reduced equations of motion, eight runs at a time.

Without run-out, and with equal wheels and bearings, the relative motion y = u + b obeys a smaller
system than the six coordinates: u = R_b (phi_3 + phi_2) and b = y_3 - y_2,

    u'' = 1 - N + g E,        b'' = -2 mu N - 2 zeta w b' - w^2 b,
    E = c (y - y_0),          N = E + k_1 v + k_2 |v| v + k_3 v^3,    v = y',

where y_0 is 0 in normal mesh and -s in inverse mesh, c is 0 in contact loss, g = f_T tan(alpha)
gamma is the friction's share of the elastic force (`gearmesh.model.friction`), mu = m_red/m,
w^2 = mu c_b/C_s. Between two events c, y_0, the k_i and the sign of v are constants, so the
solution is analytic and its Taylor coefficients follow from a recurrence with at most two Cauchy
products (Jorba and Zou, Experimental Mathematics 14, 2005).
"""

from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes.operations import (
    COARSENESS,
    coarse_exp2,
    coarse_log2,
    fma,
    magnitude,
    select,
    spread,
)
from gearmesh.solvers.lanes.rows import load, store
from gearmesh.solvers.lanes.unrolling import unrolled
from gearmesh.solvers.reduced.workspace import (
    BEARING_DAMPING,
    BEARING_STIFFNESS,
    CUBIC,
    ELASTIC,
    FRICTION,
    LINEAR,
    LOAD,
    LOG_TOLERANCE,
    LONGEST,
    N_PLACES,
    OFFSET,
    ORDER,
    PLACE_HALF_A,
    PLACE_V,
    PLACE_Y,
    QUADRATIC,
    REMAINING,
    SIGN,
    STEP,
    TWO_MU,
    B,
    Y,
)

REST = 1e-14
"""Velocities and accelerations below this are rounding errors of a body at rest."""


@inner(inline="never")
def direction(like, work):
    """Return the sign of v, or of the acceleration if v is 0, or the last sign if both are 0."""
    v = load(like, work, Y + 1)
    elastic = load(like, work, ELASTIC) * (load(like, work, Y) - load(like, work, OFFSET))
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


def _inner_product(left, right, k):
    """Return the k-th coefficient of a product of series less its two outermost terms.

    The newest coefficients are added last, so the sum waits for them only.
    """
    total = None
    for i in sorted(range(1, k), key=lambda i: abs(2 * i - k)):
        a, b = left[i], right[k - i]
        total = a * b if total is None else a.times_plus(b, total)
    return total


def _inner_half_square(series, k):
    """Return half of what `_inner_product` gives for the square of a series."""
    total = series[k // 2] * series[k // 2] * 0.5 if k % 2 == 0 else None
    for i in range((k - 1) // 2, 0, -1):
        a, b = series[i], series[k - i]
        total = a * b if total is None else a.times_plus(b, total)
    return total


class _Damping:
    """The damping force as a series, k_1 v + 2 k_2 h + 2 k_3 h v with h = v^2/2.

    Its coefficient of degree k depends on v_k by `slope`, the slope of the law at the start, and
    otherwise on what is known before v_k: `inner`.
    """

    def __init__(self, rows, powers):
        self.powers = powers
        self.v = [rows[Y + 1]]
        self.half_square = [self.v[0] * self.v[0] * 0.5]
        self.slope = rows[LINEAR]
        if powers > 1:
            self.of_square = rows[QUADRATIC] * rows[SIGN] * 2.0
            self.slope = self.of_square.times_plus(self.v[0], self.slope)
        if powers > 2:
            self.of_cube = rows[CUBIC] * 2.0
            self.slope = self.of_cube.times_plus(self.half_square[0] * 3.0, self.slope)
            self.of_square = self.of_cube.times_plus(self.v[0], self.of_square)

    def inner(self, k):
        """Return the coefficient of degree k of the force less slope v_k; None if that is 0."""
        if self.powers == 1:
            return None
        if k == 0:
            bend = self.of_square
            if self.powers > 2:
                bend = self.of_cube.times_plus(self.v[0], bend)
            return -(bend * self.half_square[0])
        inner = _inner_half_square(self.v, k)
        outer = self.v[0] * self.v[k]
        self.half_square.append(outer if inner is None else outer + inner)
        if inner is None:
            return None
        force = self.of_square * inner
        if self.powers > 2:
            force = self.of_cube.times_plus(_inner_product(self.half_square, self.v, k), force)
        return force


def _expand(rows, powers):
    """Write the series from the state, with damping of the given powers.

    From v_k to v_k+1 takes one multiply-add; the processor does all other work meanwhile.
    """
    damping = _Damping(rows, powers)
    y, v, b, rate = [rows[Y]], damping.v, [rows[B]], [rows[B + 1]]  # rate is b'
    recoil = -rows[TWO_MU]
    share = recoil - 1.0
    stiffness, support = (rows[FRICTION] + share) * rows[ELASTIC], -rows[BEARING_STIFFNESS]
    recoil_stiffness, bearing_damped = recoil * rows[ELASTIC], -rows[BEARING_DAMPING]
    damped, recoil_damped = share * damping.slope, recoil * damping.slope
    for k in range(ORDER):
        part = 1.0 / (k + 1.0)
        y.append(v[k] * part)
        b.append(rate[k] * part)
        if k == ORDER - 1:
            break
        bearing = support * b[k]
        height = y[0] - rows[OFFSET] if k == 0 else y[k]
        v_known = stiffness.times_plus(height, bearing)
        rate_known = recoil_stiffness.times_plus(height, bearing)
        if k == 0:
            v_known = v_known + rows[LOAD]
        inner = damping.inner(k)
        if inner is not None:
            v_known = share.times_plus(inner, v_known)
            rate_known = recoil.times_plus(inner, rate_known)
        v_known = (damped * part).times_plus(v[k], v_known * part)
        rate_known = (recoil_damped * part).times_plus(v[k], rate_known * part)
        v.append((bearing_damped * part).times_plus(rate[k], v_known))
        rate.append((bearing_damped * part).times_plus(rate[k], rate_known))
    for k in range(ORDER + 1):
        rows[Y + k] = y[k]
        rows[B + k] = b[k]


_expand_linear = unrolled(lambda rows: _expand(rows, 1))
_expand_quadratic = unrolled(lambda rows: _expand(rows, 2))
_expand_cubic = unrolled(lambda rows: _expand(rows, 3))


@inner(inline="never")
def expand(like, work, powers):
    """Fill the series from the state; `powers` is the highest power of v in any lane's damping."""
    if powers == 1:
        _expand_linear(like, work)
    elif powers == 2:
        _expand_quadratic(like, work)
    else:
        _expand_cubic(like, work)


@inner(inline="never")
def choose_step(like, work):
    """Write the step at which the first terms left out reach the tolerance, within the segment.

    Each of the last terms of v and b' gives a radius of convergence, for motion of the size of
    y_st (Jorba and Zou). The step makes the term of degree ORDER, the first missing one of v, equal
    to the tolerance.
    """
    room = load(like, work, LOG_TOLERANCE) * (1.0 / ORDER) - COARSENESS
    tiny = spread(like, 1e-290)
    longest = load(like, work, LONGEST)
    step = load(like, work, REMAINING)
    step = select(longest < step, longest, step)
    # Three terms: from a turning point on, cubic damping leaves every third one only.
    for k in range(ORDER - 3, ORDER):
        size = magnitude(load(like, work, Y + k + 1)) + magnitude(load(like, work, B + k + 1))
        radius = coarse_log2(size * (k + 1.0) + tiny) * (-1.0 / k)
        bound = coarse_exp2(room + radius)
        step = select(bound < step, bound, step)
    store(work, STEP, step)


def _evaluate_places(rows):
    """Write y, v and half the acceleration at the places of the step, all in one pass."""
    places = rows[STEP].times_each([(j + 1) / N_PLACES for j in range(N_PLACES)])
    y, v, half_a = rows[Y + ORDER].repeated(N_PLACES), None, None
    for k in range(ORDER - 1, -1, -1):
        half_a = v if half_a is None else half_a.times_plus(places, v)
        v = y if v is None else v.times_plus(places, y)
        y = y.times_plus(places, rows[Y + k].repeated(N_PLACES))
    rows[PLACE_Y] = y
    rows[PLACE_V] = v
    rows[PLACE_HALF_A] = half_a


evaluate_places = unrolled(_evaluate_places)


@inner(inline="always")
def evaluate(like, work, s):
    """Return y at `s`."""
    value = load(like, work, Y + ORDER)
    for k in range(ORDER - 1, -1, -1):
        value = fma(value, s, load(like, work, Y + k))
    return value


@inner(inline="always")
def evaluate_with_slope(like, work, series, s):
    """Return the polynomial from row `series`, and its slope, at `s`."""
    value = load(like, work, series + ORDER)
    slope = spread(like, 0.0)
    for k in range(ORDER - 1, -1, -1):
        slope = fma(slope, s, value)
        value = fma(value, s, load(like, work, series + k))
    return value, slope


@inner(inline="always")
def evaluate_with_twist(like, work, s):
    """Return y and its first three Taylor coefficients at `s`."""
    value = load(like, work, Y + ORDER)
    slope = spread(like, 0.0)
    bend = slope
    twist = slope
    for k in range(ORDER - 1, -1, -1):
        twist = fma(twist, s, bend)
        bend = fma(bend, s, slope)
        slope = fma(slope, s, value)
        value = fma(value, s, load(like, work, Y + k))
    return value, slope, bend, twist
