"""Loads in the files of a study that asks for them."""

from dataclasses import replace

import pytest
import xarray as xr

import gearmesh as gm
from gearmesh.data import datasets
from gearmesh.data.casefile import case_digest
from gearmesh.data.paths import Places
from gearmesh.pipeline.stages.cases import cases
from gearmesh.study.loading import load_study

STUDY = """
base: {paper}
loads: true
revolutions: 2
variants: [b-both]
nu: {{start: null, stop: null, step: null, values: [0.7, 0.9]}}
strong_damping: null
time_courses: {{b-both: [0.9]}}
mechanisms: null
{more}
"""
SCALARS = ("dynamic_factor", "force_min", "transmission_error_range_rel", "force_bearing_2_max")


@pytest.mark.parametrize("more", ["", "direction: up"])
def test_the_files_of_a_study_hold_its_loads(root, tmp_path, monkeypatch, more):
    file = tmp_path / "loaded.yaml"
    file.write_text(STUDY.format(paper=root / "config" / "paper.yaml", more=more))
    monkeypatch.chdir(tmp_path)
    study = load_study(file)
    places = Places(study.name)
    batch, *files = cases(study, places, "b")
    datasets.write_datasets(study, [batch], places.resonance, places.bifurcation)
    resonance = datasets.open_dataset(places.resonance).sel(variant="b-both")
    run = None
    for nu, path in zip((0.7, 0.9), files, strict=True):
        run = gm.simulate(study.pair, "b-both", nu, start=run if more else None)
        with xr.open_dataset(path) as case:
            assert ("force_normal" in case) == (nu == 0.9)
            for name in SCALARS:
                assert float(case[name]) == float(run[name])
                assert float(resonance[name].sel(nu=nu)) == pytest.approx(float(run[name]))


def test_case_files_without_loads_are_not_taken_for_files_with_them(study):
    case = study.cases[0]
    assert case_digest(study.pair, case) != case_digest(study.pair, replace(case, loads=True))
