"""Curves of periodic orbits over the mesh frequency, corrected and followed in compiled code.

A place is a state and the mesh frequency in units of the curve. A point is a row of numbers: its
place, the end of the motion over the period, the Jacobian, the tangent of the curve, and more.
"""

import numpy as np

from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes.rows import unowned
from gearmesh.solvers.reduced.derivatives.deviations import DEVIATIONS, SIZE, WORKSPACE
from gearmesh.solvers.reduced.derivatives.variational import COMPLETE, HEIGHT, KIND, TURN, propagate

DIMENSIONS = SIZE + 1
"""Size of a place."""

END = DIMENSIONS
JACOBIAN = END + SIZE
TANGENT = JACOBIAN + SIZE * DEVIATIONS
DETERMINANT, OUTCOME, N_EVENTS, DAMPING, LEAST_FORCE, Y_MAX, Y_MIN, POINT_SIZE = range(
    TANGENT + DIMENSIONS, TANGENT + DIMENSIONS + 8
)
"""Columns of a point, behind its place: the end of the motion, the Jacobian, the tangent, its
determinant (see `gearmesh.dynamics.continuation.curves.Point`), what `propagate` returns, and the
extremes of y."""

LARGEST_RESIDUAL = 1e-11
"""Largest |P^n(x) - x| of an orbit, in y_st and y_st Omega_s."""

ROUNDED = 1e-14
"""Residual that another correction does not improve."""

FARTHEST = 100.0
"""Size of y, in y_st, beyond which no orbits are searched for."""

SHORTEST_STEP = 1e-7
"""Shortest step along a curve."""

LEAST_ALIGNMENT = 0.97
"""Cosine of the largest angle between neighbouring tangents."""

LARGEST_CORRECTION = 0.003
"""Largest correction of a predicted place, as a share of the step.

A larger one may lead to another branch nearby. Where the prediction is a straight line, what the
turn of the curve explains is allowed in addition.
"""

GROWTH = 1.4
"""Most by which a step is longer than the one before."""

LARGE = 5.0
"""Size of y, in y_st, beyond which the longest step grows in proportion to it."""

_SHORTEST_CORRECTION = 1.0 / 1024.0
_HISTORY = 3  # points from which the next is predicted


@inner
def copy(source, target):
    """Write numbers to the beginning of an array.

    numba takes seconds to compile assignments between arrays, for the message of a failure.
    """
    for i in range(len(source)):
        target[i] = source[i]


@inner
def solve(matrix):
    """Reduce a matrix with extra columns so that these hold the solutions; return its determinant.

    The result is 0, and the columns hold no solution, if the matrix is singular. It is
    not-a-number if an element is.
    """
    determinant, n = 1.0, len(matrix)
    for i in range(n):
        best = i
        for row in range(i + 1, n):
            if abs(matrix[row, i]) > abs(matrix[best, i]):
                best = row
        pivot = matrix[best, i]
        if not abs(pivot) > 0.0:
            return pivot
        determinant *= pivot if best == i else -pivot
        for column in range(i, matrix.shape[1]):
            moved = matrix[best, column] / pivot
            matrix[best, column] = matrix[i, column]
            matrix[i, column] = moved
        for row in range(n):
            factor = matrix[row, i]
            if row != i and factor != 0.0:
                for column in range(i, matrix.shape[1]):
                    matrix[row, column] -= factor * matrix[i, column]
    return determinant


@inner
def border(point, normal, ahead, matrix):
    """Write the gradients of P^n(x) - x, bordered by `normal`, and two right-hand sides."""
    for i in range(SIZE):
        for j in range(SIZE):
            matrix[i, j] = point[JACOBIAN + DEVIATIONS * i + j]
        matrix[i, i] -= 1.0
        matrix[i, SIZE] = -point[JACOBIAN + DEVIATIONS * i + SIZE] / point[SIZE]
        matrix[i, DIMENSIONS] = point[END + i] - point[i]
        matrix[i, DIMENSIONS + 1] = 0.0
    for j in range(DIMENSIONS):
        matrix[SIZE, j] = normal[j]
    matrix[SIZE, DIMENSIONS] = ahead
    matrix[SIZE, DIMENSIONS + 1] = 1.0


