"""Values and roots of a polynomial, whose coefficients stand in an array, the lowest first."""

import numpy as np

from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes.operations import fma

_NARROWEST = 1e-8  # share of a step; roots closer than this are not separated
_SQUARED = 1e-9  # share of a step; the error after a correction of this size is its square


@inner
def value_and_slope(polynomial, s):
    """Return a polynomial, lowest coefficient first, and its slope at `s`."""
    value, slope = 0.0, 0.0
    for k in range(polynomial.size - 1, -1, -1):
        slope = fma(slope, s, value)
        value = fma(value, s, polynomial[k])
    return value, slope


@inner
def root_between(polynomial, low, high):
    """Return the root of a polynomial that is monotone between `low` and `high`.

    Newton's method begins where a cubic polynomial for the inverse function has the root.
    """
    value, slope = polynomial[0], polynomial[1]
    if low > 0.0:
        value, slope = value_and_slope(polynomial, low)
    other, steepness = value_and_slope(polynomial, high)
    falling = value > other
    following = 0.5 * (low + high)
    if slope != 0.0 and steepness != 0.0 and value != other:
        share, rise = value / (value - other), other - value
        bend = (1.0 - share) * (rise / slope - high + low) - share * (rise / steepness - high + low)
        guess = low + share * (high - low + (1.0 - share) * bend)
        following = guess if low < guess < high else following
    for _ in range(80):
        s = following
        value, slope = value_and_slope(polynomial, s)
        if value == 0.0:
            break
        if (value > 0.0) == falling:
            low = s
        else:
            high = s
        following = s - value / slope if slope != 0.0 else low
        if abs(following - s) <= _SQUARED * high:
            return min(max(following, low), high)
        if not low < following < high:
            following = 0.5 * (low + high)
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
