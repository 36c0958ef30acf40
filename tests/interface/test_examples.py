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