@inner
def write_tangent(point, normal, matrix):
    """Write the tangent at a point, in the direction of `normal`, and the determinant."""
    border(point, normal, 0.0, matrix)
    determinant = solve(matrix)
    size = 0.0
    for j in range(DIMENSIONS):
        size += matrix[j, DIMENSIONS + 1] ** 2
    size = np.sqrt(size)
    for j in range(DIMENSIONS):
        point[TANGENT + j] = matrix[j, DIMENSIONS + 1] / size if abs(determinant) > 0.0 else 0.0
    # The bordering row counts only by its part along the tangent, 1/size.
    point[DETERMINANT] = determinant * size


@inner
def residual_of(point):
    """Return |P^n(x) - x|; infinity if the motion is not complete."""
    if point[OUTCOME] != COMPLETE:
        return np.inf
    largest = 0.0
    for i in range(SIZE):
        largest = max(largest, abs(point[END + i] - point[i]))
    return largest if largest < np.inf else np.inf


@inner(inline="always")
def _evaluate(statement, unit, point, events, room):
    """Move from the place of a point over the period, and write what it gives."""
    begun, laws, backlash, bearings, visits, longest, tolerance, nu = statement
    samples, per_period, segments, workspace, _ = room
    for i in range(len(segments)):
        copy(begun[i], segments[i])
        segments[i, 0] *= nu / (point[SIZE] * unit)
    state = point[END : END + SIZE]
    copy(point[:SIZE], state)
    jacobian = point[JACOBIAN:TANGENT].reshape((SIZE, DEVIATIONS))
    jacobian[:, :] = 0.0
    for i in range(SIZE):
        jacobian[i, i] = 1.0
    outcome, n_events, damping, least_force = propagate(
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
    )
    point[OUTCOME], point[N_EVENTS] = outcome, n_events
    point[DAMPING], point[LEAST_FORCE] = damping, least_force
    point[Y_MAX] = point[Y_MIN] = point[0]
    for event in events[:n_events]:
        if event[KIND] == TURN:
            point[Y_MAX] = max(point[Y_MAX], event[HEIGHT])
            point[Y_MIN] = min(point[Y_MIN], event[HEIGHT])


@inner(inline="always")
def _land(statement, unit, points, events, row, origin, normal, corrections, room):
    """Correct the place of a point in the plane through `origin`; return whether it is an orbit.

    Damping helps far from an orbit. Near one a whole correction fails only because of rounding.
    """
    matrix = room[-1]
    point, trial = points[row], points[-1]
    copy(point[:DIMENSIONS], trial)
    best, share, shortest = np.inf, 0.0, 0.0
    while share >= shortest:
        _evaluate(statement, unit, trial, events[-1], room)
        residual = residual_of(trial)
        if residual < (1.0 - 0.1 * share) * best or best == np.inf:
            best, share = residual, 1.0
            copy(trial, point)
            count = int(trial[N_EVENTS])
            for i in range(count):
                copy(events[-1, i], events[row, i])
            if corrections == 0 or best < ROUNDED or best == np.inf:
                break
            corrections -= 1
            shortest = 1.0 if best < LARGEST_RESIDUAL else _SHORTEST_CORRECTION
            ahead = 0.0
            for j in range(DIMENSIONS):
                ahead += normal[j] * (point[j] - origin[j])
            border(point, normal, ahead, matrix)
            if not abs(solve(matrix)) > 0.0:
                break
        else:
            share *= 0.5
        for j in range(DIMENSIONS):
            trial[j] = point[j] - share * matrix[j, DIMENSIONS]
        if not trial[SIZE] > 0.0:
            break
    write_tangent(point, normal, matrix)
    return best < LARGEST_RESIDUAL


