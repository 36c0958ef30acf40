"""Where a polynomial first changes its sign in <0; 1>.

The coefficients of a polynomial in the Bernstein basis change sign at least as often as the
polynomial does, so no sign change means no root and one means one root (Descartes' rule; see
Lane and Riesenfeld, BIT 21, 1981). Halving the interval where there are more separates every pair
of roots, however close: nothing hides between sample points.
"""

import math

import numpy as np
from numba import njit

from gearmesh.solvers.lanes.operations import fma

MAX_DEGREE = 28
"""Highest degree of a polynomial."""

NEVER = 2.0
"""What `first_change` returns when the sign does not change in <0; 1>."""

# Number of halvings. Two roots in the same narrowest interval cannot be separated, and count as no
# root.
_DEPTH = 44
_NARROWEST = 0.5**_DEPTH

WIDTH = MAX_DEGREE + 2
"""Length of a row: the coefficients, then the width of their interval in the last place."""

TABLE_ROWS = _DEPTH + 3
"""Rows of the workspace of `first_change`."""

_MOST_ITERATIONS = 100
_UNIT = 0.5 * np.finfo(np.float64).eps


def _bernstein_weights() -> np.ndarray:
    """Return w with w[m, j, i] = binom(j, i) / binom(m, i), shape (m + 1,) * 3 for the largest m.

    The j-th Bernstein coefficient of sum c_i s^i of degree m is sum w[m, j, i] c_i, i <= j.
    """
    size = MAX_DEGREE + 1
    weights = np.zeros((size, size, size))
    for m in range(size):
        for j in range(m + 1):
            for i in range(j + 1):
                weights[m, j, i] = math.comb(j, i) / math.comb(m, i)
    return weights


_WEIGHTS = _bernstein_weights()


@njit
def evaluate(coefficients, degree, s):
    """Return the polynomial at `s`."""
    value = coefficients[degree]
    for k in range(degree - 1, -1, -1):
        value = fma(value, s, coefficients[k])
    return value


@njit
def evaluate_with_slope(coefficients, degree, s):
    """Return the polynomial and its derivative at `s`."""
    value = coefficients[degree]
    slope = 0.0
    for k in range(degree - 1, -1, -1):
        slope = fma(slope, s, value)
        value = fma(value, s, coefficients[k])
    return value, slope


@njit
def refine(coefficients, degree, low, high, sign):
    """Return where the polynomial changes sign between `low`, where it has `sign`, and `high`.

    Newton's method, kept in a bracket that shrinks. It ends where the value is a rounding error:
    there its steps no longer shrink, and the bracket would be halved dozens of times for nothing.
    """
    rounding = 0.0
    for k in range(degree + 1):
        rounding += abs(coefficients[k])
    rounding *= _UNIT
    at = 0.5 * (low + high)
    width = high - low
    for _ in range(_MOST_ITERATIONS):
        value, slope = evaluate_with_slope(coefficients, degree, at)
        if value * sign > 0.0:
            low = at
        else:
            high = at
        following = at - value / slope if slope != 0.0 else low
        if abs(value) <= rounding:
            return following if low < following < high else at
        # Bisect where Newton's method leaves the bracket, or does not shrink it.
        if not low < following < high or abs(following - at) > 0.5 * width:
            following = 0.5 * (low + high)
        width = abs(following - at)
        if following == at or width <= 1e-16 * at:
            return following
        at = following
    return at


@njit
def _variations(row, degree):
    """Return the number of sign changes in a row of coefficients, and its first and last sign."""
    changes = 0
    first = 0.0
    last = 0.0
    for j in range(degree + 1):
        if row[j] != 0.0:
            now = 1.0 if row[j] > 0.0 else -1.0
            if first == 0.0:
                first = now
            elif now != last:
                changes += 1
            last = now
    return changes, first, last


@njit
def _halve(parent, left, right, degree):
    """Split the Bernstein coefficients of an interval into those of its halves (de Casteljau)."""
    for j in range(degree + 1):
        right[j] = parent[j]
    for level in range(degree + 1):
        left[level] = right[0]
        for j in range(degree - level):
            right[j] = 0.5 * (right[j] + right[j + 1])


@njit
def _keeps_sign(coefficients, sign):
    """Return whether a lower bound shows that `sign` times the polynomial is positive in <0; 1>.

    The bound is the least value of the first three terms, minus the sum of the absolute values of
    the other coefficients.
    """
    rest = 0.0
    for k in range(3, coefficients.size):
        rest += abs(coefficients[k])
    a = sign * coefficients[0] - rest
    b = sign * coefficients[1] if coefficients.size > 1 else 0.0
    c = sign * coefficients[2] if coefficients.size > 2 else 0.0
    if a <= 0.0 or a + b + c <= 0.0:
        return False
    # The parabola is positive at 0 and 1. It can be negative only if its vertex lies in between.
    return not (c > 0.0 and -2.0 * c < b < 0.0 and 4.0 * a * c <= b * b)


@njit
def first_change(coefficients, degree, sign, table):
    """Return the least s in <0; 1> where the polynomial no longer has `sign`, or `NEVER`.

    Parameters
    ----------
    coefficients : ndarray, shape (degree + 1 or more,)
        Coefficients of the powers of s. If the first ones are exactly 0, the polynomial has a
        root at 0, and its sign after it is that of the first coefficient that is not 0.
    degree : int
        At most `MAX_DEGREE`.
    sign : float
        +1 or -1: the sign at the start. If the polynomial starts with the other sign, 0.0 is
        returned.
    table : ndarray, shape (`TABLE_ROWS`, `WIDTH`)
        Workspace.
    """
    start = 0
    while start <= degree and coefficients[start] == 0.0:
        start += 1
    if start > degree:
        return NEVER
    if coefficients[start] * sign < 0.0:
        return 0.0
    if _keeps_sign(coefficients[start : degree + 1], sign):
        return NEVER
    # Without its roots at 0 the polynomial has a lower degree.
    m = degree - start
    for j in range(m + 1):
        total = 0.0
        for i in range(j + 1):
            total += _WEIGHTS[m, j, i] * coefficients[start + i]
        table[0, j] = total
    return _search(coefficients[start:], m, sign, table)


@njit
def _search(coefficients, degree, sign, table):
    """Search the intervals from left to right; row `depth` of the table holds the next one."""
    depth = 0
    low = 0.0
    table[0, WIDTH - 1] = 1.0
    while depth >= 0:
        width = table[depth, WIDTH - 1]
        changes, first, last = _variations(table[depth], degree)
        if first == -sign:
            return low
        if changes == 0 or (width == _NARROWEST and last == sign):
            low += width
            depth -= 1
        elif changes == 1:
            return refine(coefficients, degree, low, low + width, sign)
        elif width == _NARROWEST:
            return low + width
        else:
            _halve(table[depth], table[depth + 2], table[depth + 1], degree)
            for j in range(degree + 1):
                table[depth, j] = table[depth + 1, j]
                table[depth + 1, j] = table[depth + 2, j]
            table[depth, WIDTH - 1] = table[depth + 1, WIDTH - 1] = 0.5 * width
            depth += 1
    return NEVER
