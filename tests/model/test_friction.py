"""Friction: eq. (6), its signs and its arms."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.model.friction import (
    arms,
    follows_run_out,
    friction_force,
    mesh_gamma,
    pairs_in_contact,
    pitch_offset,
)
from gearmesh.model.involute import Involute
from gearmesh.model.stiffness import in_double_contact

EPSILON, ALPHA, TEETH = 1.569, math.radians(20.0), 21

phases = st.floats(-2, 2)
contact_ratios = st.floats(1.0, 2.0)


def test_gamma_of_one_pair_along_its_path():
    """0.5, 1, 0, -1, -0.5, from the place where the pair enters to where it leaves."""
    start = -0.5 * (EPSILON - 1.0)
    followed = []
    for since in np.linspace(0.001, EPSILON - 0.001, 400):
        sigma = since - 0.5 * EPSILON
        pairs = pairs_in_contact(start + since, EPSILON)
        [gamma] = [g for g, at in pairs if at == pytest.approx(sigma)]
        followed.append(gamma)
    steps = [followed[0]] + [b for a, b in pairwise(followed) if a != b]
    assert steps == [0.5, 1.0, -1.0, -0.5]
    assert pairs_in_contact(0.5, EPSILON) == [(0.0, 0.0)]


@given(phases, contact_ratios)
def test_gamma_over_all_pairs(phase, contact_ratio):
    pairs = pairs_in_contact(phase, contact_ratio)
    total = mesh_gamma(phase, contact_ratio)
    if in_double_contact(phase, contact_ratio):
        (_, first), (_, second) = pairs
        assert second - first == pytest.approx(1.0)
        assert total == 0.0
    else:
        assert len(pairs) == 1
        assert total == np.sign(0.5 - phase % 1.0)
    assert all(abs(sigma) <= 0.5 * contact_ratio + 1e-12 for _, sigma in pairs)


@given(phases)
def test_arms_are_those_of_the_geometry(phase):
    """Turn each wheel about its centre a little, and see where the point of contact goes."""
    for _, sigma in pairs_in_contact(phase, EPSILON):
        at = np.array([2.0 * math.pi / TEETH * sigma, 0.0])
        centre = np.array([math.tan(ALPHA), 1.0])
        arm_3, arm_2 = arms(sigma, ALPHA, TEETH, TEETH)
        for middle, expected in ((-centre, (1.0, -arm_3)), (centre, (-1.0, arm_2))):
            turn = 1e-6
            to, fro = (rotation(angle) @ (at - middle) + middle for angle in (turn, -turn))
            np.testing.assert_allclose((to - fro) / (2.0 * turn), expected, atol=1e-9)


def rotation(angle):
    """A rotation that moves a point at +z from the centre along +y."""
    return np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])


@given(phases, st.floats(0.01, 5.0))
def test_friction_dissipates_in_normal_mesh_and_drives_in_inverse_mesh(phase, elastic):
    """Steady rotation: wheel 3 turns by +1 and wheel 2 by -1, so the flanks slide along z."""
    for gamma, sigma in pairs_in_contact(phase, EPSILON):
        arm_3, arm_2 = arms(sigma, ALPHA, TEETH, TEETH)
        sliding = -arm_3 + arm_2
        if abs(sliding) < 1e-12:
            continue
        assert friction_force(elastic, 0.1, gamma, 1, 1) * sliding < 0.0
        # As printed: the elastic force of eq. (6) keeps its sign there.
        assert friction_force(-elastic, 0.1, gamma, 1, 1) * sliding > 0.0


@given(phases)
def test_moments_cancel_in_the_sum_and_not_on_each_wheel_in_double_contact(phase):
    force = moment_3 = moment_2 = 0.0
    for gamma, sigma in pairs_in_contact(phase, EPSILON):
        arm_3, arm_2 = arms(sigma, ALPHA, TEETH, TEETH)
        pair_force = friction_force(1.0, 0.1, gamma, 1, 1)
        force += pair_force
        moment_3 -= arm_3 * pair_force
        moment_2 -= arm_2 * pair_force
    assert moment_3 + moment_2 == pytest.approx(-2.0 * math.tan(ALPHA) * force)
    if in_double_contact(phase, EPSILON):
        assert force == 0.0
        assert moment_3 == pytest.approx(-0.05 * 2.0 * math.pi / TEETH)


@pytest.mark.parametrize(
    ("run_out", "slip", "sign"), [(1, 1, -1), (1, -1, 1), (-1, 1, 1), (-1, -1, -1), (1, 0, 0)]
)
def test_both_signs_of_eq_6(run_out, slip, sign):
    assert friction_force(2.0, 0.1, 1.0, run_out, slip) == pytest.approx(0.2 * sign)


def test_the_kronecker_symbol_looks_at_the_sum():
    assert not follows_run_out(0.0, 0.0)
    assert not follows_run_out(2.0, -2.0)
    assert follows_run_out(0.0, 2.0)
    assert follows_run_out(2.0, 2.0)


def test_the_pitch_point_divides_the_path_as_the_tip_circles_do():
    assert pitch_offset(21, 21, ALPHA, EPSILON) == 0.0
    # 20 teeth drive 40: the wheel's teeth reach further on the mesh line than the pinion's.
    path = Involute(1.0, (20, 40), ALPHA).contact_ratio
    offset = pitch_offset(20, 40, ALPHA, path)
    tip, base = 21.0, 20.0 * math.cos(ALPHA)
    approach = math.sqrt(tip**2 - base**2) - 20.0 * math.sin(ALPHA)
    assert 0.5 * path + offset == pytest.approx(approach / (math.pi * math.cos(ALPHA)), abs=1e-12)
    assert pitch_offset(40, 20, ALPHA, path) == pytest.approx(-offset)
