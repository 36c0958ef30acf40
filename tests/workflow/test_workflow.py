"""The pipeline on the small study: what it leaves, and what an edit reruns."""

import json
import re
import zipfile
from pathlib import Path

import pytest
import xarray as xr
import yaml
from project import Project

from gearmesh.pipeline import job

FIGURES = [f"fig{number}" for number in range(2, 8)]


@pytest.fixture
def edited(smoke: Project, tmp_path: Path) -> Project:
    """A copy of it whose sources are edited."""
    return smoke.copy(tmp_path / "project", linked=True)


def test_everything_that_the_contract_lists_is_there(smoke):
    found = smoke.results()
    for name in ("fig1", *FIGURES):
        assert {f"figures/{name}.png", f"figures/{name}.svg"} <= found.keys()
    for name in FIGURES:
        assert {f"notebooks/{name}.ipynb", f"checks/{name}.json"} <= found.keys()
    for name in ("datasets/resonance.nc", "datasets/bifurcation.nc", "claims.json"):
        assert name in found
    assert "report/index.html" in found
    assert "cases/c-material/nu-0.6500.nc" in found


def test_a_run_tells_its_progress_and_its_end(smoke):
    assert re.search(r"gearmesh: 299 of 299 cases, \d+ a second", smoke.output)
    summary = smoke.output.partition("gearmesh: claims: ")[2]
    assert re.match(r"\d+ reproduced, \d+ deviating, \d+ not testable", summary)
    assert "cases: 299 computed, 0 kept" in summary
    for stage in ("cases", "datasets", "thresholds", "figures", "ledger", "report"):
        assert re.search(rf"time of jobs: .*{stage} [\d.]+ s", summary)


