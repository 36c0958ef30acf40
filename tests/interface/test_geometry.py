"""Involute geometry and stiffness, against printed examples and another library."""

import math

import pytest

import gearmesh as gm
from gearmesh.model.involute import inverse_involute, involute


def test_a_printed_example_with_profile_shift():
    """KHK, Gear Technical Reference, calculation of profile shifted spur gears (12 and 24 teeth).

    Also at bolsover.com/utilitiesforalibre/profile-shifted-external-spur-gears.html.
    """
    wheels = gm.geometry(
        module="3 mm",
        teeth=(12, 24),
        face_width="30 mm",
        profile_shift=(0.6, 0.36),
        centre_distance="56.5 mm",
    )
    found = wheels.wheels
    assert f"{math.degrees(found.working_pressure_angle):.4f}" == "26.0888"
    assert [f"{d:.4f}" for d in found.base_diameters] == ["33.8289", "67.6579"]
    assert [f"{d:.3f}" for d in found.outside_diameters] == ["44.840", "79.400"]
    assert f"{wheels.contact_ratio:.3f}" == "1.202"
    free = gm.geometry(module="3 mm", teeth=(12, 24), face_width="30 mm", profile_shift=(0.6, 0.36))
    assert f"{free.wheels.working_centre_distance:.3f}" == "56.500"


def test_the_paper_prints_the_contact_ratio_of_its_wheels(pair):
    wheels = gm.geometry(module="3 mm", teeth=21, face_width="20 mm")
    assert f"{wheels.contact_ratio:.3f}" == "1.569"
    assert wheels.contact_ratio == pair.standard_contact_ratio
    # Its stiffness ratio is printed too: 0.5879.
    assert wheels.stiffness_ratio == pytest.approx(0.5879, abs=0.02)


def test_the_rectangular_wave_has_the_stiffnesses_of_iso_6336(pair):
    """c' b while one pair carries and c_gamma_alpha b in the mean: two pairs have 7/4 c' b."""
    wheels = gm.geometry(module="2 mm", teeth=62, face_width="20 mm")
    mine = pair.replace(**wheels.parameters)
    flexibility = 0.04723 + (0.15551 + 0.25791) / 62  # no profile shift
    single = 0.8 * 0.975 / flexibility * 20e3
    assert mine.stiffness_min == pytest.approx(single, rel=1e-12)
    mean = single * (0.75 * wheels.contact_ratio + 0.25)
    assert mine.stiffness_mean == pytest.approx(mean, rel=1e-12)
    assert wheels.mesh_stiffness_max == pytest.approx(1.75 * single, rel=1e-12)


def test_another_library_has_the_same_contact_ratio_and_nearly_the_same_stiffness():
    """ROSS, test_gear_element.py and docstring of Mesh: 1.78978 and, by energies, 4.196e8 N/m."""
    wheels = gm.geometry(module="2 mm", teeth=62, face_width="20 mm")
    assert wheels.contact_ratio == pytest.approx(1.7897798668330458, rel=1e-14)
    assert wheels.stiffness_mean == pytest.approx(419_604, rel=0.1)


def test_working_module_and_angle_keep_the_base_circles(pair):
    wheels = gm.geometry(module="3 mm", teeth=24, face_width="20 mm", profile_shift=(0.4, 0.2))
    mine = pair.replace(**wheels.parameters)
    assert mine.pressure_angle > math.radians(20)
    assert 2 * mine.base_radius == pytest.approx(wheels.wheels.base_diameters[0], rel=1e-14)


@pytest.mark.parametrize("angle", [0.05, 0.3, 0.7, 1.2])
def test_the_involute_is_inverted(angle):
    assert inverse_involute(involute(angle)) == pytest.approx(angle, rel=1e-12)


DRAWING = {"module": "3 mm", "teeth": (12, 24), "face_width": "30 mm"}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"module": "3 kg"}, "module: found '3 kg'; unit 'kg' is of another kind"),
        ({"module": 3}, "module: found 3; unit missing; expected: a length"),
        ({"teeth": 20.5}, "teeth: found 20.5; allowed are whole numbers"),
        ({"teeth": (1, 2, 3)}, "teeth: found 3 values; allowed is one, or two for 3 and 2"),
        ({"profile_shift": 5.0}, "profile_shift: found 5.0; allowed is -1 to 2"),
        ({"centre_distance": "40 mm"}, "centre_distance: found 40 mm; allowed is more than half"),
        ({"tip_diameters": "30 mm"}, "tip_diameters: found 30 mm; allowed is more than the base"),
        ({"centre_distance": "60 mm"}, "geometry: the contact ratio is"),
    ],
)
def test_a_wrong_drawing_is_one_line(changes, message):
    with pytest.raises(gm.InputError) as caught:
        gm.geometry(**DRAWING | changes)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)
