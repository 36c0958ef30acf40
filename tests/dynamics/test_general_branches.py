"""Branches of the general solver: the exact special points of the reduced system, and jumps."""

from dataclasses import replace
from pathlib import Path

import independent
import numpy as np
import pytest
from independent_equations import backlash, relative_motion
from problems import problem

import gearmesh as gm
from gearmesh.dynamics.continuation import branches
from gearmesh.dynamics.continuation.special_curves import follow_special
from gearmesh.dynamics.periodic import general_search, orbits
from gearmesh.dynamics.periodic.general_orbits import shot_from
from gearmesh.errors import NoOrbit
from gearmesh.model.functions import Harmonic
from gearmesh.model.problem import GeneralTerms, State
from gearmesh.model.variants import variant
from gearmesh.solvers.reduced.derivatives.variational import VELOCITY

LIMITS = (0.3845, 0.3862)
RIPPLE = Harmonic(1.0, 0.2, 0.1)
EXAMPLES = Path(__file__).parents[2] / "config" / "examples"


def in_general(orbit):
    """Return an orbit of the reduced system as the general solver finds it."""
    y, v, b, rate = orbit.state
    state = np.array([y - b, b, v - rate, rate])
    return general_search.correct(shot_from(orbit.problem, state, orbit.periods, 0.0))


def special(orbit, limits):
    found = branches.follow(orbit, "nu", limits, longest_step=0.1)
    return [(one.kind, one.nu) for one in found.special]


def test_folds_and_grazings_and_torus_points_are_the_exact_ones():
    """A branch that turns twice within 0.001 and touches the back flanks in between."""
    linear = {"material": (0.01, 0.0, 0.0), "lubricant": (0.01, 0.0, 0.0)}
    case = problem(0.5, "b-material", friction_coefficient=0.0, **linear)
    whole = branches.follow(orbits.find_orbit(case), "nu", (0.3845, 0.5), longest_step=0.1)
    fold = next(one for one in whole.special if one.kind == "fold")
    nearby = min(whole.orbits, key=lambda one: abs(one.y_max - fold.orbit.y_max))
    exact, found = (special(one, LIMITS) for one in (nearby, in_general(nearby)))
    assert {kind for kind, _ in exact} >= {"fold", "torus"}
    assert sorted(kind for kind, _ in found) == sorted(kind for kind, _ in exact)
    for kind, nu in exact:
        # Where a pair of multipliers leaves the circle 1e-8 beside a grazing, its root is hidden.
        within = 1e-7 if kind == "torus" else 1e-10
        assert min(abs(nu - other) for same, other in found if same == kind) < within


def test_flips_are_the_exact_ones():
    orbit = orbits.find_orbit(problem(0.68, "b-lubricant"))
    exact, found = (special(one, (0.67, 0.69)) for one in (orbit, in_general(orbit)))
    assert [kind for kind, _ in exact] == [kind for kind, _ in found] == ["flip", "flip"]
    np.testing.assert_allclose([nu for _, nu in found], [nu for _, nu in exact], atol=1e-10)


@pytest.mark.parametrize("name", ["c-material", "c-lubricant"])
def test_switching_points_are_the_exact_ones(name):
    orbit = orbits.find_orbit(problem(0.66, name))
    exact, found = (special(one, (0.64, 0.67)) for one in (orbit, in_general(orbit)))
    assert [kind for kind, _ in exact] == [kind for kind, _ in found] == ["switching"]
    np.testing.assert_allclose([nu for _, nu in found], [nu for _, nu in exact], atol=1e-10)


def test_a_grazing_behind_which_nothing_damps_is_no_torus(pair):
    """Multipliers by differences are rough there, and contact leaves a pair on the unit circle."""
    orbit = orbits.find_orbit(pair.problem(variant("d-lubricant"), 1.12))
    for one in (orbit, in_general(orbit)):
        found = branches.follow(one, "nu", (1.1, 1.15)).special
        assert [point.kind for point in found] == ["grazing_front"]


def test_switching_points_of_two_wheels_have_a_turning_point_at_a_jump_of_the_stiffness():
    """Wheels of unequal bodies turn y back at a switch of C(t): SciPy stops there, and y rests."""
    case = problem(0.66, "c-material", friction_coefficient=0.0)
    wheel_3, wheel_2 = case.both_wheels
    unequal = replace(case, wheels=(wheel_3, replace(wheel_2, body_mass=2.0 * wheel_2.body_mass)))
    found = branches.follow(general_search.find_orbit(unequal), "nu", (0.6, 0.72), longest_step=0.1)
    (point,) = found.special
    assert point.kind == "switching"
    half = 0.5 * (case.contact_ratio - 1.0)
    rates = [velocity_at(point.orbit, share) for share in (half, 1.0 - half)]
    slopes = np.diff([min(np.abs(one.stiffness_jumps[:, VELOCITY])) for one in found.orbits])
    assert min(np.abs(rates)) < 1e-9
    assert np.abs(slopes / np.diff(found.values)).min() > 0.5  # so nu is right to 1e-8


