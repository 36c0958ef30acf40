"""The studies in config/examples/, small: each has what its source is known for."""

import numpy as np
import pytest

import gearmesh as gm

EXAMPLES = "config/examples"


@pytest.fixture
def example(root):
    """Return a function that loads an example by its name."""
    return lambda name: gm.load(root / EXAMPLES / f"{name}.yaml")


def test_every_example_states_its_source_and_inherits_nothing_of_the_paper(root):
    files = sorted((root / EXAMPLES).glob("*.yaml"))
    assert files
    for file in files:
        text = file.read_text(encoding="utf-8")
        assert "Source:" in text, file
        assert "base:" not in text, file
        study = gm.load(file)
        assert study.title and len(study.cases) > 1, file


def test_kahraman_singh_jumps_at_other_frequencies_upwards_than_downwards(example):
    """Linear up to contact loss: y = 1 + W^2 F/|1 - W^2 + 2 i zeta W|."""
    study = example("kahraman-singh")
    nu = np.array([0.6, 0.66, 0.72, 0.75, 0.78, 0.84, 0.9])
    up, down = (
        gm.sweep(study.pair, study.variants, nu, direction=direction).y_max_rel.squeeze()
        for direction in ("up", "down")
    )
    linear = 1 + 0.5 * nu**2 / abs(1 - nu**2 + 0.1j * nu)
    assert up.values[:5] == pytest.approx(linear[:5], rel=1e-3)
    assert down.values[:2] == pytest.approx(linear[:2], rel=1e-3)
    # Two motions from 0.72 to 0.78, and contact loss on both ways above. The gap softens the mesh:
    # the resonance is below W = 1.
    assert (down.values[2:5] > 1.9 * up.values[2:5]).all()
    assert up.values[5:] == pytest.approx(down.values[5:], rel=1e-3)
    assert up.values.argmax() == 5


def test_ross_62_62_has_the_numbers_of_its_source_and_resonates(example):
    study = example("ross-62-62")
    pair = study.pair
    assert pair.stiffness_mean == pytest.approx(419_604, rel=1e-3)
    assert pair.base_radius == pytest.approx(58.260, abs=1e-3)
    assert pair.standard_contact_ratio == pytest.approx(pair.contact_ratio, abs=1e-5)
    speeds = ["3800 rpm", "5200 rpm"]
    found = gm.sweep(pair, "b-both", speeds, loads=True, revolutions=3).squeeze()
    off, near = found.dynamic_factor.values
    assert near > 1.5 * off
    assert found.contact_loss_fraction.values[0] == 0.0 < found.contact_loss_fraction.values[1]


def test_ross_20_20_has_the_mean_force_of_its_source_and_parts(example):
    """test_mesh_with_backlash expects a mean mesh force of 3191.996 N to one per cent."""
    study = example("ross-20-20")
    assert study.pair.stiffness_mean == pytest.approx(517_925, rel=1e-3)
    run = gm.simulate(study.pair, "b-both", "1000 rpm", revolutions=8)
    assert float(run.force_normal.mean()) == pytest.approx(3191.996, rel=0.01)
    assert float(run.contact_loss_fraction) == 0.0
    fast = gm.simulate(study.pair, "b-both", "5000 rpm", revolutions=8)
    assert float(fast.contact_loss_fraction) > 0.2


def test_ross_328_23_has_the_contact_ratio_of_its_source_and_two_different_wheels(example):
    study = example("ross-328-23")
    pair = study.pair
    assert pair.standard_contact_ratio == pytest.approx(pair.contact_ratio, rel=2e-4)
    radius_3, radius_2 = pair.base_radii
    assert 2 * radius_2 == pytest.approx(71.34, rel=2e-3)  # base_diameter of the docstring
    reduced = 1 / ((radius_3 / 1e3) ** 2 / 113.9 + (radius_2 / 1e3) ** 2 / 0.004)
    assert pair.reduced_mass == pytest.approx(reduced, rel=1e-12)
    found = gm.sweep(pair, "b-both", ["88 rpm", "196 rpm"], loads=True, revolutions=1).squeeze()
    off, near = found.dynamic_factor.values
    assert near > 1.5 * off
    # The heavy wheel hardly moves; the pinion shakes its bearing.
    heavy, light = found.force_bearing_3_max.values, found.force_bearing_2_max.values
    assert heavy == pytest.approx(pair.static_force, rel=0.02)
    assert light[1] > 1.1 * pair.static_force


