"""Periodic orbits: what they are, whether they are stable, and how far they can be trusted."""

from dataclasses import replace

import numpy as np
import pytest
from problems import problem

from gearmesh.dynamics.periodic.orbits import LARGEST_RESIDUAL, correct, find_orbit
from gearmesh.dynamics.starts import coordinates
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import State
from gearmesh.solvers.simulation import simulate

HEAVY = {"body_mass": 1000.0}
"""Bodies that hardly move: the special points are where the paper has them."""

CASES = [
    ("a-conservative", 1.0, 1),
    ("b-both", 0.9, 1),
    ("c-lubricant", 0.66, 1),
    ("c-lubricant", 0.66, 2),
    ("c-material", 0.62, 1),
    ("d-lubricant", 0.81, 1),
    ("h-material", 1.0, 1),
]


@pytest.mark.parametrize(("name", "nu", "periods"), CASES)
def test_an_orbit_closes_with_its_least_period(name, nu, periods):
    case = problem(nu, name, **HEAVY)
    orbit = find_orbit(case, periods)
    assert orbit.residual < LARGEST_RESIDUAL
    certificate = orbit.certificate
    assert certificate.extremum_margin > 0.0
    assert certificate.multiplier_error < 1e-8
    course = orbit.time_course(256)
    assert course.y.size == 256 * periods
    assert course.y.max() <= orbit.y_max + 1e-12
    assert course.y.min() >= orbit.y_min - 1e-12
    assert orbit.y_max - course.y.max() < 1e-3
    period = 256
    if periods > 1:
        assert np.abs(course.y[:period] - course.y[period : 2 * period]).max() > 1e-3


@pytest.mark.parametrize(
    ("name", "nu", "periods"), [("d-lubricant", 0.81, 1), ("c-lubricant", 0.66, 2)]
)
def test_a_long_run_ends_on_the_stable_orbit(name, nu, periods):
    case = problem(nu, name, bearing_damping_ratio=0.3, **HEAVY)
    orbit = find_orbit(case, periods)
    assert orbit.stable and not orbit.neutral
    near = orbit.state + np.array([1e-3, 0.0, 0.0, 0.0])
    run = replace(case, initial_state=State(*near), revolutions=80)
    response = simulate([run], tolerance=1e-12)[0]
    assert 80 * case.teeth % periods == 0
    end = coordinates(response.final_state)
    np.testing.assert_allclose(end, orbit.state, atol=1e-10, rtol=0)


def test_a_deviation_decays_at_the_rate_of_its_multiplier():
    case = problem(0.81, "d-lubricant", **HEAVY)
    orbit = find_orbit(case)
    values, vectors = np.linalg.eig(orbit.passage.jacobian)
    place = int(np.argmax(np.where(values.imag == 0.0, values.real, -np.inf)))
    assert values[place].real > 0.5
    start = orbit.state + 1e-6 * vectors[:, place].real
    run = replace(case, initial_state=State(*start), revolutions=1)
    response = simulate([run], tolerance=1e-14)[0]
    away = np.hypot(response.strobe_y - orbit.y, response.strobe_v - orbit.v)
    rate = (away[5] / away[0]) ** (1.0 / 5.0)
    assert rate == pytest.approx(values[place].real, rel=1e-5)


@pytest.mark.parametrize(("name", "nu"), [("c-lubricant", 0.9), ("b-both", 0.62)])
def test_the_phase_matters_neither_to_orbits_nor_to_multipliers(name, nu):
    orbits = [find_orbit(problem(nu, name, initial_phase=phase)) for phase in (0.0, 0.2845, 0.7)]
    for other in orbits[1:]:
        np.testing.assert_allclose(other.multipliers, orbits[0].multipliers, atol=1e-8, rtol=0)
        assert other.signature == orbits[0].signature
        assert other.y_max == pytest.approx(orbits[0].y_max, abs=1e-10)
        assert other.y_min == pytest.approx(orbits[0].y_min, abs=1e-10)


def test_without_damping_in_contact_the_orbit_is_neutral():
    orbit = find_orbit(problem(0.62, "c-lubricant"))
    assert orbit.signature == (1,)
    assert orbit.neutral and not orbit.stable
    # The same motion with damping is not neutral, however little of it there is.
    damped = find_orbit(problem(0.62, "b-material", material=(1e-9, 0.0, 0.0)))
    assert not damped.neutral


def test_in_the_tongue_the_orbit_in_contact_is_unstable():
    orbit = find_orbit(problem(0.66, "c-lubricant", body_mass=1e6, friction_coefficient=0.0))
    assert orbit.signature == (1,)
    assert not orbit.neutral and not orbit.stable
    assert orbit.multipliers[0].imag == 0.0
    assert orbit.multipliers[0].real < -1.0


def test_a_start_leads_to_the_orbit_beside_it():
    case = problem(0.75, "c-lubricant", **HEAVY)
    contact = find_orbit(case)
    assert contact.signature == (1,)
    lower = find_orbit(problem(0.81, "c-lubricant", **HEAVY))
    other = find_orbit(case, start=lower.state)
    assert other.signature == (1, 0)
    assert np.abs(other.state - contact.state).max() > 0.1


def test_what_is_no_orbit_is_said_with_its_reason():
    case = problem(0.62, "c-material")
    orbit = find_orbit(case)
    with pytest.raises(NoOrbit, match="leads to an orbit of period 1"):
        correct(case, orbit.state, 2)
    with pytest.raises(NoOrbit, match="leads to an orbit of period 1"):
        find_orbit(case, 2, start=orbit.state)
    with pytest.raises(NoOrbit, match="run-out"):
        find_orbit(problem(0.62, eccentricity_3=0.1))
