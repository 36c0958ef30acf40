"""Branches of orbits and their special points, against closed forms and other ways to them."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from problems import problem
from scipy.optimize import brentq

import gearmesh as gm
from gearmesh.dynamics.continuation.branches import double_period, follow
from gearmesh.dynamics.continuation.walks import CLOSED, HALVED, LIMIT
from gearmesh.dynamics.periodic.orbits import LARGEST_RESIDUAL, correct, find_orbit
from gearmesh.errors import NoOrbit
from gearmesh.model.variants import variant
from gearmesh.solvers.reduced.derivatives.variational import KIND, SWITCH, VELOCITY

HEAVY = {"body_mass": 1000.0}
FAR_BODIES = {"body_mass": 1e30, "bearing_stiffness": 1e30, "friction_coefficient": 0.0}


def places(branch, *kinds):
    return [point.nu for point in branch.special if point.kind in kinds]


@pytest.fixture(scope="module")
def lubricant():
    """c-lubricant from end to end: in contact, through a grazing, and around two folds."""
    return follow(find_orbit(problem(0.7, "c-lubricant", **HEAVY)), "nu", (0.6, 1.2))


def test_a_branch_in_contact_has_the_flips_of_its_tongue_and_one_switching_point():
    """Without damping, y rests at 1/C_min if the pulse of C_max lasts half an oscillation."""
    begun = problem(0.64, **FAR_BODIES)
    branch = follow(find_orbit(begun), "nu", (0.62, 0.7))
    assert [point.kind for point in branch.special] == ["switching", "flip", "flip"]
    expected = (begun.contact_ratio - 1.0) * np.sqrt(begun.stiffness_max)
    assert branch.special[0].nu == pytest.approx(expected, abs=1e-9)


def test_no_pair_of_special_points_hides_between_two_steps():
    """The whole tongue is shorter than this step."""
    orbit = find_orbit(problem(0.64, **FAR_BODIES))
    branch = follow(orbit, "nu", (0.6, 0.75), longest_step=0.5)
    assert len(branch.values) < 12
    assert len(places(branch, "flip")) == 2


def test_a_grazing_is_where_the_least_y_is_zero():
    case = problem(0.8, "c-material", **HEAVY)
    branch = follow(find_orbit(problem(0.7, "c-material", **HEAVY)), "nu", (0.6, 1.2))

    def least(nu):
        return find_orbit(replace(case, nu=nu)).y_min

    expected = [brentq(least, 0.8, 0.85, xtol=1e-12), brentq(least, 1.06, 1.1, xtol=1e-12)]
    assert places(branch, "grazing_front") == pytest.approx(expected, abs=1e-9)
    for point in branch.special:
        assert point.orbit.residual < LARGEST_RESIDUAL


def test_a_switching_point_is_where_an_extremum_meets_a_switch():
    case = problem(0.62, "c-material", **HEAVY)
    branch = follow(find_orbit(case), "nu", (0.6, 0.7))
    (point,) = branch.special
    assert point.kind == "switching"

    def slowest(nu):
        events = find_orbit(replace(case, nu=nu)).passage.events
        speeds = events[events[:, KIND] == SWITCH][:, VELOCITY]
        return speeds[np.argmin(np.abs(speeds))]

    assert point.nu == pytest.approx(brentq(slowest, 0.635, 0.642, xtol=1e-12), abs=1e-9)
    counts = [len(find_orbit(replace(case, nu=point.nu + side)).extrema) for side in (-1e-4, 1e-4)]
    assert counts[0] == counts[1] + 2


def test_the_branch_goes_through_grazings_and_around_folds(lubricant):
    kinds = [point.kind for point in lubricant.special]
    around = ["grazing_front", "fold", "fold", "grazing_front"]
    assert kinds == ["switching", "flip", "flip", *around]
    assert lubricant.ends == (LIMIT, LIMIT)
    assert lubricant.values[[0, -1]] == pytest.approx([0.6, 1.2])
    for point in lubricant.special:
        if point.kind == "fold":
            assert np.abs(point.orbit.multipliers - 1.0).min() < 1e-6
    # Three orbits coexist between the folds.
    fold, lower = places(lubricant, "fold")
    middle = 0.5 * (places(lubricant, "grazing_front")[0] + lower)
    sides = np.sign(lubricant.values - middle)
    assert np.sum(sides[1:] != sides[:-1]) == 3
    assert lower < middle < fold


def test_unstable_between_the_folds_and_in_the_tongue(lubricant):
    flips, folds = places(lubricant, "flip"), places(lubricant, "fold")
    turns = np.nonzero(np.diff(np.sign(np.diff(lubricant.values))))[0] + 1
    assert len(turns) == 2
    between = slice(turns[0] + 1, turns[1])
    assert not lubricant.stable[between].any()
    assert lubricant.stable[turns[1] + 1 : turns[1] + 5].all()
    before = np.arange(len(lubricant.values)) < turns[0]
    inside = (lubricant.values > flips[0]) & (lubricant.values < flips[1]) & before
    assert inside.any()
    assert not lubricant.neutral[inside].any()
    contact = before & ~inside & (lubricant.values < places(lubricant, "grazing_front")[0])
    assert lubricant.neutral[contact].all()
    assert folds[1] < folds[0]


@pytest.mark.parametrize(("nu", "phase", "step"), [(1.15, 0.2845, 0.04), (0.62, 0.6, 0.02)])
def test_special_points_depend_on_neither_start_nor_phase_nor_steps(lubricant, nu, phase, step):
    orbit = find_orbit(problem(nu, "c-lubricant", initial_phase=phase, **HEAVY))
    branch = follow(orbit, "nu", (0.6, 1.2), longest_step=step)
    assert [point.kind for point in branch.special] == [point.kind for point in lubricant.special]
    for point, other in zip(branch.special, lubricant.special, strict=True):
        assert point.nu == pytest.approx(other.nu, abs=1e-9)
        assert point.orbit.y_max == pytest.approx(other.orbit.y_max, abs=1e-6)


def test_the_period_doubles_at_a_flip(lubricant):
    flip = next(point for point in lubricant.special if point.kind == "flip")
    doubled, _ = double_period(flip)
    assert doubled.periods == 2
    assert doubled.residual < LARGEST_RESIDUAL
    branch = follow(doubled, "nu", (0.6, 0.7))
    # The branch starts upright, and yet its ends have a fixed order.
    assert branch.ends == (LIMIT, HALVED)
    # It meets the branch of half its period at a flip of that, and only there.
    ends = [point for point in branch.special if point.orbit.periods == 1]
    assert {point.kind for point in ends} == {"flip"}
    found = min(ends, key=lambda point: abs(point.nu - flip.nu))
    assert found.nu == pytest.approx(flip.nu, abs=1e-9)


def test_the_period_doubles_again():
    orbit = find_orbit(problem(0.66, "c-lubricant", **HEAVY), 2)
    branch = follow(orbit, "nu", (0.63, 0.67))
    flip = next(p for p in branch.special if p.kind == "flip" and p.orbit.periods == 2)
    doubled, _ = double_period(flip)
    assert doubled.periods == 4
    assert find_orbit(doubled.problem, 4, start=doubled.state).residual < LARGEST_RESIDUAL
    assert branch.ends.count(HALVED) == 1


def test_any_parameter_and_any_family():
    """The grazing in damping is the one in frequency; a family may move several fields."""
    case = problem(0.79, "c-material", **HEAVY)
    by_nu = follow(find_orbit(case), "nu", (0.75, 0.9))
    (grazing,) = [point for point in by_nu.special if point.kind == "grazing_front"]
    fixed = replace(case, nu=grazing.nu)

    def family(share):
        k1, k2, k3 = case.material
        return replace(fixed, material=(share * k1, share * k2, share * k3))

    start = find_orbit(family(1.5))
    by_damping = follow(start, "damping", (0.8, 2.0), family=family, value=1.5)
    (point,) = [point for point in by_damping.special if point.kind == "grazing_front"]
    assert point.parameters["damping"] == pytest.approx(1.0, abs=1e-8)
    assert point.nu == grazing.nu


def test_a_backlash_that_shrinks_brings_the_back_flank():
    orbit = find_orbit(problem(1.0, "c-lubricant", **HEAVY))
    branch = follow(orbit, "backlash", (0.58, 4.0))
    (point,) = [point for point in branch.special if point.kind == "grazing_back"]
    assert point.parameters["backlash"] == pytest.approx(-orbit.y_min, abs=1e-9)


def test_a_start_outside_the_range_is_said():
    orbit = find_orbit(problem(0.7, "c-material", **HEAVY))
    with pytest.raises(NoOrbit, match="outside"):
        follow(orbit, "nu", (0.8, 1.2))
    assert CLOSED not in follow(orbit, "nu", (0.69, 0.71)).ends


ISOLAS = [
    (
        "d-lubricant",
        0.785,
        [1.5657076, 0.483173535, -1.99885662, 9.83725519e-04],
        4,
        {"fold": 2, "grazing_front": 4},
    ),
    (
        "c-lubricant",
        0.635,
        [2.02224615, -0.633408858, -1.99688967, -1.22484934e-03],
        6,
        {"fold": 2, "grazing_front": 6},
    ),
]
"""Variant, nu_s, a state, number of periods, and how many special points there are of each kind.