@inner
def _predict(points, last, length, nodes, slopes, table):
    """Write the predicted place of the next point to the next row.

    The next point lies in the plane across the tangent of the last one, `length` ahead of it. The
    prediction extrapolates a polynomial in the distance along this tangent, so it lies in the
    plane too. The polynomial matches the last points and their tangents.
    """
    count = 2 * min(last + 1, _HISTORY)
    ahead = points[last, TANGENT : TANGENT + DIMENSIONS]
    for i in range(0, count, 2):
        distance, slope = 0.0, 0.0
        for j in range(DIMENSIONS):
            distance += ahead[j] * (points[last - i // 2, j] - points[last, j])
            slope += ahead[j] * points[last - i // 2, TANGENT + j]
        nodes[i] = nodes[i + 1] = distance
        slopes[i] = slopes[i + 1] = slope
    for j in range(DIMENSIONS):
        for i in range(count):
            table[i] = points[last - i // 2, j]
        for order in range(1, count):
            for i in range(count - 1, order - 1, -1):
                if order == 1 and i % 2 == 1:
                    table[i] = points[last - i // 2, TANGENT + j] / slopes[i]
                else:
                    table[i] = (table[i] - table[i - 1]) / (nodes[i] - nodes[i - order])
        value = table[count - 1]
        for i in range(count - 2, -1, -1):
            value = value * (length - nodes[i]) + table[i]
        points[last + 1, j] = value


@inner
def _goes_on(point, guess, normal, length, straight):
    """Return whether a point continues the curve along `normal`, and is near where it was expected.

    If `straight`, it was expected on the tangent, from which an arc departs as it turns.
    """
    moved, aligned = 0.0, 0.0
    for j in range(DIMENSIONS):
        moved += (point[j] - guess[j]) ** 2
        aligned += point[TANGENT + j] * normal[j]
    bent = np.sqrt(max(1.0 - aligned**2, 0.0)) if straight else 0.0
    near = moved < (length * (bent + LARGEST_CORRECTION)) ** 2
    return near and aligned > LEAST_ALIGNMENT


@inner
def is_clear(y, y_max, y_min, backlash):
    """Return whether y is at least half as far from the ends of regimes as an orbit ever gets."""
    middle = min(max(-0.5 * backlash, y_min), y_max)
    best = 0.0
    for height in (y_max, y_min, middle):
        best = max(best, min(abs(height), abs(height + backlash)))
    return min(abs(y), abs(y + backlash)) >= 0.5 * best


@inner(inline="always")
def trace(statement, unit, corrections, length, longest, limits, points, events, samples):
    """Correct points, or follow the curve from the first one as far as there are rows.

    Parameters
    ----------
    statement : tuple
        Segments, laws, backlash, bearings, visits, longest step and tolerance of `propagate`, and
        the mesh frequency nu of these segments.
    unit : float
        Change of nu that counts like a change of 1 in the state.
    corrections : int
        Most corrections of a point. The first point of a curve is only evaluated.
    length, longest : float
        Length of the first step, and of the longest one. If the length is 0, all rows hold points
        to be corrected.
    limits : tuple of float
        Range of nu.
    points : ndarray, shape (n + 1, POINT_SIZE)
        A row of a point to be corrected, and the first row of a curve, hold a place, and in place
        of the tangent the normal of the plane in which the point is searched for. The last row is
        room.
    events : ndarray, shape (n + 1, room, EVENT_SIZE)
    samples : ndarray, shape (n, 4)
        As for `propagate`, over all visits.

    Returns
    -------
    count : int
        Points found. The last one may lie outside the limits or farther than `FARTHEST`, or
        close to the end of a regime, so that its state is better taken at another phase.
    length : float
        Length of the next step; `SHORTEST_STEP` or less if no step succeeds.
    """
    points, events = unowned(points), unowned(events)
    segments, matrix = np.empty_like(statement[0]), np.empty((DIMENSIONS, DIMENSIONS + 2))
    per_period = len(samples) * len(segments) // statement[4]
    room = samples, per_period, segments, np.empty(WORKSPACE), matrix
    normal, origin, guess = np.empty((3, DIMENSIONS))
    nodes, slopes, table = np.empty((3, 2 * _HISTORY))
    row = 0
    while row < len(points) - 1:
        point, before = points[row], points[row - 1]
        follows = row > 0 and length > 0.0
        if follows:
            for j in range(DIMENSIONS):
                normal[j] = before[TANGENT + j]
                origin[j] = before[j] + length * normal[j]
            _predict(points, row - 1, length, nodes, slopes, table)
            copy(point[:DIMENSIONS], guess)
        else:
            copy(point[TANGENT : TANGENT + DIMENSIONS], normal)
            copy(point[:DIMENSIONS], origin)
        most = corrections if follows or length == 0.0 else 0
        landed = _land(statement, unit, points, events, row, origin, normal, most, room)
        if not follows:
            row += 1
            continue
        if not (landed and _goes_on(point, guess, normal, length, row == 1)):
            length *= 0.5
            if not length > SHORTEST_STEP:
                return row, length
            continue
        row += 1
        size = max(point[Y_MAX], -point[Y_MIN])
        if not limits[0] <= point[SIZE] * unit <= limits[1] or size > FARTHEST:
            break
        length = min(GROWTH * length, longest * max(1.0, size / LARGE))
        if not is_clear(point[0], point[Y_MAX], point[Y_MIN], statement[2]):
            break
    return row, length
