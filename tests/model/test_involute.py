"""Involute geometry against constructions by hand, and tooth stiffness against ISO 6336."""

import math

import pytest

from gearmesh.model.involute import CORRECTION, Involute, inverse_involute, involute

ALPHA = math.radians(20.0)
SHIFTED = Involute(3.0, (12, 24), ALPHA, profile_shift=(0.6, 0.36))
"""KHK, Gear Technical Reference: alpha_w = 26.0886 degrees, a = 56.4999 mm."""


@pytest.mark.parametrize("angle", [1e-3, 0.1, 0.4, 1.0, 1.4, 1.5, 1.55])
def test_the_involute_and_its_inverse(angle):
    assert involute(angle) == pytest.approx(math.sin(angle) / math.cos(angle) - angle, rel=1e-9)
    assert inverse_involute(involute(angle)) == pytest.approx(angle, rel=1e-9)


def test_standard_wheels_touch_at_their_pitch_circles():
    wheels = Involute(3.0, (20, 41), ALPHA)
    assert wheels.working_pressure_angle == ALPHA
    assert wheels.working_centre_distance == pytest.approx(3.0 * 61 / 2.0)
    assert wheels.working_module == pytest.approx(3.0)
    assert wheels.base_diameters == pytest.approx((60.0 * math.cos(ALPHA), 123.0 * math.cos(ALPHA)))
    assert wheels.outside_diameters == pytest.approx((66.0, 129.0))


def test_the_path_of_contact_lies_between_the_tip_circles():
    """Cut the mesh line, from the pitch point at the angle alpha, with both tip circles."""
    wheels = Involute(3.0, (20, 41), ALPHA)

    def to_tip(pitch, tip):
        # Pythagoras, from the centre of the wheel: (r sin + x)^2 + (r cos)^2 = r_a^2.
        half = pitch * math.sin(ALPHA)
        return -half + math.sqrt(half**2 + tip**2 - pitch**2)

    path = to_tip(30.0, 33.0) + to_tip(61.5, 64.5)
    assert wheels.contact_ratio == pytest.approx(path / (math.pi * 3.0 * math.cos(ALPHA)))


def test_profile_shift_opens_the_centre_distance():
    found = SHIFTED
    opening = involute(found.working_pressure_angle) - involute(ALPHA)
    assert opening == pytest.approx(2.0 * 0.96 / 36 * math.tan(ALPHA))
    assert math.degrees(found.working_pressure_angle) == pytest.approx(26.0886, abs=1e-4)
    assert found.working_centre_distance == pytest.approx(56.4999, abs=1e-4)
    # Tip clearance of the rack: a = r_a + r_f of the other wheel + clearance.
    clearance = 3.0 * (1.25 - 1.0)
    for (z, x), tip in zip(((24, 0.36), (12, 0.6)), found.outside_diameters, strict=True):
        root = 3.0 * (z + 2.0 * x - 2.5)
        assert found.working_centre_distance == pytest.approx((tip + root) / 2.0 + clearance)
    # Shifts that cancel leave the centre distance alone, but not the tips.
    balanced = Involute(3.0, (12, 24), ALPHA, profile_shift=(0.5, -0.5))
    assert balanced.working_centre_distance == pytest.approx(54.0)
    assert balanced.outside_diameters == pytest.approx((45.0, 75.0))


def test_a_centre_distance_and_tip_diameters_that_are_given_are_kept():
    given = Involute(3.0, (12, 24), ALPHA, centre_distance=56.5, tip_diameters=(44.0, 79.0))
    assert given.working_centre_distance == pytest.approx(56.5)
    assert math.cos(given.working_pressure_angle) == pytest.approx(54.0 * math.cos(ALPHA) / 56.5)
    assert given.outside_diameters == (44.0, 79.0)
    assert given.working_module == pytest.approx(113.0 / 36.0)
    taller = Involute(3.0, (12, 24), ALPHA, addendum=1.2)
    assert taller.outside_diameters == pytest.approx((36 + 7.2, 72 + 7.2))


def written_out(z_1, z_2, x_1, x_2):
    """Compute q' of ISO 6336-1 (2006), clause 9, term by term."""
    total = 0.04723 + 0.15551 / z_1 + 0.25791 / z_2 - 0.00635 * x_1
    total += -0.11654 * x_1 / z_1 - 0.00193 * x_2 - 0.24188 * x_2 / z_2
    return total + 0.00529 * x_1 * x_1 + 0.00182 * x_2 * x_2


@pytest.mark.parametrize(
    ("teeth", "shift", "pinion"),
    [
        ((12, 24), (0.6, 0.36), (12, 24, 0.6, 0.36)),
        ((24, 12), (0.36, 0.6), (12, 24, 0.6, 0.36)),
        ((20, 20), (-0.2, 0.3), (20, 20, 0.3, -0.2)),
    ],
)
def test_the_stiffness_of_a_pair_of_teeth_by_iso_6336(teeth, shift, pinion):
    """The pinion, wheel 1 of the standard, has fewer teeth; of equal wheels the greater shift."""
    wheels = Involute(3.0, teeth, ALPHA, profile_shift=shift)
    rack = 1.0 + 0.5 * (1.2 - 1.25)
    single = 0.8 * rack / written_out(*pinion)
    assert CORRECTION == 0.8
    assert wheels.single_stiffness == pytest.approx(single, rel=1e-12)
    mean = single * (0.75 * wheels.contact_ratio + 0.25)
    assert wheels.mesh_stiffness == pytest.approx(mean, rel=1e-12)


def test_the_basic_rack_enters_the_stiffness():
    standard, other = (
        Involute(3.0, (20, 40), math.radians(angle), dedendum=foot)
        for angle, foot in ((20.0, 1.2), (22.5, 1.4))
    )
    assert standard.single_stiffness == pytest.approx(0.8 / written_out(20, 40, 0.0, 0.0))
    factor = (1.0 + 0.5 * (1.2 - 1.4)) * (1.0 - 0.02 * (20.0 - 22.5))
    assert other.single_stiffness == pytest.approx(factor * standard.single_stiffness)
