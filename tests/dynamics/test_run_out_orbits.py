"""Orbits of pairs whose mean rotation moves: run-out, torsional damping, friction with both."""

from dataclasses import replace

import numpy as np
import pytest
from problems import problem

import gearmesh as gm
from gearmesh.dynamics.periodic import general_search
from gearmesh.dynamics.periodic.charts import state_at_place
from gearmesh.errors import NoOrbit
from gearmesh.model.functions import Harmonic
from gearmesh.model.problem import GeneralTerms
from gearmesh.solvers.simulation import simulate

SMOOTH = {"friction_coefficient": 0.0}
BOTH = {"eccentricity_3": 1.0, "eccentricity_2": 0.5, "eccentricity_angle": 0.3}


def run(case, revolutions):
    [found] = simulate(
        [replace(case, revolutions=revolutions)], tolerance=1e-13, estimate_errors=False
    )
    return found


def assert_ends_on(found, orbit, tolerance):
    ended = (found.strobe_y[-1], found.strobe_v[-1], found.y_max, found.y_min)
    expected = (orbit.y, orbit.v, orbit.y_max, orbit.y_min)
    assert ended == pytest.approx(expected, abs=tolerance)


def test_a_run_from_rest_ends_on_the_orbit_of_its_own_rotation():
    """Without friction, almost nothing changes the speed of the wheels."""
    case = problem(0.9, "c-material", **SMOOTH, **BOTH)
    found = run(case, 60)
    orbit = general_search.find_orbit(replace(case, initial_state=found.final_state), 21)
    assert orbit.residual < 1e-11
    assert orbit.multiplier_error < 1e-9
    assert abs(orbit.holding_moments[0]) < 1e-7
    assert_ends_on(found, orbit, 1e-8)


def test_under_the_holding_moments_runs_end_on_the_orbit():
    """Torsional damping lets the rotation settle too; without the moments the pair slows down."""
    damped = GeneralTerms(torsional_damping=(0.02, 0.05))
    case = problem(0.9, "c-material", terms=damped, **SMOOTH, **BOTH)
    orbit = general_search.find_orbit(case, 21)
    assert abs(orbit.holding_moments[0]) > 1e-8
    found = run(orbit.held, 80)
    settled = general_search.find_orbit(replace(case, initial_state=found.final_state), 21)
    assert settled.holding_moments == pytest.approx(orbit.holding_moments, rel=1e-2)
    assert_ends_on(found, settled, 1e-8)


@pytest.mark.parametrize("name", ["c-material", "b-material"])
def test_friction_that_sticks_and_slips_has_an_orbit_to_which_displaced_runs_return(name):
    case = problem(0.9, name, eccentricity_3=1.0)
    orbit = general_search.find_orbit(case, 21)
    assert orbit.stable
    assert orbit.multiplier_error < 1e-7
    away = np.full(12, 1e-5)
    away[[0, 6]] = 0.0  # the rotation is held
    begun = state_at_place(case, orbit.start + away)
    assert_ends_on(run(replace(orbit.held, initial_state=begun), 60), orbit, 1e-8)


def test_the_orbit_tends_to_that_without_run_out():
    wavy = {"deviation": ((0.05, 0.0),), **SMOOTH}
    plain = general_search.find_orbit(problem(0.9, "c-material", **wavy))
    off = [
        general_search.find_orbit(problem(0.9, "c-material", eccentricity_3=e, **wavy), 21).y_max
        - plain.y_max
        for e in (1e-6, 1e-3)
    ]
    assert abs(off[0]) < 1e-8
    assert off[1] == pytest.approx(1e3 * off[0], rel=1e-3)


@pytest.mark.parametrize("run_out", [{}, {"eccentricity_3": 1.0, "eccentricity_2": -0.5}])
def test_linear_damping_gives_the_determinant(run_out):
    """Mesh, bearings and damping to the frame shrink volumes, by Liouville's formula."""
    damped = GeneralTerms(torsional_damping=(0.04, 0.01))
    case = problem(0.7, "b-both", teeth=3, terms=damped, **SMOOTH, **run_out)
    orbit = general_search.find_orbit(case, 3 if run_out else 1)
    bearings = 4 if run_out else 1
    bearing = 2.0 * case.bearing_damping_ratio * np.sqrt(case.bearing_stiffness / case.body_mass)
    rate = (1.0 + 2.0 / case.body_mass) * case.material[0] + bearings * bearing + 0.05 / 2.0
    expected = np.exp(-rate * orbit.periods * case.period)
    assert np.linalg.det(orbit.jacobian) == pytest.approx(expected, abs=2e-9)


def test_torsional_damping_alone_lets_the_rotation_drift():
    """More torque on one wheel turns the pair until the damping takes it; y repeats."""
    terms = GeneralTerms(
        torsional_damping=(0.02, 0.1), torque_harmonics_3=(Harmonic(0.0, 0.05, 0.0),)
    )
    case = problem(0.9, "c-material", terms=terms)
    orbit = general_search.find_orbit(case)
    assert orbit.holding_moments == (0.0, 0.0)
    assert orbit.state.size == orbit.multipliers.size == 5
    found = run(case, 60)
    assert_ends_on(found, orbit, 1e-8)
    assert found.rotation_drift > 0.1


def test_frequencies_without_a_common_period_have_no_orbit():
    terms = GeneralTerms(torque_harmonics_3=(Harmonic(0.3141, 0.05, 0.0),))
    with pytest.raises(NoOrbit, match="no common period"):
        general_search.find_orbit(problem(0.9, "c-material", terms=terms), 21)


def test_the_public_function_states_the_holding_moments():
    """Heavy bodies reverse their sliding direction from one revolution to the next."""
    pair = gm.paper().replace(eccentricity="10 um")
    with pytest.raises(NoOrbit, match="after 21 mesh periods"):
        gm.find_orbit(pair, "c-material", 0.9)
    with pytest.raises(NoOrbit, match="after two revolutions only"):
        gm.find_orbit(pair, "c-material", 0.9, periods=21)
    orbit = gm.find_orbit(pair, "c-material", 0.9, periods=42)
    moment_3, moment_2 = orbit.holding_moments
    assert moment_3 == -moment_2 != 0.0
    assert orbit.to_dataset(64).sizes["time"] == 42 * 64