def test_bgu_18_35_states_what_geometry_computes(example):
    pair = example("bgu-18-35").pair
    wheels = gm.geometry(module="3 mm", teeth=(18, 35), face_width="30 mm")
    assert pair.replace(**wheels.parameters).digest() == pair.digest()
    run = gm.simulate(pair, "b-both", "27000 rpm", revolutions=15)
    assert float(run.contact_loss_fraction) > 0.3


def test_ufam_27_35_states_what_geometry_computes_and_parts_at_resonance(example):
    """The equivalent mass and the force are those that the code of the source computes."""
    pair = example("ufam-27-35").pair
    wheels = gm.geometry(module="3 mm", teeth=(27, 35), face_width="25 mm")
    assert pair.replace(**wheels.parameters).digest() == pair.digest()
    assert pair.reduced_mass == pytest.approx(0.349311, rel=1e-6)
    assert pair.static_force == pytest.approx(10_036.7, rel=1e-5)
    found = gm.sweep(pair, "b-both", ["2000 rpm", "11000 rpm"], loads=True, revolutions=3).squeeze()
    stated, near = found.dynamic_factor.values
    assert near > 2.0 * stated
    assert found.contact_loss_fraction.values[0] == 0.0 < found.contact_loss_fraction.values[1]


def test_a_cracked_tooth_makes_sidebands_of_its_wheel(example):
    """Orders 1 + k/38: the driven wheel has 38 teeth. Without the crack there are none."""
    study = example("bgu-cracked-tooth")
    cracked, sound = (
        gm.spectrum(gm.simulate(pair, "b-both", "2400 rpm")).force_normal
        for pair in (study.pair, study.pair.replace(tooth_factors=[]))
    )
    bands = [1 + k / 38 for k in (-2, -1, 1, 2)]
    mesh = float(sound.sel(order=1.0))
    assert float(cracked.sel(order=1.0)) == pytest.approx(mesh, rel=0.1)
    assert (cracked.sel(order=bands, method="nearest") > 0.01 * mesh).all()
    assert (sound.sel(order=bands, method="nearest") < 1e-9 * mesh).all()
    between = 1 + 0.5 / 38  # resolved by 38 revolutions of 17 teeth, and no order of the crack
    assert float(cracked.sel(order=between, method="nearest")) < 1e-6 * mesh


def test_nrel_24_95_states_what_geometry_computes_and_keeps_contact_at_rated_speed(example):
    pair = example("nrel-24-95").pair
    helix = np.radians(10)
    section = gm.geometry(
        module=f"{14 / np.cos(helix)} mm",
        teeth=(95, 24),
        face_width="360 mm",
        pressure_angle=f"{np.arctan(np.tan(np.radians(20)) / np.cos(helix))} rad",
        profile_shift=(0.669 * np.cos(helix), 0.480 * np.cos(helix)),
        centre_distance="861 mm",
        tip_diameters=("1395.372 mm", "380.751 mm"),
    )
    for name in ("contact_ratio", "stiffness_ratio"):
        assert getattr(pair, name) == pytest.approx(getattr(section, name), rel=1e-4)
    assert pair.mesh_stiffness_max == pytest.approx(section.mesh_stiffness_max, rel=1e-4)
    assert pair.base_radii == pytest.approx(
        [d / 2 for d in section.wheels.base_diameters], rel=1e-5
    )
    assert pair.torque == pytest.approx(5e6 / (2 * np.pi * 296.5 / 60), rel=1e-3)
    run = gm.simulate(pair, "b-both", "296.5 rpm", revolutions=3)
    assert float(run.contact_loss_fraction) == 0.0
    assert 1.5 < float(run.dynamic_factor) < 3.0
