"""Pieces of a branch in which special points may lie, found from all its points at once.

Compiled code leaves the test functions of a branch in arrays, so a few array operations show where
a closer look is needed.
"""

import numpy as np

from gearmesh.dynamics.continuation.curves import Point
from gearmesh.dynamics.continuation.special_points import BIFURCATIONS, GRAZINGS, KINDS
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.derivatives.curves import DAMPING, JACOBIAN, TANGENT
from gearmesh.solvers.reduced.derivatives.deviations import DEVIATIONS, SIZE
from gearmesh.solvers.reduced.derivatives.period_map import segments_of
from gearmesh.solvers.reduced.derivatives.variational import (
    AFTER,
    BEFORE,
    CROSSING,
    HEIGHT,
    KIND,
    SEGMENT,
    SWITCH,
    TURN,
    VELOCITY,
)

_MARGIN = 0.25


def suspects(points: list[Point]) -> list[tuple[int, set[str]]]:
    """Return every i for which a special point may lie between point i and the next one.

    A piece of the branch is suspect if a test function changes sign in it. It is also suspect if a
    test function may cross 0 twice in it, that is, if its value at an end is less than `_MARGIN`
    times its change nearby. All test functions are computed for all points at once, so only the
    suspect pieces need a closer look. The kinds that may lie there are returned with each i.
    """
    found = [point.found for point in points if point.found and len(point.found[1])]
    if len(found) < len(points):
        return [(i, set(KINDS)) for i in range(len(points) - 1)]
    heights, velocities, crossings = _event_functions(points[0].orbit.problem, found)
    bifurcations = _bifurcation_functions(points, np.array([row for row, _ in found]))
    functions = np.column_stack([*bifurcations, *heights, *velocities])
    kinds = np.array([*BIFURCATIONS, *GRAZINGS, *("switching" for _ in velocities)])
    with np.errstate(invalid="ignore"):
        change = np.abs(np.diff(functions, axis=0))
        nearby = change.copy()
        nearby[1:] = np.fmax(nearby[1:], change[:-1])
        nearby[:-1] = np.fmax(nearby[:-1], change[1:])
        size = np.abs(functions)
        near = (functions[1:] * functions[:-1] <= 0.0) | (
            np.fmin(size[1:], size[:-1]) < _MARGIN * nearby
        )
    near[:, np.isin(kinds, GRAZINGS)] |= (np.diff(crossings) != 0)[:, None]
    return [(int(i), set(kinds[near[i]])) for i in np.flatnonzero(near.any(axis=1))]


def _bifurcation_functions(points: list[Point], rows: np.ndarray) -> list[np.ndarray]:
    """Return the functions of `_bifurcation_tests`, each at all points."""
    extended = rows[:, JACOBIAN:TANGENT].reshape(-1, SIZE, DEVIATIONS)
    jacobians = np.ascontiguousarray(extended[:, :, :SIZE])
    return [
        np.array([point.slope for point in points]),
        np.array([point.determinant for point in points]),
        np.linalg.det(jacobians + np.eye(SIZE)),
        np.where(rows[:, DAMPING] != 0.0, _pair_products(jacobians), np.nan),
    ]


def _pair_products(jacobians: np.ndarray) -> np.ndarray:
    """Return the products of all mu_i mu_k - 1, from the characteristic polynomials.

    The sums mu_1 mu_2 + mu_3 mu_4, ... are the roots of the resolvent cubic of the polynomial.
    """
    square = jacobians @ jacobians
    one, two = (np.einsum("kii->k", power) for power in (jacobians, square))
    three = np.einsum("kij,kji->k", square, jacobians)
    e_2 = (one**2 - two) / 2.0
    e_3 = (one**3 - 3.0 * one * two + 2.0 * three) / 6.0
    e_4 = np.linalg.det(jacobians)
    s = 1.0 + e_4
    cubic = s**3 - e_2 * s**2 + (one * e_3 - 4.0 * e_4) * s
    return cubic - (one**2 * e_4 + e_3**2 - 4.0 * e_2 * e_4)


def _event_functions(
    problem: Problem, found: list[tuple[np.ndarray, np.ndarray]]
) -> tuple[list[np.ndarray], np.ndarray, np.ndarray]:
    """Return functions that pass 0 where events appear or vanish, each at all points.

    The first functions are the least distances between extrema of y and the ends of regimes. The
    others are the velocities where C(t) jumps. Such a velocity counts only if y'' changes sign at
    the jump, at this point or a neighbouring one. The last result is the number of changes of
    regime.
    """
    stiffness = segments_of(problem)[:, 1]
    events = np.concatenate([one for _, one in found])
    first = np.cumsum([0, *(len(one) for _, one in found[:-1])])
    kind, height = events[:, KIND], events[:, HEIGHT]
    jumps = (kind == SWITCH) & (stiffness != np.roll(stiffness, 1))[events[:, SEGMENT].astype(int)]
    margins = [
        np.minimum.reduceat(np.where(kind == TURN, np.abs(height - level), np.inf), first)
        for level in (0.0, -problem.backlash)
    ]
    velocities = events[jumps, VELOCITY].reshape(len(found), -1)
    turning = (events[jumps, BEFORE] * events[jumps, AFTER] < 0.0).reshape(velocities.shape)
    beside = turning.copy()
    beside[1:] |= turning[:-1]
    beside[:-1] |= turning[1:]
    velocities[~beside] = np.nan
    return margins, velocities.T, np.add.reduceat(kind == CROSSING, first, dtype=int)
