"""Attractors and basins: what runs end on, whoever started them and in whatever order."""

import math
from dataclasses import replace

import numpy as np
import pytest
from problems import problem

from gearmesh.dynamics.attractors import (
    CHAOTIC,
    MOVING,
    NEUTRAL,
    PERIODIC,
    QUASI_PERIODIC,
    attractor_at,
    basins,
    reached,
    wilson_interval,
)
from gearmesh.model.problem import State
from gearmesh.solvers.simulation import simulate

HEAVY = {"body_mass": 1000.0}
HEIGHTS, VELOCITIES = np.linspace(-2.0, 4.0, 4), np.linspace(-3.0, 3.0, 4)


@pytest.fixture(scope="module")
def two_orbits():
    """b-both between its folds: two stable orbits."""
    case = problem(0.75, "b-both", **HEAVY)
    return case, basins(case, HEIGHTS, VELOCITIES)


def test_each_start_leads_to_one_of_the_coexisting_orbits(two_orbits):
    case, found = two_orbits
    assert [one.orbit.periods for one in found.attractors] == [1, 1]
    contact, loss = (one.orbit for one in found.attractors)
    assert contact.signature == (1,)
    assert loss.signature == (1, 0)
    assert found.labels.shape == (1, 4, 4)
    assert set(found.labels.ravel()) == {0, 1}
    assert found.shares[:, 0].sum() == pytest.approx(1.0)
    for i in range(4):
        for j in range(4):
            start = State(HEIGHTS[i], VELOCITIES[j], -2.0, 0.0)
            run = replace(case, initial_state=start, revolutions=150)
            response = simulate([run])[0]
            orbit = found.attractors[found.labels[0, i, j]].orbit
            assert response.y_max == pytest.approx(orbit.y_max, abs=1e-6)
            assert response.y_min == pytest.approx(orbit.y_min, abs=1e-6)


def test_the_order_of_the_starts_does_not_matter(two_orbits):
    case, found = two_orbits
    starts = [State(y, v, -2.0, 0.0) for y in HEIGHTS for v in VELOCITIES]
    runs = [replace(case, initial_state=start) for start in starts]
    backwards = reached(runs[::-1])
    np.testing.assert_array_equal(backwards.labels[::-1], found.labels.ravel())
    for one, other in zip(backwards.attractors, found.attractors, strict=True):
        assert one.orbit.y_max == pytest.approx(other.orbit.y_max, abs=1e-9)


def test_attractors_are_the_same_at_all_phases(two_orbits):
    case, found = two_orbits
    everywhere = basins(case, HEIGHTS[1:3], VELOCITIES, phases=(0.0, 0.35, 0.7))
    assert everywhere.labels.shape == (3, 2, 4)
    for one, other in zip(everywhere.attractors, found.attractors, strict=True):
        assert one.orbit.y_max == pytest.approx(other.orbit.y_max, abs=1e-9)
    np.testing.assert_array_equal(everywhere.labels[0], found.labels[0, 1:3])


def test_the_time_constant_is_that_of_the_slowest_multiplier(two_orbits):
    attractor = two_orbits[1].attractors[0]
    away = abs(attractor.orbit.multipliers[0]) ** attractor.time_constant
    assert away == pytest.approx(math.exp(-1.0))


def test_without_damping_motion_is_neutral_or_chaotic():
    case = problem(1.0, "a-conservative", **HEAVY)
    starts = [State(1.0, 0.0, -2.0, 0.0), State(3.5, 2.0, -2.0, 0.0)]
    found = reached([replace(case, initial_state=start) for start in starts])
    assert [found.attractors[label].kind for label in found.labels] == [NEUTRAL, CHAOTIC]
    assert found.attractors[found.labels[1]].spectrum.exponents[0] > 0.01


def test_motion_that_only_just_loses_contact_still_moves():
    """Beyond the last grazing of c-lubricant the oil takes less and less, for ever."""
    case = problem(1.15, "c-lubricant", **HEAVY)
    found = reached([replace(case, initial_state=State(2.0, 1.0, -2.0, 0.0))])
    assert [one.kind for one in found.attractors] == [MOVING]
    assert PERIODIC != MOVING != QUASI_PERIODIC


def test_a_period_of_several_mesh_periods_is_found():
    case = problem(0.66, "c-lubricant", **HEAVY)
    found = reached([replace(case, initial_state=State(1.0, 0.0, -2.0, 0.0))])
    assert [one.orbit.periods for one in found.attractors] == [2]
    orbit = found.attractors[0].orbit
    assert attractor_at(case, orbit.state + 1e-3).orbit.y_max == pytest.approx(orbit.y_max)


def test_wilson_interval():
    assert wilson_interval(10, 20) == pytest.approx([0.5, 0.2993, 0.7007], abs=1e-4)
    share, low, high = wilson_interval(0, 49)
    assert share == low == 0.0
    assert high == pytest.approx(0.0727, abs=1e-4)