The isola of d-lubricant has another orbit 5e-4 away; that of c-lubricant grazes in pairs.
"""


@pytest.mark.parametrize(("name", "nu", "state", "periods", "kinds"), ISOLAS)
def test_an_isola_is_the_same_from_each_of_its_mesh_periods(name, nu, state, periods, kinds):
    orbit = correct(gm.paper().problem(variant(name), nu), np.array(state), periods)
    found, heights = [], []
    for start in orbit.points:
        branch = follow(correct(orbit.problem, start, periods), "nu", (0.6, 1.2))
        assert branch.ends == (CLOSED, CLOSED)
        found.append(sorted((point.kind, point.nu) for point in branch.special))
        low, high = sorted(place for kind, place in found[-1] if kind == "fold")
        there = branch.resampled(high - (high - low) * np.logspace(-5, -0.1, 20))
        heights.append(sorted(zip(there.values, there.y_max, strict=True)))
    assert Counter(kind for kind, _ in found[0]) == kinds
    for other in found[1:]:
        assert [kind for kind, _ in other] == [kind for kind, _ in found[0]]
        assert [nu for _, nu in other] == pytest.approx([nu for _, nu in found[0]], abs=1e-10)
    for other in heights:
        assert len(other) == 40
        np.testing.assert_allclose(other, heights[0], atol=1e-8, rtol=0)


@pytest.mark.parametrize(("name", "nu", "state", "periods", "kinds"), ISOLAS)
def test_an_isola_is_the_same_from_each_of_its_special_points(name, nu, state, periods, kinds):
    """At a fold nu does not fix the orbit, and is not passed a second time."""
    orbit = correct(gm.paper().problem(variant(name), nu), np.array(state), periods)
    branch = follow(orbit, "nu", (0.6, 1.2))
    expected = sorted((point.kind, point.nu) for point in branch.special)
    for begun in branch.special:
        other = follow(begun.orbit, "nu", (0.6, 1.2))
        assert other.ends == (CLOSED, CLOSED)
        assert other.values[0] == other.values[-1]
        found = sorted((point.kind, point.nu) for point in other.special)
        assert [kind for kind, _ in found] == [kind for kind, _ in expected]
        assert [at for _, at in found] == pytest.approx([at for _, at in expected], abs=1e-10)


def test_an_open_branch_is_the_same_from_each_of_its_special_points(lubricant):
    assert len({point.kind for point in lubricant.special}) == 4
    for begun in lubricant.special:
        other = follow(begun.orbit, "nu", (0.6, 1.2))
        assert other.ends == (LIMIT, LIMIT)
        kinds = [point.kind for point in lubricant.special]
        assert [point.kind for point in other.special] == kinds
        places = [point.nu for point in lubricant.special]
        assert [point.nu for point in other.special] == pytest.approx(places, abs=1e-10)
