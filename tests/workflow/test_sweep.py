"""A study whose runs go on from one another: the pipeline gives what the library gives."""

import numpy as np
import pytest
import xarray as xr

import gearmesh as gm
from gearmesh.data.paths import Places
from gearmesh.pipeline.stages.cases import case, cases

SWEEP = """\
base: paper.yaml
nu: {start: 0.62, stop: 0.68, step: 0.02}
variants: [b-lubricant]
time_courses: {b-lubricant: [0.64]}
revolutions: 2
direction: %s
"""


@pytest.mark.parametrize("direction", ["up", "down"])
def test_the_cases_of_a_sweep(root, tmp_path, monkeypatch, direction):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "paper.yaml").write_bytes((root / "config" / "paper.yaml").read_bytes())
    (tmp_path / "mine.yaml").write_text(SWEEP % direction)
    study = gm.load("mine.yaml")
    places = Places(study.name)
    cases(study, places, "b")
    found = gm.sweep(study.pair, "b-lubricant", study.nu, direction=direction)
    for nu in study.nu:
        with xr.open_dataset(places.case("b-lubricant", nu)) as file:
            assert file.attrs["sweep_direction"] == direction
            assert float(file.y_max) == float(found.y_max.sel(variant="b-lubricant", nu=nu))
            if nu == 0.64:  # its samples need the same start
                assert np.nanmax(file.y) <= float(file.y_max)
                assert float(file.y_max) - float(file.y.max()) < 1e-3 * float(file.y_max)
    with pytest.raises(gm.InputError, match="not computed alone"):
        case(study, places, "b-lubricant", "0.6400")
