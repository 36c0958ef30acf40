"""Attractors and basins: what runs end on, whoever started them and in whatever order."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from problems import of_paper, problem

from gearmesh.dynamics.attraction.attractors import stable_orbits_near
from gearmesh.dynamics.attraction.basins import basins, reached, wilson_interval
from gearmesh.dynamics.attraction.envelopes import envelope_of
from gearmesh.dynamics.attraction.growth import growth_rates
from gearmesh.dynamics.attraction.kinds import CHAOTIC, NEUTRAL, PERIODIC
from gearmesh.dynamics.attraction.lyapunov import lyapunov_spectrum
from gearmesh.dynamics.attraction.maps import map_of
from gearmesh.dynamics.attraction.regions import region_of
from gearmesh.dynamics.starts import initial_states
from gearmesh.model.problem import State
from gearmesh.solvers.reduced.derivatives.period_map import passage
from gearmesh.solvers.reduced.ensembles import advance, advance_to_phase, laws_of
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
    starts = [State(y, v, -2.0, 0.0) for y, v in itertools.product(HEIGHTS, VELOCITIES)]
    runs = [replace(case, initial_state=start, revolutions=150) for start in starts]
    responses = simulate(runs, estimate_errors=False)
    for label, response in zip(found.labels.ravel(), responses, strict=True):
        orbit = found.attractors[label].orbit
        assert response.y_max == pytest.approx(orbit.y_max, abs=1e-6)
        assert response.y_min == pytest.approx(orbit.y_min, abs=1e-6)


def test_the_order_of_the_starts_does_not_matter(two_orbits):
    case, found = two_orbits
    states = initial_states(case, HEIGHTS, VELOCITIES)
    backwards = reached(case, states[::-1])
    np.testing.assert_array_equal(backwards.labels[::-1], found.labels.ravel())
    assert [one.label for one in backwards.attractors] == [one.label for one in found.attractors]


def test_what_is_reached_from_another_phase_is_what_a_run_from_there_reaches(two_orbits):
    case, _ = two_orbits
    phases = (0.0, 0.35, 0.7)
    found = basins(case, HEIGHTS[1:3], VELOCITIES, phases)
    for phase, labels in zip(phases, found.labels, strict=True):
        there = basins(replace(case, initial_phase=phase), HEIGHTS[1:3], VELOCITIES)
        np.testing.assert_array_equal(there.labels[0], labels)
        # An orbit does not depend on the initial phase, so neither does its label.
        assert [one.label for one in there.attractors] == [one.label for one in found.attractors]


def test_many_starts_are_moved_as_one_is():
    case = problem(0.75, "b-both", **HEAVY)
    states = initial_states(case, HEIGHTS, VELOCITIES)
    ends = advance(laws_of([case]), states, 5)
    for start, end in zip(states, ends, strict=True):
        np.testing.assert_allclose(end, passage(case, start, 5).end, atol=1e-8)
    there = advance_to_phase(case, np.full(16, 0.6), states)
    part = replace(case, initial_phase=0.6)
    samples = passage(part, states[3], 1, 10).samples  # sample 4 is 0.4 of a period later
    np.testing.assert_allclose(there[3, :2], samples[4, :2], atol=1e-8)


def test_no_motion_leaves_a_trapping_region(two_orbits):
    case, found = two_orbits
    for attractor in found.attractors:
        region = region_of(map_of(case), attractor.orbit)
        assert region.size >= 0.01
        away = np.random.default_rng(1).standard_normal((200, 4))
        away *= 0.99 * region.size / np.linalg.norm(away @ region.forms[0].T, axis=1)[:, None]
        states = region.points[0] + away
        assert region.holds(states).all()
        ends = advance(laws_of([case]), states, 4000)
        np.testing.assert_allclose(ends, np.tile(region.points[0], (200, 1)), atol=1e-6)


def test_runs_that_are_not_followed_to_their_end_end_where_they_were_said_to():
    """Three kinds of ends side by side, and more runs than pilots."""
    case = of_paper("c-lubricant", 0.78)
    heights, rates = np.linspace(-2.0, 4.0, 20), np.linspace(-3.0, 3.0, 20)
    found = basins(case, heights, rates)
    assert [one.kind for one in found.attractors] == [PERIODIC, PERIODIC, NEUTRAL]
    assert [one.orbit.periods for one in found.attractors[:2]] == [1, 4]
    ends = advance(laws_of([case]), initial_states(case, heights, rates), 3000)
    away = []
    for attractor in found.attractors[:2]:
        point, nearest = attractor.orbit.state, np.full(len(ends), np.inf)
        for _ in range(attractor.orbit.periods):
            nearest = np.minimum(nearest, np.abs(ends - point).max(axis=1))
            point = passage(case, point).end
        away.append(nearest)
    last = np.where(np.min(away, axis=0) < 1e-6, np.argmin(away, axis=0), 2)
    # Ever shallower contact losses: their depth falls as one over the time.
    assert (envelope_of(case).margins(ends[last == 2]) > -0.01).all()
    np.testing.assert_array_equal(last, found.labels.ravel())


def test_a_displaced_start_decays_as_the_multiplier_says():
    case = problem(0.9, "c-material", **HEAVY)
    settled = advance(laws_of([case]), np.array([[1.0, 0.0, -2.0, 0.0]]), 400)
    [orbit] = stable_orbits_near(map_of(case), settled, 1)
    values, vectors = np.linalg.eig(orbit.passage.jacobian)
    slowest = np.abs(values).argmax()
    away = vectors[:, slowest].real
    end = advance(laws_of([case]), np.array([orbit.state + 1e-6 * away, orbit.state]), 50)
    expected = (values[slowest] ** 50 * vectors[:, slowest]).real
    np.testing.assert_allclose((end[0] - end[1]) / 1e-6, expected, atol=1e-3)


def test_the_time_constant_is_that_of_the_slowest_multiplier(two_orbits):
    attractor = two_orbits[1].attractors[0]
    away = abs(attractor.orbit.multipliers[0]) ** attractor.time_constant
    assert away == pytest.approx(math.exp(-1.0))


def test_without_damping_motion_is_neutral_or_chaotic():
    case = problem(1.0, "a-conservative", **HEAVY)
    states = np.array([[1.0, 0.0, -2.0, 0.0], [3.5, 2.0, -2.0, 0.0]])
    found = reached(case, states)
    assert [found.attractors[label].kind for label in found.labels] == [NEUTRAL, CHAOTIC]
    rates = growth_rates(map_of(case), states)
    for state, rate in zip(states, rates, strict=True):
        exact = lyapunov_spectrum(case, state, 400, 100).exponents[0]
        # Chaos forgets its start, so two estimates agree as means over the same time do.
        assert rate == pytest.approx(exact, abs=0.02 if exact > 0.01 else 2e-3)


def test_motion_above_the_envelope_never_loses_contact_again():
    """Beyond the last grazing of c-lubricant the oil takes less and less, and at last nothing."""
    case = problem(1.18, "c-lubricant", bearing_damping_ratio=0.1)
    envelope = envelope_of(case)
    states = np.array([[2.0, 1.0, -2.0, 0.0], [1.0, 0.3, -2.0, 0.0]])
    found = reached(case, states)
    assert [found.attractors[label].kind for label in found.labels] == [NEUTRAL, NEUTRAL]
    for _ in range(400):
        margins = envelope.margins(states)
        if (margins > 0.0).all():
            break
        states = advance(laws_of([case]), states, 20)
    for state, margin in zip(states, margins, strict=True):
        moved = passage(case, state, 400, 64)
        assert moved.damping == 0.0
        assert moved.samples[:, 0].min() > 0.99 * margin


def test_a_period_of_several_mesh_periods_is_found():
    case = problem(0.66, "c-lubricant", **HEAVY)
    found = reached(case, np.array([[1.0, 0.0, -2.0, 0.0]]))
    assert [one.orbit.periods for one in found.attractors] == [2]


def test_wilson_interval():
    assert wilson_interval(10, 20) == pytest.approx([0.5, 0.2993, 0.7007], abs=1e-4)
    share, low, high = wilson_interval(0, 49)
    assert share == low == 0.0
    assert high == pytest.approx(0.0727, abs=1e-4)
