"""Orbits of the general solver, against the exact multipliers of the reduced system and more."""

from dataclasses import replace

import numpy as np
import pytest
from problems import problem

import gearmesh as gm
from gearmesh.dynamics.periodic import general_search, orbits
from gearmesh.dynamics.periodic.charts import state_at_place as state_of
from gearmesh.dynamics.periodic.general_orbits import shot_from
from gearmesh.errors import NoOrbit
from gearmesh.model.functions import Harmonic
from gearmesh.model.problem import GeneralTerms
from gearmesh.solvers.simulation import simulate


@pytest.mark.parametrize(
    ("name", "nu", "periods"),
    [("c-material", 0.9, 1), ("h-both", 1.0, 1), ("c-lubricant", 0.9, 1), ("c-lubricant", 0.66, 2)],
)
def test_multipliers_are_the_exact_ones_of_the_reduced_system(name, nu, periods):
    case = problem(nu, name, body_mass=1000.0)
    exact = orbits.find_orbit(case, periods)
    started = replace(case, initial_state=state_of(case, _general_state(exact)))
    found = general_search.find_orbit(started, periods)
    np.testing.assert_allclose(found.multipliers, exact.multipliers, atol=1e-9)
    assert found.signature == exact.signature
    assert found.y_max == pytest.approx(exact.y_max, abs=1e-11)
    assert (found.stable, found.neutral) == (exact.stable, exact.neutral)
    assert found.multiplier_error < 1e-8


def _general_state(orbit):
    """Return (sum of the rotations, y_3 - y_2) and the rates of an orbit of the reduced system."""
    y, v, b, rate = orbit.state
    return np.array([y - b, b, v - rate, rate])


WAVY = {
    "Fourier stiffness": {"stiffness_harmonics": 5},
    "deviation": {"deviation": ((0.1, 0.0), (0.05, 0.02))},
    "both, and a moment": {
        "stiffness_harmonics": 3,
        "deviation": ((0.05, 0.0),),
        "terms": GeneralTerms(torque_harmonics_3=(Harmonic(1.0, 0.05, 0.0),)),
    },
}


@pytest.mark.parametrize("name", WAVY)
def test_linear_damping_gives_the_product_of_the_multipliers(name):
    """Liouville: the flow shrinks volumes by the damping of the mesh and of the bearings."""
    case = problem(0.7, "b-material", **WAVY[name])
    found = general_search.find_orbit(case)
    assert found.signature == (1,)
    bearing = 2.0 * case.bearing_damping_ratio * np.sqrt(case.bearing_stiffness / case.body_mass)
    rate = (1.0 + 2.0 / case.body_mass) * case.material[0] + bearing
    product = np.prod(found.multipliers)
    assert product.real == pytest.approx(np.exp(-rate * case.period), abs=1e-10)
    assert found.residual < 1e-11


def test_unequal_wheels_have_an_orbit_on_which_runs_end():
    plain = problem(0.9, "c-material")
    light, heavy = plain.both_wheels
    wheels = (replace(light, inertia=1.5), replace(heavy, inertia=3.0, body_mass=40.0))
    case = replace(plain, wheels=wheels)
    found = general_search.find_orbit(case)
    assert found.stable
    assert found.multipliers.shape == (6,)
    [run] = simulate([replace(case, revolutions=60)], estimate_errors=False)
    assert run.strobe_y[-1] == pytest.approx(found.y, abs=1e-8)
    assert run.y_max == pytest.approx(found.y_max, abs=1e-8)
    # A displaced start comes back as the slowest multiplier says.
    values, vectors = np.linalg.eig(found.jacobian)
    slowest = np.abs(values).argmax()
    begun = state_of(case, found.state + 1e-6 * vectors[:, slowest].real)
    [run] = simulate([replace(case, initial_state=begun, revolutions=1)], estimate_errors=False)
    n = np.arange(22)
    expected = (values[slowest] ** n * (vectors[:3, slowest] @ [1.0, 1.0, -1.0])).real
    np.testing.assert_allclose((run.strobe_y - found.y) / 1e-6, expected, atol=1e-3)


def test_what_repeats_after_some_periods_has_no_orbit_of_one():
    moment = GeneralTerms(torque_harmonics_3=(Harmonic(1.0 / 21.0, 0.05, 0.0),))
    case = problem(0.7, "c-material", terms=moment)
    with pytest.raises(NoOrbit, match="after 21 mesh periods"):
        general_search.find_orbit(case)
    found = general_search.find_orbit(case, 21)
    assert found.residual < 1e-11
    [run] = simulate([replace(case, revolutions=60)], estimate_errors=False)
    assert run.y_max == pytest.approx(found.y_max, abs=1e-8)


def test_the_public_function_serves_them():
    pair = gm.paper().replace(stiffness_harmonics=5)
    orbit = gm.find_orbit(pair, "c-material", 0.9)
    found = orbit.to_dataset()
    run = gm.simulate(pair, "c-material", 0.9, revolutions=80)
    assert float(run.y_max_rel) == pytest.approx(float(found.y_max_rel), abs=1e-8)
    assert float(found.y_rel[0]) == float(found.strobe_y_rel)
    nearby = gm.find_orbit(pair, "c-material", 0.91, start=orbit)
    assert nearby.residual < 1e-11


def test_the_back_flanks_are_where_the_backlash_is_at_the_time():
    """The least y lies above -s, and below -s(t)."""
    terms = GeneralTerms(backlash_harmonics=(Harmonic(1.0, 0.5, 0.0),))
    found = general_search.find_orbit(problem(0.9, "b-both", terms=terms, backlash=1.4))
    assert found.y_min > -1.4
    assert found.signature == (1, 0, -1, 0)


def test_newtons_method_comes_back_from_a_trial_that_runs_away():
    """Where the flanks soften, a motion may leave the well: the first full step does."""
    case = problem(0.9, "b-material", terms=GeneralTerms(restoring_3=-0.03))
    begun = shot_from(case, np.array([2.1, 0.0, 0.7, 0.0]), 1, 0.0)
    step = np.linalg.solve(begun.gradient, -begun.defect)
    with pytest.raises(NoOrbit, match="diverged"):
        begun.shot(case, begun.state + step, 1)
    found = general_search.correct(begun)
    settled = general_search.find_orbit(case)
    assert found.y_max == pytest.approx(settled.y_max, abs=1e-10)
    assert found.stable
