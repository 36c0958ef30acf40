"""Attractors and basins with units: the same labels in every dataset, and messages if wrong."""

import numpy as np
import pytest
import xarray as xr

import gearmesh as gm


@pytest.fixture(scope="module")
def pair():
    return gm.paper()


@pytest.fixture(scope="module")
def basins(pair):
    """b-material between its folds: two stable orbits."""
    phases = [0.0, pair.initial_phase]
    return gm.basins(
        pair, "b-material", 0.8, y=["-10 um", 0, "2 y_st"], v=[-3.0, 0, 3.0], phase=phases
    )


def test_a_dataset_with_complex_multipliers_is_written_and_read_again(pair, basins, tmp_path):
    found = gm.attractors(pair, "c-material", 0.7, starts=[(0, 0)])
    how = {"engine": "netcdf4", "auto_complex": True}
    for dataset in (found, basins):
        dataset.to_netcdf(tmp_path / "found.nc", **how)
        with xr.open_dataset(tmp_path / "found.nc", **how) as again:
            assert again.identical(dataset)
            assert again.multipliers.dtype == complex


def test_labels_are_the_same_in_every_dataset(pair, basins):
    found = gm.attractors(pair, "b-material", 0.8)
    assert found.label.values.tolist() == basins.label.values.tolist()
    assert found.signature.values.tolist() == ["normal_mesh", "normal_mesh contact_loss"]
    alone = gm.attractors(pair.replace(initial_phase=0), "b-material", 0.8, starts=[(0, "30 um")])
    assert alone.label.item() in found.label
    for i, label in enumerate(found.label.values):
        start = (float(found.strobe_y_rel[i]), float(found.strobe_v_rel[i]))
        orbit = gm.find_orbit(pair.replace(initial_phase=0), "b-material", 0.8, start=start)
        dataset = orbit.to_dataset()
        point = f"({float(dataset.strobe_y_rel):.4f}, {float(dataset.strobe_v_rel):.4f})"
        assert label == f"period 1 at {point}"
        assert float(found.y_max[i]) == pytest.approx(float(dataset.y_max), abs=1e-12)


def test_a_run_ends_where_its_basin_says(pair, basins):
    assert basins.y.values.tolist() == pytest.approx([-0.01, 0.0, 0.02])
    assert basins.v_rel.values.tolist() == [-3.0, 0.0, 3.0]
    assert float(basins.share.sum()) == pytest.approx(1.0)
    for i, y in enumerate(basins.y_rel.values):
        run = gm.simulate(pair, "b-material", 0.8, start=(float(y), 3.0), revolutions=60)
        reached = int(basins.reached[1, i, 2])
        assert float(run.y_max) == pytest.approx(float(basins.y_max[reached]), abs=1e-6)


def test_exponents_of_an_orbit_are_those_of_its_multipliers(pair):
    found = gm.lyapunov_spectrum(pair, "c-material", [0.9], periods=1200, transient=400)
    multipliers = gm.find_orbit(pair, "c-material", 0.9).multipliers
    period = 2.0 * np.pi / (0.9 * pair.natural_frequency)
    expected = np.log(np.abs(multipliers)) / period
    np.testing.assert_allclose(found.exponents[0], expected, atol=1e-3 * pair.natural_frequency)
    assert found.exponents.attrs["units"] == "s-1"


WRONG = {
    "no common period": lambda pair: gm.attractors(
        pair.replace(torque_harmonics=[{"order": 0.3141, "cos": 0.05}]), "c-material", 0.7
    ),
    "a start": lambda pair: gm.attractors(pair, "c-material", 0.7, starts=[("1 kg", 0)]),
    "starts": lambda pair: gm.attractors(pair, "c-material", 0.7, starts=[]),
    "revolutions": lambda pair: gm.attractors(pair, "c-material", 0.7, revolutions=0),
    "pair": lambda _: gm.attractors("paper", "c-material", 0.7),
    "no pair": lambda _: gm.lyapunov_spectrum(None, "c-material", 0.7),
    "pair of basins": lambda _: gm.basins(None, "c-material", 0.7, y=1.0),
    "nu in a list": lambda pair: gm.basins(pair, "c-material", [0.66], y=1.0),
    "nested nu": lambda pair: gm.lyapunov_spectrum(pair, "c-material", [[0.66, 0.7]]),
    "starts in an array": lambda pair: gm.attractors(pair, "c-material", 0.7, starts=np.eye(9)),
    "nested y": lambda pair: gm.basins(pair, "c-material", 0.7, y=[[1.0], [2.0, 3.0]]),
    "nested phases": lambda pair: gm.basins(pair, "c-material", 0.7, y=1, phase=[[0], [0, 1]]),
    "y": lambda pair: gm.basins(pair, "c-material", 0.7, y=["1 kg"]),
    "y twice": lambda pair: gm.basins(pair, "c-material", 0.7, y=[1.0, "1 y_st"]),
    "phase twice": lambda pair: gm.basins(pair, "c-material", 0.7, y=1.0, phase=[0.0, 1.0]),
    "phase": lambda pair: gm.basins(pair, "c-material", 0.7, y=1.0, phase=1.5),
    "periods": lambda pair: gm.lyapunov_spectrum(pair, "c-material", 0.7, periods=7),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_argument_is_one_line(pair, name):
    with pytest.raises(gm.InputError) as caught:
        WRONG[name](pair)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 200


def test_motion_is_neutral_only_where_a_motion_in_contact_exists(pair):
    """At 1.1 and 0.85 the periodic motion that contact would allow needs a pull."""
    early = gm.attractors(pair, "c-lubricant", 1.1, revolutions=2)
    late = gm.attractors(pair, "c-lubricant", 1.1)
    assert early.kind.values.tolist() == ["moving"]
    assert late.kind.values.tolist() == ["periodic"]
    grid = {"y": np.linspace(-3.0, 4.0, 17), "v": np.linspace(-2.0, 2.0, 17)}
    found = gm.basins(pair, "c-lubricant", 0.85, **grid)
    assert found.kind.values.tolist() == ["periodic"]
