"""Attractors, basins and exponents of pairs that only the general solver serves."""

from dataclasses import replace

import numpy as np
import pytest
from problems import problem

from gearmesh.dynamics.attraction.basins import basins, reached
from gearmesh.dynamics.attraction.kinds import NEUTRAL, PERIODIC
from gearmesh.dynamics.attraction.lyapunov import lyapunov_spectrum
from gearmesh.dynamics.attraction.maps import map_of
from gearmesh.dynamics.periodic import general_search
from gearmesh.model.functions import Harmonic
from gearmesh.model.motion import state_at
from gearmesh.model.problem import GeneralTerms
from gearmesh.solvers.simulation import simulate

SMOOTH = {"friction_coefficient": 0.0}
ONCE_A_TURN = GeneralTerms(torque_harmonics_3=(Harmonic(1.0 / 21.0, 0.05, 0.02),))


def unequal(case):
    """Return a pair of unequal wheels whose mesh moves as that of the equal wheels of `case`.

    Without friction only m_red matters of the inertia: 1/1.5 + 1/3 = 1.
    """
    wheel_3, wheel_2 = case.both_wheels
    return replace(case, wheels=(replace(wheel_3, inertia=1.5), replace(wheel_2, inertia=3.0)))


def test_basins_of_unequal_wheels_are_those_of_equal_ones():
    """b-both between its folds: two stable orbits."""
    equal = problem(0.75, "b-both", body_mass=1000.0, **SMOOTH)
    heights, rates, phases = np.linspace(-2.0, 4.0, 3), np.linspace(-3.0, 3.0, 3), [0.0, 0.35]
    expected, found = (basins(one, heights, rates, phases) for one in (equal, unequal(equal)))
    assert len(expected.attractors) == 2
    np.testing.assert_array_equal(found.labels, expected.labels)
    np.testing.assert_array_equal(found.shares, expected.shares)
    for one, other in zip(found.attractors, expected.attractors, strict=True):
        assert one.label == other.label
        assert one.y_max == pytest.approx(other.y_max, abs=1e-10)
        assert one.time_constant == pytest.approx(other.time_constant, rel=1e-7)


@pytest.mark.parametrize("name", ["b-both", "c-lubricant"])
def test_exponents_of_unequal_wheels_are_those_of_equal_ones(name):
    """The coordinates are y, y', b, b' of the reduced system, so both agree at any time."""
    case = problem(0.9, name, **SMOOTH)
    expected = lyapunov_spectrum(case, np.array([2.0, 0.5, -2.0, 0.0]), 60, 20)
    other = unequal(case)
    moved = map_of(other)
    begun = state_at(other, 2.0, 0.5)
    found = lyapunov_spectrum(other, moved.start(replace(other, initial_state=begun)), 60, 20)
    np.testing.assert_allclose(found.exponents, expected.exponents, atol=1e-9)
    np.testing.assert_allclose(moved.coordinates(found.end[None])[0], expected.end, atol=1e-8)


def test_exponents_of_a_linear_pair_are_its_decay_rates():
    """Constant stiffness and strong linear damping: y'' + 2.2 y' + y = 1 on bodies that rest."""
    stiff = {"stiffness_max": 1.0, "stiffness_min": 1.0, "body_mass": 1e12}
    case = unequal(problem(0.9, material=(2.2, 0.0, 0.0), backlash=1e9, **stiff, **SMOOTH))
    found = lyapunov_spectrum(case, map_of(case).start(case), 20, 20).exponents
    np.testing.assert_allclose(found[:2], 0.0, atol=1e-6)
    np.testing.assert_allclose(found[2:], -1.1 + np.sqrt(0.21) * np.array([1.0, -1.0]), atol=1e-8)


def test_the_sum_of_the_exponents_is_what_damping_takes():
    """Mesh, bearings and damping to the frame, through contact loss, with varying torque."""
    terms = replace(ONCE_A_TURN, torsional_damping=(0.04, 0.01))
    case = unequal(problem(0.9, "b-both", backlash=1.0, terms=terms, **SMOOTH))
    found = lyapunov_spectrum(case, map_of(case).start(case), 42, 0)
    bearing = 2.0 * case.bearing_damping_ratio * np.sqrt(case.bearing_stiffness / case.body_mass)
    rate = (1.0 + 2.0 / case.body_mass) * case.material[0] + bearing + 0.04 / 1.5 + 0.01 / 3.0
    assert found.exponents.size == 5
    assert found.exponents.sum() == pytest.approx(-rate, abs=5e-9)


def test_with_run_out_runs_end_on_the_orbit_that_the_drive_holds():
    case = problem(0.9, "c-material", eccentricity_3=1.0, eccentricity_2=0.5, **SMOOTH)
    moved = map_of(case)
    found = reached(case, moved.starts(np.array([0.0, 3.0]), np.array([1.0]), [0.0, 0.4]))
    [attractor] = found.attractors
    orbit = general_search.find_orbit(case, 21)
    assert (attractor.kind, attractor.orbit.periods) == (PERIODIC, 21)
    assert attractor.y_max == pytest.approx(orbit.y_max, abs=1e-9)
    assert attractor.time_constant == pytest.approx(-21.0 / np.log(abs(orbit.multipliers[0])))
    spectrum = lyapunov_spectrum(case, moved.state_of(attractor.orbit), 42, 0)
    volume = np.log(np.abs(np.linalg.det(orbit.monodromy))) / (21 * case.period)
    assert spectrum.exponents.sum() == pytest.approx(volume, abs=1e-6)


def test_an_attractor_of_several_periods_has_one_label_at_all_phases():
    """A start at another phase begins in the mesh period of t = 0, as a run does."""
    case = problem(0.9, "b-material", terms=ONCE_A_TURN, initial_phase=0.7)
    moved = map_of(case)
    found = reached(case, moved.starts(np.array([1.0]), np.array([0.0]), [0.0, 0.7, 0.9]))
    [attractor] = found.attractors
    orbit = attractor.orbit.at_phase(0.2)
    assert orbit.residual < 1e-10
    assert orbit.y_max == pytest.approx(attractor.y_max, abs=1e-9)
    [run] = simulate([replace(case, revolutions=80, initial_phase=0.2)], estimate_errors=False)
    assert run.strobe_y[-1] == pytest.approx(orbit.y, abs=1e-7)
    there = replace(case, initial_phase=0.2)
    again = reached(there, map_of(there).starts(np.array([1.0]), np.array([0.0]), [0.2]))
    assert again.attractors[0].label == attractor.label


def test_motion_that_only_the_bearings_damp_is_neutral():
    terms = GeneralTerms(torque_harmonics_3=(Harmonic(1.0, 0.02, 0.0),))
    case = problem(0.7, "c-lubricant", terms=terms)
    found = reached(case, map_of(case).start(case)[None])
    assert [one.kind for one in found.attractors] == [NEUTRAL]