def test_the_progress_line_tells_what_is_done_the_rate_and_the_time_left(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    job.begin_run(1000)
    begun, _ = job.read_journal()
    monkeypatch.setattr(job.time, "time", lambda: begun["start"] + 20.0)
    assert job.progress() == "0 of 1000 cases, 0 a second"
    job.note({"kept": 100})
    job.note({"computed": 300, "failed": 2})
    assert job.progress() == "400 of 1000 cases, 20 a second, 30 s left"


def test_snakemake_s_own_report_shows_every_figure_with_its_caption(smoke):
    made = smoke.run("all", options=("--report", "report.zip"))
    assert made.returncode == 0, made.stdout
    with zipfile.ZipFile(smoke.path("report.zip")) as archive:
        listed = {Path(name).name: name for name in archive.namelist()}
        page = archive.read(listed["report.html"]).decode()
        for name in ("fig1", *FIGURES):
            drawn = smoke.path(f"results/figures/{name}.png").read_bytes()
            assert archive.read(listed[f"{name}.png"]) == drawn
    for name in ("fig1", *FIGURES, "claims", "page", "workflow"):
        caption = smoke.path(f"workflow/report/{name}.rst").read_text(encoding="utf-8")
        assert json.dumps(caption.splitlines()[0][:60])[1:-1] in page, name


def test_datasets_hold_what_the_case_files_hold(smoke):
    resonance = xr.open_dataset(smoke.path("results/datasets/resonance.nc"))
    bifurcation = xr.open_dataset(smoke.path("results/datasets/bifurcation.nc"))
    for variant, nu in (("a-conservative", 0.6), ("c-lubricant", 1.2), ("c-material-5x", 0.65)):
        case = xr.open_dataset(smoke.path(f"results/cases/{variant}/nu-{nu:.4f}.nc"))
        row = resonance.sel(variant=variant).sel(nu=nu, method="nearest")
        scalars = [name for name in case.data_vars if not case[name].dims and name != "seal"]
        assert set(scalars) == set(resonance.data_vars) - {"seal"}
        for name in scalars:
            assert row[name].item() == case[name].item(), name
        course = bifurcation.sel(variant=variant).sel(nu=nu, method="nearest")
        count = case.sizes["extremum"]
        for name in ("extremum_time", "extremum_y", "extremum_y_rel", "extremum_kind"):
            assert course[name][:count].values.tolist() == case[name].values.tolist()
            assert not course[name][count:].fillna(0).any()
        for name in ("strobe_y", "strobe_v_rel"):
            assert course[name].values.tolist() == case[name].values.tolist()


def test_a_rerun_has_nothing_to_do(smoke):
    before = {path: path.stat().st_mtime_ns for path in smoke.path("results").rglob("*.*")}
    if smoke.path("results/verdict.txt").exists():
        assert "Nothing to be done" in smoke.run("all").stdout
    else:  # a claim came out otherwise than expected: only the verdict is given again
        assert smoke.plan("all") == {"verdict", "all"}
    after = {path: path.stat().st_mtime_ns for path in smoke.path("results").rglob("*.*")}
    assert after == before


# What an edit reruns, besides the verdict: (what is edited, how, which rules run).
END = {"ledger", "notebook_pages", "report"}
CASES = {"cases_0"}
AFTER_CASES = {"datasets", *FIGURES, *END}
EVERYTHING = {*CASES, "thresholds", "printed", *AFTER_CASES}
STATED = {"identified_figures", *EVERYTHING}

AFTER_THRESHOLDS = {"thresholds", "printed", *FIGURES, *END}
NEW_CASES = {*CASES, *AFTER_CASES}

INCREMENTS = {
    "README": ("README.md", "", "more\n", set()),
    "plot": ("src/gearmesh/figures/fig2.py", '"""Fig. 2', '"""Figure 2', {"fig2", *END}),
    "notebook": ("notebooks/fig3.ipynb", "## What is seen", "## Seen", {"fig3", *END}),
    "check": ("src/gearmesh/claims/fig3.py", '"""', '"""About it: ', {"fig3", *END}),
    "shared check": ("src/gearmesh/claims/fig5.py", '"""', '""" ', {"fig5", "fig6", "fig7", *END}),
    "caption": ("workflow/report/fig4.rst", "", "More. ", {"report"}),
    "identified": ("config/identified.yaml", "", "# more\n", {"identified_figures", "report"}),
    "thresholds": ("src/gearmesh/thresholds.py", '"""', '""" ', AFTER_THRESHOLDS),
    "datasets": ("src/gearmesh/datasets.py", '"""', '""" ', {*AFTER_CASES}),
    "physics": ("src/gearmesh/friction.py", '"""', '""" ', STATED),
    "solver": ("src/gearmesh/integrator.py", '"""', '""" ', EVERYTHING),
    "tolerance": ("config/paper.yaml", "tolerance: 1e-10", "tolerance: 1e-9", EVERYTHING),
    "parameter": ("config/paper.yaml", "backlash: 80 um", "backlash: 81 um", STATED),
    "units": ("config/paper.yaml", "backlash: 80 um", "backlash: 0.080 mm", set()),
    "reason": ("config/paper.yaml", "reasons: # one", "reasons: # just one", set()),
    "step": ("config/smoke.yaml", "nu: {step: 0.05}", "nu: {step: 0.1}", NEW_CASES),
    "range": ("config/smoke.yaml", "nu: {step: 0.05}", "nu: {step: 0.05, stop: 1.3}", NEW_CASES),
}  # fmt: skip


@pytest.mark.parametrize("row", INCREMENTS)
def test_an_edit_reruns_its_consequences_only(edited, row):
    name, old, new, expected = INCREMENTS[row]
    edited.edit(name, old, new)
    assert edited.plan("all") - {"verdict", "all"} == expected


def test_the_tolerance_of_a_claim_reruns_its_check(edited):
    ledger = yaml.safe_load(edited.path("config/claims.yaml").read_text(encoding="utf-8"))
    assert ledger["F3.1"]["figure"] == "fig3"
    ledger["F3.1"]["tolerance"] = 0.051
    edited.path("config/claims.yaml").write_text(yaml.safe_dump(ledger, sort_keys=False))
    assert edited.plan("all") - {"verdict", "all"} == {"fig3", *END}