def velocity_at(orbit, share):
    run = replace(orbit.problem, initial_state=orbit.initial_state)
    end = independent.integrate(run, 1, share=share)
    return relative_motion(run, run.period * share, end.state)[1]


VARYING = {
    "harmonics": {"backlash": 0.91, "terms": GeneralTerms(backlash_harmonics=(RIPPLE,))},
    "centres": {"backlash": 0.44, "terms": GeneralTerms(backlash_follows_centres=True)},
}


@pytest.mark.parametrize("lubricant", [(0.05, 0.05, 0.0), (0.05, 0.0, 0.0)])
@pytest.mark.parametrize("how", VARYING)
def test_the_back_flanks_graze_where_the_gap_closes_and_opens_again(how, lubricant):
    """SciPy comes to y + s(t) = 0 at the time of the extremum, with a rate of 0.

    Where the damping of material and lubricant differs, orbits are singular behind the grazing.
    """
    laws = {"material": (0.05, 0.05, 0.0), "lubricant": lubricant}
    whole = problem(0.955, "c-lubricant", friction_coefficient=0.0, **laws)
    near = State(*orbits.find_orbit(whole).state.tolist())
    begun = general_search.find_orbit(replace(whole, initial_state=near, **VARYING[how]))
    found = branches.follow(begun, "nu", (0.945, 0.97), longest_step=0.1)
    (point,) = (one for one in found.special if one.kind == "grazing_back")
    orbit = point.orbit
    extrema = orbit.gap_extrema
    share = extrema[np.argmin(np.abs(extrema[:, 1])), 0] / orbit.problem.period
    run = replace(orbit.problem, initial_state=orbit.initial_state)
    before, at, after = (gap_at(run, share + away) for away in (-1e-4, 0.0, 1e-4))
    assert abs(at) < 1e-9
    assert abs(after - before) < 1e-9 < before + after - 2.0 * at
    heights = np.array([one.gap_extrema[:, 1].min() for one in found.orbits])
    assert heights[0] < 0.0 < heights[-1]
    assert np.abs(np.diff(heights) / np.diff(found.values)).min() > 1.0  # so nu is right to 1e-8


def gap_at(run, share):
    end = independent.integrate(run, 1, share=share)
    time = run.period * share
    return relative_motion(run, time, end.state)[0] + backlash(run, time, end.state)


def test_a_sweep_jumps_at_the_fold_of_the_branch():
    """Kahraman and Singh's oscillator with a harmonic transmission error and backlash."""
    pair = gm.load(EXAMPLES / "kahraman-singh.yaml").pair
    below = gm.find_orbit(pair, "b-both", 0.82, start=gm.find_orbit(pair, "b-both", 0.65))
    branch = gm.follow(below, "nu", (0.82, 0.83))
    grazing, fold = branch.special
    assert (grazing.kind, fold.kind) == ("grazing_front", "fold")
    assert abs(fold.orbit.multipliers - 1.0).min() < 1e-6
    up = gm.sweep(pair, "b-both", [0.7, 0.82, 0.828, 0.83], direction="up", revolutions=40)
    *_, before, after = up.y_max_rel.values.ravel()
    assert 0.828 < fold.nu < 0.83
    assert after - before > 1.0
    # No motion here reaches the back flanks, so the fold does not depend on the backlash.
    ranges = (0.8, 0.86), (15.0, 25.0)
    curve = follow_special(branch.found.special[1], ("nu", "backlash"), ranges, longest_step=0.5)
    np.testing.assert_allclose(curve.values[:, 0], fold.nu, atol=1e-9)
    assert np.ptp(curve.values[:, 1]) == pytest.approx(10.0)
    last = gm.find_orbit(pair, "b-both", 0.828, start=below)
    assert float(last.to_dataset().y_max_rel) == pytest.approx(before, abs=1e-3)


def test_an_orbit_with_run_out_is_followed_in_the_run_out():
    case = problem(0.9, "c-material", teeth=2, eccentricity_3=1.0, friction_coefficient=0.0)
    begun = general_search.find_orbit(case, 2)
    branch = branches.follow(begun, "eccentricity_3", (0.5, 1.5), longest_step=0.5)
    assert branch.ends == ("limit", "limit")
    alone = general_search.find_orbit(branch.orbits[-1].problem, 2)
    assert alone.problem.eccentricity_3 == 1.5
    assert branch.y_max[-1] == pytest.approx(alone.y_max, abs=1e-9)
    with pytest.raises(NoOrbit, match="a term appears or vanishes"):
        begun.shot(replace(case, eccentricity_3=0.0), begun.state, 2)
