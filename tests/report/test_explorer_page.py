"""The explorer page: its numbers, its size, and studies that its solver cannot repeat."""

import base64
import dataclasses
import json
import re
from pathlib import Path

import numpy as np
import pytest
from small_run import compute

from gearmesh.data.datasets import open_dataset
from gearmesh.data.paths import Places
from gearmesh.dynamics.continuation.kinds import KINDS
from gearmesh.report.explorer import numbers, page, views
from gearmesh.study.loading import load_study

MOST_BYTES = 6_000_000


@pytest.fixture(scope="module")
def datasets(small_run):
    places = Places("smoke")
    return tuple(open_dataset(small_run / p) for p in (places.resonance, places.bifurcation))


def test_every_script_is_part_of_the_page(datasets, small_study):
    folder = Path(page.__file__).parent / "scripts"
    assert sorted(page.SCRIPTS) == sorted(folder.rglob("*.js"))
    text = page.render(small_study, *datasets)
    for script in page.SCRIPTS:
        assert script.read_text(encoding="utf-8") in text
        assert len(script.read_text(encoding="utf-8").splitlines()) <= 400


def test_the_page_asks_for_nothing(datasets, small_study):
    text = page.render(small_study, *datasets)
    assert not re.search(r"""(src|href)=["'](?!#|data:|index\.html)""", text)
    assert not re.search(r"@import|url\((?!#)|\bfetch\(|XMLHttpRequest|\bimport\(", text)
    assert len(text.encode()) < MOST_BYTES


def test_packed_numbers_are_the_numbers():
    arrays = {
        "odd": np.arange(3, dtype="i1"),
        "nu": np.array([0.6, np.pi]),
        "y": np.array([1.5, -2.25], "f4"),
        "counts": np.array([7, 65535], "u2"),
    }
    packed = numbers.pack(arrays)
    content = base64.b64decode(packed.text)
    for name, (kind, start, size) in packed.index.items():
        assert start % 8 == 0
        read = np.frombuffer(content, f"<{kind}", size, start)
        assert read.tolist() == arrays[name].tolist()


def test_a_large_study_is_thinned_until_it_fits(datasets, monkeypatch):
    whole = numbers.diagram(*datasets)
    monkeypatch.setattr(numbers, "MOST_BYTES", 5 * whole["y"].size // 2)
    thinned = numbers.diagram(*datasets)
    assert 5 * thinned["y"].size <= numbers.MOST_BYTES
    assert set(thinned["nu"]) < set(whole["nu"])
    assert thinned["counts"].shape == (whole["counts"].shape[0], thinned["nu"].size)


def test_orbits_are_those_of_the_study(datasets):
    import xarray as xr

    columns = {
        "variant": np.array(["c-material", "d-both", "other"], object),
        "branch": [0, 1, 0],
        "stability": [1, -1, 0],
        "nu": [0.7, 0.8, 0.9],
        "y_max_rel": [1.0, 2.0, 3.0],
        "y_min_rel": [0.1, 0.2, 0.3],
    }
    branches = xr.Dataset({name: ("point", values) for name, values in columns.items()})
    row = {"variant": "d-both", "kind": "flip", "periods": 2, "nu": 0.75}
    row |= {"y_max_rel": 1.5, "y_min_rel": 0.0}
    points = [row, {**row, "parameters": {}}, {**row, "periods": 5}]
    found = numbers.orbits(branches, points, ["c-material", "d-both"])
    assert found["branch_variant"].tolist() == [0, 1]
    assert found["branch_stability"].tolist() == [1, -1]
    assert found["special_kind"].tolist() == [KINDS.index("flip")]
    assert found["special_nu"].tolist() == [0.75]


OWN = """\
base: {base}
title: My own <gear> pair
claims: null
variants: [c-material, d-lubricant]
damping: 2 N s/mm
nu: {{start: 0.7, stop: 0.9, step: 0.1}}
strong_damping: null
time_courses: null
mechanisms: null
"""


def test_a_study_of_one_s_own_has_its_explorer(root, tmp_path):
    """It has its own variants, and does not speak of the paper."""
    file = tmp_path / "own.yaml"
    file.write_text(OWN.format(base=root / "config" / "smoke.yaml"), encoding="utf-8")
    study = load_study(str(file))
    compute(study, tmp_path)
    places = Places(study.name)
    datasets = (open_dataset(tmp_path / p) for p in (places.resonance, places.bifurcation))
    text = page.render(study, *datasets)
    assert "My own &lt;gear&gt; pair" in text
    assert "<gear>" not in text
    assert not any(stop.title in text for stop in views.TOUR)
    assert "paper" not in re.sub(r"<script.*?</script>|<style.*?</style>", "", text, flags=re.S)
    described = json.loads(re.search(r'id="study">(.*?)</script>', text).group(1))
    assert described["variants"] == ["c-material", "d-lubricant"]
    assert described["pair"]["damping"] == 2.0
    assert described["pair"]["teeth"] == 21


@pytest.mark.parametrize(
    ("changes", "told"),
    [({}, False), ({"eccentricity": "1 um"}, True), ({"teeth": [21, 34]}, True)],
)
def test_the_page_tells_what_its_solver_leaves_out(datasets, small_study, changes, told):
    own = dataclasses.replace(small_study, pair=small_study.pair.replace(**changes))
    text = page.render(own, *datasets)
    assert ("leaves them out" in text) == told
    assert '"teeth": 21,' in text


def test_a_pair_whose_damping_is_stated_as_a_ratio_has_all_controls(datasets, small_study):
    pair = small_study.pair.replace(damping_ratio=0.05)
    own = dataclasses.replace(small_study, pair=pair)
    text = page.render(own, *datasets)
    field = re.search(r'data-parameter="damping"[^>]*data-value="([^"]*)"', text)
    assert float(field.group(1)) == pytest.approx(pair.damping)
