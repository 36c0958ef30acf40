"""Branches of the general solver: the exact special points of the reduced system, and jumps."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from problems import problem

import gearmesh as gm
from gearmesh.dynamics import branches, general_search, orbits
from gearmesh.dynamics.general_orbits import shot_from
from gearmesh.dynamics.special_curves import follow_special
from gearmesh.errors import NoOrbit

LIMITS = (0.3845, 0.3862)
EXAMPLES = Path(__file__).parents[2] / "config" / "examples"


def in_general(orbit):
    """Return an orbit of the reduced system as the general solver finds it."""
    y, v, b, rate = orbit.state
    state = np.array([y - b, b, v - rate, rate])
    return general_search.correct(shot_from(orbit.problem, state, orbit.periods, 0.0))


def special(orbit, limits):
    found = branches.follow(orbit, "nu", limits, longest_step=0.1)
    return [(one.kind, one.nu) for one in found.special if one.kind != "switching"]


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
