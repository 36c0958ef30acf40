"""Where results are: the places that readers and scripts rely on."""

import numpy as np
import pytest

from gearmesh.data import casefile, paths
from gearmesh.data.paths import Places

PLACES = {
    "again": ".again",
    "as_expected": "checks/as_expected.txt",
    "bifurcation": "datasets/bifurcation.nc",
    "branches": "datasets/branches.nc",
    "cases": "cases",
    "crate": "ro-crate-metadata.json",
    "explorer": "report/explorer.html",
    "folder": "",
    "hashes": "manifest.sha256",
    "inputs": "inputs",
    "ledger": "claims.json",
    "report": "report/index.html",
    "resonance": "datasets/resonance.nc",
    "scratch": ".scratch",
    "special_points": "datasets/special_points.json",
    "thresholds": "datasets/thresholds.json",
    "verdict": "verdict.txt",
    "verification": "verification.json",
}
OF_NAMES = [
    ("batch", ("a",), "batches/a.nc"),
    ("benchmark", ("j",), "benchmarks/j.tsv"),
    ("case", ("c-material", 0.66), "cases/c-material/nu-0.6600.nc"),
    ("check", ("n",), "checks/n.json"),
    ("executed_notebook", ("n",), "notebooks/n.ipynb"),
    ("log", ("j",), "logs/j.log"),
    ("manifest", ("j",), "manifests/j.sha256"),
    ("mechanism", ("n",), "datasets/n.nc"),
    ("notebook_page", ("n",), "report/notebooks/n.html"),
]


@pytest.mark.parametrize("name", PLACES)
def test_each_result_has_its_place(name):
    expected = f"results/mine/{PLACES[name]}".rstrip("/")
    assert getattr(Places("mine"), name).as_posix() == expected


@pytest.mark.parametrize(("method", "arguments", "expected"), OF_NAMES)
def test_each_named_result_has_its_place(method, arguments, expected):
    found = getattr(Places("mine"), method)(*arguments)
    assert found.as_posix() == f"results/mine/{expected}"


def test_figures_are_pictures_and_drawings():
    png, svg = Places("mine").figure_files("fig2")
    assert png.as_posix() == "results/mine/figures/fig2.png"
    assert svg.as_posix() == "results/mine/figures/fig2.svg"
    assert paths.FIGURE_NAMES == ("fig1", "fig2", "fig3", "fig4", "fig5", "fig6", "fig7")


@pytest.mark.parametrize(
    ("nu", "label"), [(0.66, "0.6600"), (1.0, "1.0000"), (0.65001, "0.65001"), (0.01, "0.0100")]
)
def test_a_label_has_four_decimals_or_more(nu, label):
    assert paths.nu_label(nu) == label
    assert paths.case_name("c-material", nu) == f"c-material/nu-{label}.nc"


def test_what_is_absent_is_marked_as_cf_wants_it():
    fields = {field.name: field for field in casefile.FIELDS}
    assert np.isnan(casefile.absent(fields["y_max"]))
    assert casefile.absent(fields["extremum_kind"]) == 0
    assert casefile.absent(fields["n_contact_losses"]) == -1
