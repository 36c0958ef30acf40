"""Curves of special points in two parameters, against closed forms and branches beside them."""

from dataclasses import replace

import numpy as np
import pytest
from problems import problem

from gearmesh.dynamics.continuation.branches import follow
from gearmesh.dynamics.continuation.special_curves import follow_special
from gearmesh.dynamics.continuation.walks import LIMIT
from gearmesh.dynamics.periodic.orbits import LARGEST_RESIDUAL, find_orbit
from gearmesh.errors import NoOrbit

HEAVY = {"body_mass": 1000.0}
FAR_BODIES = {"body_mass": 1e30, "bearing_stiffness": 1e30, "friction_coefficient": 0.0}


def of_kind(branch, kind):
    return [point for point in branch.special if point.kind == kind]


def test_damping_closes_the_tongue_as_in_closed_form():
    case = problem(0.64, "b-material", material=(0.0, 0.0, 0.0), **FAR_BODIES)

    def family(nu, damping):
        return replace(case, nu=nu, material=(2.0 * damping, 0.0, 0.0))

    flip = of_kind(follow(find_orbit(case), "nu", (0.62, 0.7)), "flip")[0]
    limits = ((0.62, 0.7), (0.0, 0.02))
    curve = follow_special(flip, ("nu", "D"), limits, family=family, values=(flip.nu, 0.0))
    for nu, damping in curve.values:
        period = 2.0 * np.pi / nu
        fast = np.sqrt(case.stiffness_max - damping**2)
        slow = np.sqrt(case.stiffness_min - damping**2)
        a = fast * (case.contact_ratio - 1.0) * period
        b = slow * (2.0 - case.contact_ratio) * period
        trace = 2.0 * np.cos(a) * np.cos(b) - (fast / slow + slow / fast) * np.sin(a) * np.sin(b)
        assert trace + 2.0 * np.cosh(damping * period) == pytest.approx(0.0, abs=1e-9)
    # The curve leaves one edge of the tongue and comes back to the other.
    assert curve.values[:, 1].max() == pytest.approx(0.0089, abs=1e-4)
    assert sorted(curve.values[[0, -1], 0]) == pytest.approx([0.65562, 0.66734], abs=1e-5)


@pytest.fixture(scope="module")
def lubricant():
    case = problem(0.7, "c-lubricant", **HEAVY)
    return case, follow(find_orbit(case), "nu", (0.6, 1.2))


def test_two_folds_meet_in_a_cusp(lubricant):
    case, branch = lubricant
    folds = of_kind(branch, "fold")

    def family(nu, factor):
        return replace(case, nu=nu, lubricant=tuple(factor * k for k in case.lubricant))

    limits = ((0.5, 1.3), (1.0, 30.0))
    curves = [
        follow_special(fold, ("nu", "factor"), limits, family=family, values=(fold.nu, 1.0))
        for fold in folds
    ]
    (first,), (second,) = (curve.cusps for curve in curves)
    assert second.parameters == pytest.approx(first.parameters, abs=1e-8)
    # Just below the cusp the branch has two folds, above it none.
    for factor, count in ((0.98, 2), (1.02, 0)):
        damped = family(0.85, factor * first.parameters["factor"])
        beside = follow(find_orbit(damped), "nu", (0.6, 1.2))
        assert len(of_kind(beside, "fold")) == count
    assert max(orbit.residual for curve in curves for orbit in curve.orbits) < LARGEST_RESIDUAL


@pytest.mark.parametrize("kind", ["grazing_front", "switching"])
def test_a_curve_meets_the_branches_beside_it(kind):
    case = problem(0.62, "c-material", **HEAVY)

    def family(nu, factor):
        return replace(case, nu=nu, material=tuple(factor * k for k in case.material))

    point = of_kind(follow(find_orbit(case), "nu", (0.6, 0.9)), kind)[0]
    limits = ((0.55, 1.0), (0.5, 1.5))
    curve = follow_special(point, ("nu", "factor"), limits, family=family, values=(point.nu, 1.0))
    for end in curve.values[[0, -1]]:
        beside = follow(find_orbit(family(0.62, end[1])), "nu", (0.55, 1.2))
        away = min(abs(other.nu - end[0]) for other in of_kind(beside, kind))
        assert away < 1e-9
    assert curve.ends == (LIMIT, LIMIT)
    assert curve.values[:, 1].min() == pytest.approx(0.5)


def test_fields_of_the_problem_and_what_has_no_curve(lubricant):
    _, branch = lubricant
    grazing = of_kind(branch, "grazing_front")[0]
    curve = follow_special(grazing, ("nu", "stiffness_min"), ((0.7, 0.9), (0.65, 0.8)))
    assert len(curve.values) > 4
    assert np.abs([orbit.y_min for orbit in curve.orbits]).max() < 1e-10
    with pytest.raises(NoOrbit, match="no curve of 'branch_point'"):
        follow_special(replace(grazing, kind="branch_point"), ("nu", "backlash"), ((0, 1), (0, 1)))
