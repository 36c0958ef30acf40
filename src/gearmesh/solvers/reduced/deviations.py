"""Taylor series of a motion and of its deviations, within one branch of all laws.

The equations are those of `gearmesh.solvers.reduced.variational`. A deviation (dy, dv, db, db') of
the state obeys the linearised equations: without the constant 1, with c dy in place of E and
c dy + D dv in place of N, where D = k_1 + 2 k_2 |v| + 3 k_3 v^2.

Five deviations are carried. Four belong to the coordinates of the state. The fifth is the
derivative with respect to the logarithm of the mesh period, which stretches all segments. Within a
segment the law does not depend on time, so the motion ends ahead by its rate times the change of
the segment's length, and this is carried on like any other deviation.
"""

import numpy as np

from gearmesh.solvers.compilation import inner

ORDER = 20
"""Degree of the Taylor polynomials."""

SIZE = 4
"""Size of the state (y, v, b, b')."""

DEVIATIONS = 5
"""Number of deviations. They are the columns of an array of shape (SIZE, DEVIATIONS)."""

FORCE_PLACES = 9
"""Places of a step, its ends included, at which the force between the flanks is computed."""


@inner
def expand(motion, deviations, slope, square, push, direction, c, offset, g, law, bearings):
    """Write the series of the motion and of its deviations.

    Parameters
    ----------
    motion : ndarray, shape (SIZE, ORDER + 1)
    deviations : ndarray, shape (ORDER + 1, SIZE * DEVIATIONS)
        Both with the coefficients of degree 0 as input.
    slope : ndarray, shape (ORDER + 1,)
        The series of D.
    square, push : ndarray, shape (ORDER + 1,) and (DEVIATIONS,)
        Room for v^2, and for the damping force of the deviations.
    direction : float
        Sign of v.
    c, offset, g : float
        Stiffness (0 in contact loss), level y_0, friction's share of the elastic force.
    law, bearings : ndarray, shape (3,)
        k_1, k_2, k_3, and 2 mu, w^2, 2 zeta w.
    """
    two_mu, support, damped = bearings[0], bearings[1], bearings[2]
    share = 1.0 + two_mu
    y, v, b, b_rate = motion[0], motion[1], motion[2], motion[3]
    bends = law[1] != 0.0 or law[2] != 0.0
    for k in range(ORDER):
        part = 1.0 / (k + 1.0)
        total, cube = 0.0, 0.0
        if bends:
            for i in range(k + 1):
                total += v[i] * v[k - i]
        square[k] = total
        if law[2] != 0.0:
            for i in range(k + 1):
                cube += square[i] * v[k - i]
        slope[k] = 2.0 * law[1] * direction * v[k] + 3.0 * law[2] * total
        if k == 0:
            slope[0] += law[0]
        elastic = c * (y[k] - offset if k == 0 else y[k])
        normal = elastic + law[0] * v[k] + law[1] * direction * total + law[2] * cube
        bearing = -support * b[k] - damped * b_rate[k]
        load = 1.0 if k == 0 else 0.0
        y[k + 1] = part * v[k]
        v[k + 1] = part * (load + g * elastic - share * normal + bearing)
        b[k + 1] = part * b_rate[k]
        b_rate[k + 1] = part * (bearing - two_mu * normal)
        _damp(deviations, slope, push, k, bends)
        here, following = deviations[k], deviations[k + 1]
        for i in range(DEVIATIONS):
            elastic = c * here[i]
            normal = elastic + push[i]
            bearing = -support * here[2 * DEVIATIONS + i] - damped * here[3 * DEVIATIONS + i]
            following[i] = part * here[DEVIATIONS + i]
            following[DEVIATIONS + i] = part * (g * elastic - share * normal + bearing)
            following[2 * DEVIATIONS + i] = part * here[3 * DEVIATIONS + i]
            following[3 * DEVIATIONS + i] = part * (bearing - two_mu * normal)
    slope[ORDER] = 0.0


@inner
def _damp(deviations, slope, push, k, bends):
    """Write the coefficients of degree `k` of D dv to `push`.

    The processor computes the five sums side by side, because none waits for another. D is constant
    unless it bends.
    """
    first, second, third, fourth, fifth = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(k + 1 if bends else 1):
        factor, row = slope[i], deviations[k - i]
        first += factor * row[DEVIATIONS]
        second += factor * row[DEVIATIONS + 1]
        third += factor * row[DEVIATIONS + 2]
        fourth += factor * row[DEVIATIONS + 3]
        fifth += factor * row[DEVIATIONS + 4]
    push[0], push[1], push[2], push[3], push[4] = first, second, third, fourth, fifth


@inner
def longest_step(motion, deviations, tolerance, longest):
    """Return the step at which the last terms of all series reach the tolerance."""
    step, size = longest, 1.0
    for row in range(SIZE):
        size = max(size, abs(motion[row, 0]))
    for k in range(ORDER - 2, ORDER + 1):
        last = 0.0
        for row in range(SIZE):
            last = max(last, abs(motion[row, k]) / size)
        for column in range(DEVIATIONS):
            begun, largest = 1.0, 0.0
            for place in range(column, SIZE * DEVIATIONS, DEVIATIONS):
                begun = max(begun, abs(deviations[0, place]))
                largest = max(largest, abs(deviations[k, place]))
            last = max(last, largest / begun)
        if last > 0.0:
            step = min(step, (tolerance / last) ** (1.0 / k))
    return step


@inner
def write_deviations(deviations, s, jacobian):
    """Write the deviations at `s` to `jacobian`, shape (SIZE, DEVIATIONS)."""
    found = jacobian.reshape(SIZE * DEVIATIONS)
    found[:] = deviations[ORDER]
    for k in range(ORDER - 1, -1, -1):
        row = deviations[k]
        for i in range(SIZE * DEVIATIONS):
            found[i] = found[i] * s + row[i]


@inner
def least_force_in(motion, step, direction, c, offset, law, regime, heights, speeds):
    """Return the least force between flanks that touch, at `FORCE_PLACES` places of a step.

    `heights` and `speeds` are room for y and v there.
    """
    heights[:], speeds[:] = motion[0, ORDER], motion[1, ORDER]
    for k in range(ORDER - 1, -1, -1):
        for place in range(FORCE_PLACES):
            s = step * place / (FORCE_PLACES - 1)
            heights[place] = heights[place] * s + motion[0, k]
            speeds[place] = speeds[place] * s + motion[1, k]
    least = np.inf
    for place in range(FORCE_PLACES):
        v = speeds[place]
        damper = (law[0] + (law[1] * direction + law[2] * v) * v) * v
        least = min(least, regime * (c * (heights[place] - offset) + damper))
    return least
