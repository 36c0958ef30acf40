"""Lyapunov exponents against multipliers, Liouville's formula and the definition."""

import numpy as np
import pytest
from problems import problem

from gearmesh.dynamics.attraction.lyapunov import lyapunov_spectrum
from gearmesh.dynamics.periodic.orbits import find_orbit
from gearmesh.errors import NoOrbit
from gearmesh.solvers.reduced.derivatives.period_map import passage

HEAVY = {"body_mass": 1000.0}
REST = (1.0, 0.0, -2.0, 0.0)


@pytest.mark.parametrize(
    ("name", "nu", "periods"),
    [("d-lubricant", 0.81, 1), ("c-material", 0.9, 1), ("c-lubricant", 0.66, 2)],
)
def test_of_an_orbit_they_are_those_of_its_multipliers(name, nu, periods):
    orbit = find_orbit(problem(nu, name, **HEAVY), periods)
    spectrum = lyapunov_spectrum(orbit.problem, orbit.state, 1200)
    expected = np.log(np.abs(orbit.multipliers)) / (periods * orbit.problem.period)
    # Complex multipliers turn the frame: their rates fluctuate and average out with 1/time.
    np.testing.assert_allclose(spectrum.exponents, expected, atol=1e-3)


def test_their_sum_is_what_damping_takes():
    case = problem(0.9, "b-both", backlash=1.0)
    spectrum = lyapunov_spectrum(case, np.array(REST), 300, transient=0)
    taken = passage(case, REST, 300).log_determinant
    assert spectrum.exponents.sum() * 300 * case.period == pytest.approx(taken, rel=1e-9)


def test_chaos_grows_as_fast_as_two_runs_part():
    """Two runs, 1e-7 apart, brought together again after every mesh period."""
    case = problem(1.0, "a-conservative", **HEAVY)
    start = np.array([3.5, 2.0, -2.0, 0.0])
    spectrum = lyapunov_spectrum(case, start, 1000, transient=100)
    # This motion is regular for hundreds of periods at a time, so rounding decides how large the
    # exponent is: between 4 and 23 standard errors for starts that differ by 1e-7. The test asks
    # for 3, the same as the test of regular motion below.
    assert spectrum.exponents[0] > 3.0 * spectrum.errors[0] > 0.0
    # Without mesh damping the mesh alone keeps areas: its two exponents cancel.
    assert spectrum.exponents[[0, -1]].sum() == pytest.approx(0.0, abs=1e-4)
    assert passage(case, start, 1100).damping == 0.0
    state, away, grown = start, np.array([1e-7, 0.0, 0.0, 0.0]), []
    for _ in range(1100):
        end = passage(case, state).end
        apart = passage(case, state + away).end - end
        grown.append(np.log(np.linalg.norm(apart) / 1e-7) / case.period)
        state, away = end, 1e-7 * apart / np.linalg.norm(apart)
    assert np.mean(grown[100:]) == pytest.approx(spectrum.exponents[0], rel=1e-3)


def test_regular_motion_without_damping_does_not_grow():
    spectrum = lyapunov_spectrum(problem(1.0, "a-conservative", **HEAVY), np.array(REST), 4000)
    assert spectrum.exponents[0] < 3.0 * spectrum.errors[0] + 1e-5


def test_a_motion_that_runs_away_has_none():
    case = problem(0.7, material=(-50.0, 0.0, 0.0), backlash=1e12)
    with pytest.raises(NoOrbit, match="diverged"):
        lyapunov_spectrum(case, np.array(REST), 100)
