"""Points of a branch at given values of its parameter."""

import numpy as np
import pytest
from problems import problem

from gearmesh.dynamics.continuation.branches import follow
from gearmesh.dynamics.continuation.walks import CLOSED
from gearmesh.dynamics.periodic.orbits import LARGEST_RESIDUAL, find_orbit
from gearmesh.errors import NoOrbit

HEAVY = {"body_mass": 1000.0}


@pytest.fixture(scope="module")
def lubricant():
    """c-lubricant from end to end: in contact, through a grazing, and around two folds."""
    return follow(find_orbit(problem(0.7, "c-lubricant", **HEAVY)), "nu", (0.6, 1.2))


def test_every_passage_of_a_folded_branch_has_a_point(lubricant):
    """A walk with many points counts them away from the folds; at a fold two begin or end."""
    fine = follow(lubricant.points[0].orbit, "nu", (0.6, 1.2), longest_step=0.003).values
    folds = [point.nu for point in lubricant.special if point.kind == "fold"]
    values = np.linspace(0.601, 1.199, 61)
    assert len(folds) == 2 and np.abs(np.subtract.outer(values, folds)).min() > 1e-4
    passed = [np.sum((fine[1:] < value) != (fine[:-1] < value)) for value in values]
    assert max(passed) == 3
    beside = np.array([fold + away for fold in folds for away in (-1e-7, 1e-7)])
    found = lubricant.resampled(np.append(values, beside))
    assert [np.sum(found.values == value) for value in values] == passed
    assert sorted(np.sum(found.values == value) for value in beside) == [1, 1, 3, 3]
    assert max(orbit.residual for orbit in found.orbits) < LARGEST_RESIDUAL


def test_the_orbits_are_those_that_are_found_without_the_branch():
    """Each search begins with the linear motion; c-material has one orbit at every frequency."""
    branch = follow(find_orbit(problem(0.9, "c-material", **HEAVY)), "nu", (0.6, 1.2))
    found = branch.resampled(np.linspace(0.6, 1.2, 13))
    assert len(found.values) == 13
    for orbit in found.orbits:
        again = find_orbit(orbit.problem)
        np.testing.assert_allclose(again.state, orbit.state, atol=1e-12)
        np.testing.assert_allclose(again.multipliers, orbit.multipliers, atol=1e-9)


def test_values_are_met_to_the_last_digit_and_ends_are_kept(lubricant):
    values = np.array([1.2, 0.6, 0.95, 0.95])
    found = lubricant.resampled(values)
    assert set(found.values) == {0.6, 0.95, 1.2}
    assert found.values[[0, -1]].tolist() == lubricant.values[[0, -1]].tolist()
    assert found.located == lubricant.located
    assert found.ends == lubricant.ends
    again = found.resampled(np.array([0.8]))
    assert again.y_max.tolist() == lubricant.resampled(np.array([0.8])).y_max.tolist()


def test_a_closed_branch_passes_each_value_between_its_folds_twice():
    branch = follow(find_orbit(problem(0.75, "d-lubricant"), 3), "nu", (0.6, 1.2))
    assert branch.ends == (CLOSED, CLOSED)
    assert branch.values[0] == branch.values[-1]
    low, high = sorted(point.nu for point in branch.special if point.kind == "fold")
    values = np.append(np.linspace(low, high, 21)[1:-1], branch.values[0])
    found = branch.resampled(values)
    assert sorted(found.values) == sorted([*values, *values])


def test_a_branch_that_passes_no_value_says_so(lubricant):
    with pytest.raises(NoOrbit, match="none of the values of nu"):
        lubricant.resampled(np.array([0.5, 1.3]))
