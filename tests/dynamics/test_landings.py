"""Orbits corrected side by side in the lanes, against the kernel of single motions."""

from dataclasses import replace

import numpy as np
import pytest
from problems import problem

from gearmesh.dynamics.continuation.branches import field_family
from gearmesh.dynamics.continuation.curves import Curve
from gearmesh.dynamics.periodic.orbits import find_orbit
from gearmesh.solvers.reduced.derivatives import curves
from gearmesh.solvers.reduced.derivatives.landings import land
from gearmesh.solvers.reduced.derivatives.period_map import FIXED, passage
from gearmesh.solvers.reduced.derivatives.variational import REGIME

MANY = 100
"""Copies of eleven points that need the lanes, and more than one call of their code."""

LAWS = ["a-conservative", "b-both", "b-lubricant", "c-both", "d-lubricant", "d-both", "h-material"]


@pytest.mark.parametrize("name", LAWS)
def test_a_motion_in_a_lane_is_that_of_the_other_kernel(name):
    """Starts on both flanks and between them, more than there are lanes, at several frequencies."""
    case = problem(0.9, name, backlash=1.0, initial_phase=0.2)
    rng = np.random.default_rng(3)
    states = rng.uniform([-2.0, -0.5, -2.1, -0.1], [1.5, 0.5, -1.9, 0.1], (21, 4))
    frequencies = rng.uniform(0.6, 1.2, 21)
    places = np.column_stack([states, frequencies / 0.25])
    rows = land(case, 2, 0.25, places, FIXED, corrections=0)
    regimes = set()
    for row, state, nu in zip(rows, states, frequencies, strict=True):
        moved = passage(replace(case, nu=nu), state, 2)
        regimes |= set(moved.events[:, REGIME])
        assert row[curves.OUTCOME] == 0
        np.testing.assert_allclose(row[curves.END : curves.JACOBIAN], moved.end, atol=1e-12)
        jacobian = np.column_stack([moved.jacobian, moved.stretched])
        found = row[curves.JACOBIAN : curves.TANGENT].reshape(4, 5)
        np.testing.assert_allclose(found, jacobian, rtol=1e-11, atol=1e-11)
        assert row[curves.DAMPING] == pytest.approx(moved.damping, abs=1e-13)
    assert regimes == {-1.0, 0.0, 1.0}


@pytest.mark.parametrize(
    ("name", "nu", "periods"), [("c-material", 0.9, 1), ("d-lubricant", 0.75, 3)]
)
def test_points_are_those_that_are_corrected_one_by_one(name, nu, periods):
    """Many are corrected in the lanes, the same ones again and again."""
    orbit = find_orbit(problem(nu, name), periods)
    curve = Curve(field_family(orbit.problem, "nu"), periods, (0.5,), 0.0, orbit, stretches=True)
    known = [curve.at(orbit, (nu + away,)) for away in np.linspace(-1e-3, 1e-3, 11)]
    places = np.array([point.place for point in known])
    up = np.eye(5)[4]
    near = np.tile(places + 1e-6 * (1.0 - up), (MANY, 1))
    found = curve.landed(near, up, np.tile(-up, (len(near), 1)))
    for point, one in zip(known * 2, [*found[:11], *found[-11:]], strict=True):
        assert point.values == one.values
        np.testing.assert_allclose(one.place, point.place, atol=1e-13)
        np.testing.assert_allclose(one.tangent, -point.tangent, atol=1e-11)
        assert one.determinant == pytest.approx(-point.determinant, rel=1e-10)
        assert one.motion.y_max == pytest.approx(point.motion.y_max, abs=1e-13)
        assert one.motion.y_min == pytest.approx(point.motion.y_min, abs=1e-13)
        np.testing.assert_allclose(one.motion.extrema, point.motion.extrema, atol=1e-11)
        assert one.orbit.certificate.multiplier_error < 1e-11


def test_a_place_that_leads_to_no_orbit_is_marked():
    """The others need a correction, and none of them is marked."""
    orbit = find_orbit(problem(0.9, "c-material"))
    curve = Curve(field_family(orbit.problem, "nu"), 1, (0.5,), 0.0, orbit, stretches=True)
    up = np.eye(5)[4]
    for count in (9, 11 * MANY):
        places = np.tile(np.append(orbit.state, 1.8), (count, 1))
        near = places + 1e-6 * (1.0 - up)
        near[4, :2] = 1e12, 0.0
        points = curve.landed(near, up, np.tile(up, (count, 1)))
        found, others = np.array([point.place for point in points]), np.arange(count) != 4
        assert np.isnan(found[4]).all()
        np.testing.assert_allclose(found[others], places[others], atol=1e-13)
