"""What points show at once is what their orbits show, integrated anew."""

from itertools import combinations

import numpy as np
import pytest
from problems import problem

from gearmesh.dynamics.continuation.branches import follow
from gearmesh.dynamics.continuation.tracing import Track
from gearmesh.dynamics.periodic.orbits import Orbit, find_orbit
from gearmesh.solvers.reduced.derivatives.multipliers import products


@pytest.fixture(scope="module")
def branch():
    """Through a grazing, with a switching in normal mesh."""
    return follow(find_orbit(problem(0.7, "c-material")), "nu", (0.6, 0.9))


def test_a_point_shows_what_its_orbit_shows(branch):
    (piece,) = branch.pieces
    assert isinstance(piece.points, Track)
    names = ("period", "periods", "backlash", "undamped", "y", "y_max", "y_min")
    arrays = ("monodromy", "extrema", "gap_extrema", "stiffness_jumps")
    for point in piece.points[::20]:
        known = point.orbit
        again = Orbit(known.problem, known.periods, known.state)
        for orbit, within in ((known, 1e-15), (again, 1e-12)):
            found = [getattr(point.motion, name) for name in names]
            np.testing.assert_allclose(found, [getattr(orbit, name) for name in names], rtol=1e-14)
            for name in arrays:
                expected = getattr(orbit, name)
                np.testing.assert_allclose(getattr(point.motion, name), expected, atol=within)


def test_a_branch_is_the_same_points_in_both_directions(branch):
    (piece,) = branch.pieces
    back = piece.reversed().points
    for point, same in zip(piece.points, list(back)[::-1], strict=True):
        assert point.values == same.values
        assert point.determinant == -same.determinant
        np.testing.assert_array_equal(point.tangent, -same.tangent)
        np.testing.assert_array_equal(point.motion.extrema, same.motion.extrema)


@pytest.mark.parametrize("size", [2, 4, 9])
def test_products_are_those_of_the_multipliers(size):
    matrices = np.random.default_rng(size).normal(size=(20, size, size)) / np.sqrt(size)
    flips, pairs = products(matrices)
    for matrix, flip, pair in zip(matrices, flips, pairs, strict=True):
        multipliers = np.linalg.eigvals(matrix)
        assert flip == pytest.approx(np.prod(multipliers + 1.0).real, rel=1e-9)
        expected = np.prod([a * b - 1.0 for a, b in combinations(multipliers, 2)]).real
        assert pair == pytest.approx(expected, rel=1e-9)


def test_products_are_zero_where_multipliers_are_on_the_unit_circle():
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
    matrices = np.zeros((2, 4, 4))
    matrices[0, :2, :2], matrices[0, 2:, 2:] = quarter, 0.5 * np.eye(2)
    matrices[1] = np.diag([-1.0, 0.3, 0.2, 0.1])
    flips, pairs = products(matrices)
    assert pairs[0] == flips[1] == 0.0
    assert flips[0] == pytest.approx(2.0 * 1.5**2)
