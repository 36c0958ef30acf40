"""Pairs of teeth on their paths, the segments of a mesh period, and the stiffness between them."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from problems import problem

from gearmesh.model import mesh, stiffness
from gearmesh.model.friction import arms, holding_force, mesh_gamma, pairs_in_contact, pitch_offset
from gearmesh.model.problem import GeneralTerms, ToothFactor, Wheel
from gearmesh.model.segments import pitch_offset_of, segments

SMOOTH = problem(friction_coefficient=0.0, stiffness_harmonics=3)
TABLE = ((0.0, 1.2), (0.25, 0.8), (0.25, 1.1), (0.7, 0.9), (1.0, 1.2))
WHEELS = (
    Wheel(20, 60.0, 1.5, 30.0, (1.0, 1.0), (0.03, 0.03)),
    Wheel(41, 123.0, 3.0, 50.0, (1.0, 1.0), (0.03, 0.03)),
)


@pytest.mark.parametrize("contact_ratio", [1.0, 1.3, 1.569, 2.0, 2.4, 3.0])
def test_a_pair_touches_within_half_its_path_around_its_middle(contact_ratio):
    for phase in np.arange(-2.99, 3.0, 0.0371):
        touching = stiffness.touching_pairs(phase, contact_ratio)
        expected = [p for p in range(5, -6, -1) if abs(phase - p - 0.5) < 0.5 * contact_ratio]
        assert [pair.number for pair in touching] == expected
        for pair in touching:
            assert pair.place == pytest.approx(phase - pair.number - 0.5)


def test_where_one_pair_follows_the_other_at_once_the_next_one_touches():
    for phase in (-1.0, 0.0, 2.0):
        assert stiffness.touching_pairs(phase, 1.0) == [(phase, -0.5)]
    # Between these limits, two pairs touch at the ends of their paths, for no time at all.
    assert stiffness.touching_pairs(0.25, 1.5) == [(0, -0.25)]
    assert stiffness.touching_pairs(-0.25, 1.5) == [(-1, 0.25)]
    assert stiffness.touching_pairs(0.5, 2.0) == [(0, 0.0)]


def test_places_at_equal_distances_along_a_path():
    assert stiffness.path_places(1.6, 5) == pytest.approx([-0.3, 0.1, 0.5, 0.9, 1.3], abs=1e-15)
    assert stiffness.path_places(1.6, 0) == []


def test_a_line_through_knots():
    assert stiffness.line_through(TABLE, 0.125) == pytest.approx((1.0, -1.6))
    assert stiffness.line_through(TABLE, 0.0) == pytest.approx((1.2, -1.6))
    # At a jump the first of the two values belongs to the segment that ends.
    assert stiffness.line_through(TABLE, 0.25) == pytest.approx((0.8, -1.6))
    assert stiffness.line_through(TABLE, 0.85) == pytest.approx((1.05, 1.0))
    assert stiffness.line_through(TABLE, 1.0) == pytest.approx((1.2, 1.0))
    for outside in (-0.001, 1.001):
        with pytest.raises(ValueError, match="outside the table"):
            stiffness.line_through(TABLE, outside)


def test_the_phase_counts_mesh_periods_and_distances_are_taken_to_the_nearest_one():
    assert mesh.mesh_phase(problem(nu=0.8), 3.5 * 2.0 * math.pi / 0.8) == pytest.approx(3.5)
    assert mesh.since(7.3, 0.2) == pytest.approx(0.1)
    assert mesh.since(-0.1, 2.0) == pytest.approx(-0.1)


def test_the_side_of_a_jump_is_that_of_the_segment():
    fall = 0.5 * 0.569
    one = problem()
    assert mesh.mesh_stiffness(one, fall, 0.1) == one.stiffness_max
    assert mesh.mesh_stiffness(one, fall, 0.4) == one.stiffness_min
    assert mesh.mesh_stiffness(one, 0.1) == one.stiffness_max
    assert mesh.mesh_stiffness(one, 2.4) == one.stiffness_min
    table = replace(SMOOTH, stiffness_harmonics=0, terms=GeneralTerms(stiffness_table=TABLE))
    assert mesh.mesh_stiffness(table, 3.25, 0.2) == pytest.approx(0.8)
    assert mesh.mesh_stiffness(table, 3.25, 1.3) == pytest.approx(1.1)
    assert mesh.mesh_stiffness(table, 3.15) == pytest.approx(0.96)


def test_the_stiffness_of_a_series_is_its_sum():
    both = replace(SMOOTH, terms=GeneralTerms(stiffness_fourier=((0.1, -0.2), (0.0, 0.3))))
    jump = both.stiffness_max - both.stiffness_min
    for phase in (0.0, 0.13, 0.77, 2.4):
        turned = 2.0 * math.pi * phase
        expected = 0.569 * both.stiffness_max + 0.431 * both.stiffness_min
        for n in (1, 2, 3):
            amplitude = 2.0 * jump * math.sin(n * math.pi * 0.569) / (n * math.pi)
            expected += amplitude * math.cos(n * turned)
        expected += 0.1 * math.cos(turned) - 0.2 * math.sin(turned) + 0.3 * math.sin(2.0 * turned)
        assert mesh.mesh_stiffness(both, phase) == pytest.approx(expected, rel=1e-12)
    orders = [harmonic.order for harmonic in mesh.stiffness_harmonics(both)]
    assert orders == [1, 2, 3, 1, 2]
    assert [*mesh.stiffness_harmonics(problem())] == []


def test_factors_of_single_teeth():
    """Tooth 0 of either wheel is in single contact at t = T / 2, and comes back with its wheel."""
    factors = (ToothFactor(3, 2, 0.5), ToothFactor(2, 3, 0.2))
    one = problem(wheels=WHEELS, teeth=20, terms=GeneralTerms(tooth_factors=factors))
    low, high = one.stiffness_min, one.stiffness_max
    for single, factor in ((2, 0.5), (3, 0.2), (22, 0.5), (44, 0.2), (23, 1.0), (42, 0.5)):
        assert mesh.mesh_stiffness(one, single + 0.5) == pytest.approx(low * factor)
    # In double contact each pair bears half of it.
    for double, share in ((2, 0.75), (3, 0.5 * (0.5 + 0.2)), (4, 0.6), (5, 1.0)):
        assert mesh.mesh_stiffness(one, float(double)) == pytest.approx(high * share)
    # 20 and 41 teeth meet again after 820 periods: pair 782 has both of them.
    assert 782 % 20 == 2 and 782 % 41 == 3
    assert mesh.mesh_stiffness(one, 782.5) == pytest.approx(low * 0.1)


def test_the_stiffness_of_pairs_of_teeth_is_added_up():
    values = (0.2, 0.8, 0.6)
    terms = GeneralTerms(tooth_pair_stiffness=values, tooth_factors=(ToothFactor(3, 1, 0.5),))
    one = problem(contact_ratio=1.6, terms=terms)
    for phase in (0.1, 0.45, 0.9, 1.1, 1.62, 2.2):
        expected = 0.0
        for p in range(-2, 4):
            place = (phase - p - 0.5) / 0.8  # -1 to 1 along the path
            if abs(place) < 1.0:
                expected += np.interp(place, (-1, 0, 1), values) * (0.5 if p == 1 else 1.0)
        assert mesh.mesh_stiffness(one, phase) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("one", "edges"),
    [
        (problem(), [0.2845, 0.5, 0.7155]),
        (problem(initial_phase=0.3), [0.2, 0.4155, 0.9845]),
        (problem(friction_coefficient=0.0), [0.2845, 0.7155]),
        (problem(stiffness_harmonics=3), [0.2845, 0.5, 0.7155]),
        (SMOOTH, []),
        (replace(SMOOTH, terms=GeneralTerms(tooth_factors=(ToothFactor(3, 0, 0.5),))),
         [0.2845, 0.7155]),
        (replace(SMOOTH, stiffness_harmonics=0, terms=GeneralTerms(stiffness_table=TABLE)),
         [0.25, 0.7]),
        (replace(SMOOTH, stiffness_harmonics=0,
                 terms=GeneralTerms(stiffness_fourier=((0.1, 0.0),))), []),
        (problem(friction_coefficient=0.0, contact_ratio=1.6,
                 terms=GeneralTerms(tooth_pair_stiffness=(0.2, 0.8, 0.6))), [0.3, 0.5, 0.7]),
        (problem(contact_ratio=1.6, terms=GeneralTerms(tooth_pair_stiffness=(0.2,) * 5)),
         [0.1, 0.3, 0.5, 0.7, 0.9]),
    ],
)  # fmt: skip
def test_a_mesh_period_is_cut_where_a_law_jumps_or_has_a_kink(one, edges):
    parts = segments(one)
    assert [part.start for part in parts] == pytest.approx([0.0, *edges])
    assert [part.end for part in parts] == pytest.approx([*edges, 1.0])
    for part in parts:
        assert part.length == part.end - part.start > 0.0
        assert part.middle == pytest.approx((0.5 * (part.start + part.end) + one.initial_phase) % 1)
        pairs = pairs_in_contact(part.middle, one.contact_ratio)
        assert part.pairs == tuple(pairs)
        assert part.double == (len(pairs) == 2)
        assert part.gamma == sum(pair.gamma for pair in pairs)


def test_gamma_of_the_segments_of_the_paper():
    assert [part.gamma for part in segments(problem())] == [0.0, 1.0, -1.0, 0.0]
    assert [part.double for part in segments(problem())] == [True, False, False, True]
    later = segments(problem(initial_phase=0.3))
    assert [part.gamma for part in later] == [1.0, -1.0, 0.0, 1.0]
    assert [part.middle for part in later] == pytest.approx([0.4, 0.60775, 0.0, 0.29225])


def test_the_pitch_point_of_unequal_wheels_moves_the_change_of_gamma():
    one = problem(wheels=WHEELS, teeth=20)
    offset = pitch_offset_of(one)
    assert offset == pitch_offset(20, 41, one.pressure_angle, 1.569) != 0.0
    assert pitch_offset_of(problem()) == 0.0
    edges = [part.start for part in segments(one)]
    assert any(edge == pytest.approx(0.5 + offset) for edge in edges)
    for part, following in pairwise(segments(one)):
        if following.start == pytest.approx(0.5 + offset):
            assert part.gamma > 0.0 > following.gamma
    # The pitch point may also be in double contact: the gammas of both pairs have the same sign.
    found = pairs_in_contact(0.1, 1.569, 0.45)
    assert [pair.gamma for pair in found] == [0.5, -0.5]
    assert [pair.sigma for pair in found] == pytest.approx([-0.85, 0.15])
    assert mesh_gamma(0.1, 1.569, 0.7) == 1.0
    assert mesh_gamma(0.4, 1.569) == 1.0
    assert mesh_gamma(0.5, 1.569) == 0.0


def test_a_path_of_contact_ends_at_the_base_circles():
    """At 5 degrees the tips of the larger wheel reach past the end of the mesh line."""
    angle, ratio = math.radians(5.0), 1.4
    tip, base, pitch = 21.0, 20.0 * math.cos(angle), 20.0
    beyond = math.sqrt(tip**2 - base**2) - pitch * math.sin(angle)
    assert beyond > 6.0 * math.sin(angle)
    approach, recess = 6.0 * math.sin(angle), 20.0 * math.sin(angle)
    assert recess < math.sqrt(7.0**2 - (6.0 * math.cos(angle)) ** 2) - 6.0 * math.sin(angle)
    expected = ratio * (approach / (approach + recess) - 0.5)
    assert pitch_offset(12, 40, angle, ratio) == pytest.approx(expected, rel=1e-13)
    assert pitch_offset(40, 12, angle, ratio) == pytest.approx(-expected, rel=1e-13)


def test_arms_of_unequal_wheels():
    """The arms are rho_i / R_bi, and a base pitch is 2 pi / Z_i of R_bi."""
    rho_3, rho_2 = arms(0.25, math.pi / 4, 20, 40)
    assert rho_3 == pytest.approx(1.0 + math.pi / 40)
    assert rho_2 == pytest.approx(1.0 - math.pi / 80)


def test_the_holding_force_gives_both_bodies_the_same_acceleration():
    """The force F solves (-pull_3 + F) / m_3 = (-pull_2 - F) / m_2."""
    force = holding_force(3.0, -1.0, 2.0, 5.0)
    assert (-3.0 + force) / 2.0 == pytest.approx((1.0 - force) / 5.0)
    assert force == pytest.approx(17.0 / 7.0)
