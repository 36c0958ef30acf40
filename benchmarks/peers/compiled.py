"""The reduced problem for compiled peers: parameters as one array, the right-hand side in numba.

A state is (y, v, Y, V). `at` and `slope` give y and v between two points of a solution by the
quintic through y, v and a at both: as accurate as the solution for points a sixtieth of a
period apart or closer.
"""

import numpy as np
from numba import njit

from benchmarks.reduced import Piece, support
from gearmesh.model.problem import Problem

STIFFNESS, OFFSET, SHARE, K1, K2, K3, SUPPORT, SUPPORT_DAMPING, SUPPORT_STIFFNESS = range(9)
"""Places in the array that the right-hand side reads."""
N_CONSTANTS = 9


@njit
def accelerate(x, p):
    """Return y'' and Y''."""
    y, v, body, body_rate = x[0], x[1], x[2], x[3]
    elastic = p[STIFFNESS] * (y - p[OFFSET])
    damped = v * (p[K1] + p[K2] * abs(v) + p[K3] * v * v)
    body_acceleration = (
        -p[SUPPORT] * (elastic + damped)
        - p[SUPPORT_DAMPING] * body_rate
        - p[SUPPORT_STIFFNESS] * body
    )
    return 1.0 - p[SHARE] * elastic - damped + body_acceleration, body_acceleration


@njit
def set_regime(p, regime, piece, contact, loss, backlash):
    """Write the constants that hold in `regime` and on `piece` (start, end, C/C_s, share)."""
    coefficients = contact if regime else loss
    p[STIFFNESS] = piece[2] if regime else 0.0
    p[OFFSET] = -backlash if regime < 0 else 0.0
    p[SHARE] = piece[3]
    p[K1], p[K2], p[K3] = coefficients


def constants(problem: Problem) -> np.ndarray:
    """Return the array for the right-hand side, what changes at events still zero."""
    p = np.zeros(N_CONSTANTS)
    p[SUPPORT:] = support(problem)
    return p


def piece_table(cut: tuple[Piece, ...]) -> np.ndarray:
    """Return a row (start, end, C/C_s, share) for each piece of the mesh period."""
    return np.array([(q.start, q.end, q.stiffness, q.share) for q in cut])


@njit
def _coefficients(h, left, right):
    """Return the quintic's coefficients in s = t/h for rows (y, v, a) at both ends."""
    y, v, a = left[0], left[1] * h, left[2] * h * h / 2
    rise = right[0] - y - v - a
    tilt = right[1] * h - v - 2 * a
    bend = right[2] * h * h / 2 - a
    return (
        y,
        v,
        a,
        10 * rise - 4 * tilt + bend,
        -15 * rise + 7 * tilt - 2 * bend,
        6 * rise - 3 * tilt + bend,
    )


@njit
def at(s, h, left, right):
    """Return y at the fraction `s` of an interval of length `h`."""
    c = _coefficients(h, left, right)
    return c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))))


@njit
def slope(s, h, left, right):
    """Return v at the fraction `s` of an interval of length `h`."""
    c = _coefficients(h, left, right)
    return (c[1] + s * (2 * c[2] + s * (3 * c[3] + s * (4 * c[4] + s * 5 * c[5])))) / h


@njit
def root(function, level, low, high, h, left, right):
    """Return where `function` (`at` or `slope`) passes `level` between fractions low and high."""
    start = function(low, h, left, right) - level
    for _ in range(60):
        middle = 0.5 * (low + high)
        value = function(middle, h, left, right) - level
        if (value > 0) == (start > 0):
            low = middle
        else:
            high = middle
        if high - low < 1e-15:
            break
    return 0.5 * (low + high)
