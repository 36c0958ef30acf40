"""The pipeline on the small study: what it leaves, and what an edit reruns."""

import json
import os
import re
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml
from orbits_in_tables import distance
from project import Project

from gearmesh.data.datasets import open_dataset
from gearmesh.dynamics.attraction.classification import classify

FIGURES = [f"fig{number}" for number in range(2, 8)]
LETTERS = "abcdefgh"
WHY = ("branches", "basins", "sweeps", "special_curves", "lyapunov", "design_map")


@pytest.fixture
def edited(smoke: Project, tmp_path: Path) -> Project:
    """A copy of it whose sources are edited; only its manifests are its own."""
    project = smoke.copy(tmp_path / "project", linked=True)
    for file in (project.study / "manifests").iterdir():
        content = file.read_bytes()
        file.unlink()
        file.write_bytes(content)
    return project


def test_everything_that_the_contract_lists_is_there(smoke):
    found = smoke.results()
    for name in ("fig1", *FIGURES):
        assert {f"figures/{name}.png", f"figures/{name}.svg"} <= found.keys()
    for name in FIGURES:
        assert {f"notebooks/{name}.ipynb", f"checks/{name}.json"} <= found.keys()
    for name in ("datasets/resonance.nc", "datasets/bifurcation.nc", "claims.json"):
        assert name in found
    assert {"report/index.html", "manifest.sha256", "verdict.txt"} <= found.keys()
    assert "cases/c-material/nu-0.6500.nc" in found
    assert {path.name for path in smoke.path("results").iterdir()} == {"smoke"}
    measured = {path.stem for path in (smoke.study / "benchmarks").iterdir()}
    assert {*(f"cases-{letter}" for letter in LETTERS), "datasets", "figure-fig2"} <= measured


def test_what_lies_behind_the_curves_is_there_and_explains_claims(smoke):
    page = (smoke.study / "report/index.html").read_text(encoding="utf-8")
    assert '<section id="why">' in page
    for name in WHY:
        assert f'<figure id="{name}">' in page
        assert {f"figures/{name}.png", f"figures/{name}.svg"} <= smoke.results().keys()
    assert (smoke.study / "report/notebooks/why.html").exists()
    special = json.loads((smoke.study / "datasets/special_points.json").read_text())
    assert {"variant", "kind", "nu", "periods"} <= special[0].keys()
    own = {row["kind"]: row["nu"] for row in special if row["variant"] == "c-material"
           and "parameters" not in row}  # fmt: skip
    assert abs(own["switching"] - 0.6386300024579) < 1e-8
    entries = json.loads((smoke.study / "claims.json").read_text(encoding="utf-8"))
    mechanisms = {entry["id"]: entry["mechanism"] for entry in entries if "mechanism" in entry}
    assert "0.638630" in mechanisms["F3.2"]
    branches = xr.open_dataset(smoke.study / "datasets/branches.nc")
    assert set(branches["variant"].values) == {"c-material", "c-lubricant"}


def test_the_long_run_motion_of_each_case_is_stated_and_shown(smoke, small_study):
    ends = open_dataset(smoke.study / "datasets/attractors.nc")
    assert tuple(ends["variant"].values) == small_study.variants
    plan = small_study.plan.frequencies()
    assert int((ends["kind"] > 0).sum()) == sum(len(nus) for _, nus in plan)
    page = (smoke.study / "report/index.html").read_text(encoding="utf-8")
    section = page[page.index("How every case ends") : page.index("All special points")]
    rows = re.findall(r'scope="row">(.*?)</th>', section)
    assert len(rows) == 1 + 2 + 7  # variant a, □, ×, and each variant with •
    settled = "100 % of the cases with □ settle within the 105 mesh periods of 5 revolutions"
    assert settled in section


def test_every_orbit_on_which_a_case_ends_lies_on_a_branch(smoke, small_study):
    branches = xr.open_dataset(smoke.study / "datasets/branches.nc")
    for name in small_study.plan.mechanisms.variants:
        own = branches.isel(point=np.flatnonzero(branches["variant"] == name))
        cases = [case for case in small_study.cases if case.variant.name == name]
        runs = classify([small_study.pair.problem(case.variant, case.nu) for case in cases])
        orbits = [run.orbit for run in runs if run.orbit]
        assert len(orbits) > len(cases) / 2
        assert max(distance(own, orbit) for orbit in orbits) < 5e-3


def test_a_run_leaves_nothing_temporary(smoke):
    assert not [
        path for path in smoke.study.rglob(".*") if path.suffix != ".lock" and path.name != ".again"
    ]


def test_sha256sum_checks_all_results(smoke):
    files = (smoke.study / "manifests").glob("*.sha256")
    for file in (smoke.study / "manifest.sha256", *files):
        command = ["sha256sum", "--check", "--strict", "--quiet", file]
        checked = subprocess.run(command, cwd=smoke.study, capture_output=True, text=True)
        assert checked.returncode == 0, checked.stderr
    lines = (smoke.study / "manifest.sha256").read_text().splitlines()
    listed = {line.partition("  ")[2] for line in lines}
    hidden = {
        "manifest.sha256",
        "checks/as_expected.txt",  # the last job writes it, after the hashes
        *(name for name in smoke.results() if name.startswith("manifests/")),
    }
    assert listed == smoke.results().keys() - hidden


def test_a_run_prints_its_cases_and_its_end(smoke):
    for letter in LETTERS:
        assert re.search(rf"gearmesh: {letter}: [1-9]\d* computed, 0 kept", smoke.output)
    counts = smoke.output[smoke.output.index("claims: ") :].splitlines()[0]
    assert sum(int(word) for word in counts.split() if word.isdigit()) == 35
    for name in ("printed", *FIGURES):
        assert f"\n{name}: " in smoke.output


def test_snakemake_s_own_report_shows_every_figure_with_its_caption(smoke):
    made = smoke.run("all", options=("--report", "report.zip"))
    assert made.returncode == 0, made.stdout
    with zipfile.ZipFile(smoke.path("report.zip")) as archive:
        listed = {Path(name).name: name for name in archive.namelist()}
        page = archive.read(listed["report.html"]).decode()
        for name in ("fig1", *FIGURES):
            drawn = (smoke.study / f"figures/{name}.png").read_bytes()
            assert archive.read(listed[f"{name}.png"]) == drawn
    for name in ("fig1", *FIGURES, "claims", "page", "workflow"):
        caption = smoke.path(f"workflow/report/{name}.rst").read_text(encoding="utf-8")
        assert json.dumps(caption.splitlines()[0][:60])[1:-1] in page, name


def test_datasets_hold_what_the_case_files_hold(smoke):
    opened = (
        xr.open_dataset(smoke.study / f"datasets/{n}.nc") for n in ("resonance", "bifurcation")
    )
    resonance, bifurcation = (dataset.set_index(variant="variant_name") for dataset in opened)
    for variant, nu in (("a-conservative", 0.6), ("c-lubricant", 1.2), ("c-material-5x", 0.65)):
        case = xr.open_dataset(smoke.study / f"cases/{variant}/nu-{nu:.4f}.nc")
        row = resonance.sel(variant=variant).sel(nu=nu, method="nearest")
        scalars = [name for name in case.data_vars if not case[name].dims]
        assert set(scalars) == set(resonance.data_vars)
        for name in scalars:
            assert row[name].item() == case[name].item(), name
        curve = bifurcation.sel(variant=variant).sel(nu=nu, method="nearest")
        count = case.sizes["extremum"]
        for name in ("extremum_time", "extremum_y", "extremum_y_rel", "extremum_kind"):
            assert curve[name][:count].values.tolist() == case[name].values.tolist()
            assert not curve[name][count:].fillna(0).any()
        for name in ("strobe_y", "strobe_v_rel"):
            assert curve[name].values.tolist() == case[name].values.tolist()


def times(project: Project) -> dict[Path, int]:
    return {path: path.stat().st_mtime_ns for path in project.study.rglob("[!.]*.*")}


def test_a_rerun_has_nothing_to_do(smoke):
    before = times(smoke)
    assert "Nothing to be done" in smoke.run("all").stdout
    assert times(smoke) == before


def test_neither_the_times_of_sources_nor_snakemake_s_records_matter(smoke, tmp_path):
    project = smoke.copy(tmp_path / "project")
    for path in (*project.path("src").rglob("*.py"), project.path("config/paper.yaml")):
        path.touch()
    assert project.plan("all") == set()
    project.path(".snakemake").rename(tmp_path / "records")
    assert project.plan("all") == set()
    for path in project.study.rglob("*"):
        os.utime(path, (4e9, 4e9))  # in the year 2096
    project.edit("workflow/report/fig4.rst", "", "More. ")
    assert project.plan("all") == REPORTED


# What an edit reruns: (what is edited, how, which jobs run).
END = {"ledger", "notebook_pages", "report", "crate", "hashes", "verdict"}
CASES = {f"cases-{letter}" for letter in LETTERS}
AFTER_CASES = {"datasets", "explorer", "why", *FIGURES, *END}
AFTER_BRANCHES = {"basins", "special_curves", "explorer", "why", *END}
MECHANISMS = {"branches", "ensembles", *AFTER_BRANCHES}
EVERYTHING = {*CASES, "thresholds", "printed", *AFTER_CASES, *MECHANISMS}
STATED = {"identified_figures", *EVERYTHING}
AFTER_THRESHOLDS = {"thresholds", "printed", *FIGURES, *END}
REPORTED = {"report", "crate", "hashes", "verdict"}
INPUTS = {"crate", "hashes", "verdict"}

INCREMENTS = {
    "README": ("README.md", "#", "# more\n#", set()),
    "comment": ("config/paper.yaml", "contact_ratio", "# more\ncontact_ratio", INPUTS),
    "plot": ("src/gearmesh/reproduction/figures/fig2.py", "Fig. 2", "Figure 2",
             {"fig2", *END}),
    "notebook": ("notebooks/fig3.ipynb", "## What is seen", "## Seen", {"fig3", *END}),
    "check": ("src/gearmesh/reproduction/claims/fig3.py", '"""', '"""About it: ', {"fig3", *END}),
    "shared check": ("src/gearmesh/reproduction/claims/fig5.py", '"""', '""" ',
                     {"fig5", "fig6", "fig7", *END}),
    "style": ("src/gearmesh/reproduction/figures/gearmesh.mplstyle", "#", "# more\n#",
              {"fig1", "identified_figures", "why", *FIGURES, *END}),
    "template": ("src/gearmesh/report/templates/claims.html.j2", "<t", " <t", {*FIGURES, *END}),
    "caption": ("workflow/report/fig4.rst", "", "More. ", REPORTED),
    "identified": ("config/identified.yaml", "", "# more\n", {"identified_figures", *REPORTED}),
    "thresholds": ("src/gearmesh/reproduction/thresholds.py", '"""', '""" ', AFTER_THRESHOLDS),
    "datasets": ("src/gearmesh/data/datasets.py", '"""', '""" ',
                 {"basins", *AFTER_CASES}),
    "orbits": ("src/gearmesh/dynamics/continuation/branches.py", '"""', '""" ',
               {"branches", *AFTER_BRANCHES}),
    "why": ("notebooks/why.ipynb", "## Basins", "## The basins",
            {"why", "notebook_pages", *REPORTED}),
    "solver": ("src/gearmesh/solvers/reduced/runs.py", '"""', '""" ', EVERYTHING),
    "one stage": ("src/gearmesh/pipeline/stages/claims.py", '"""Check the numbers', '"""Check all',
                  {"printed", "ledger", *REPORTED}),
    "command": ("workflow/rules/claims.smk", "python -m gearmesh.pipeline ledger",
                "python -B -m gearmesh.pipeline ledger", {"ledger", *REPORTED}),
    "tolerance": ("config/paper.yaml", "tolerance: 1e-10", "tolerance: 1e-9", EVERYTHING),
    "parameter": ("config/paper.yaml", "value: 8 y_st", "value: 8.1 y_st", STATED),
    "units": ("config/paper.yaml", "value: 10 um", "value: 0.010 mm", INPUTS),
    "step": ("config/smoke.yaml", "nu: {step: 0.05}", "nu: {step: 0.1}",
             {*CASES, *AFTER_CASES, "branches", *AFTER_BRANCHES}),
}  # fmt: skip


@pytest.mark.parametrize("row", INCREMENTS)
def test_an_edit_reruns_its_consequences_only(edited, row):
    """Also where the edit brings an old time along, as `cp -p`, `tar x` and `rsync -a` do."""
    name, old, new, expected = INCREMENTS[row]
    edited.edit(name, old, new)
    os.utime(edited.path(name), (1.5e9, 1.5e9))
    assert edited.plan("all") == expected


def test_the_tolerance_of_a_claim_reruns_its_check(edited):
    ledger = yaml.safe_load(edited.path("config/claims.yaml").read_text(encoding="utf-8"))
    assert ledger["F3.1"]["figure"] == "fig3"
    ledger["F3.1"]["tolerance"] = 0.051
    edited.path("config/claims.yaml").write_text(yaml.safe_dump(ledger, sort_keys=False))
    assert edited.plan("all") == {"fig3", *END}


def test_an_edit_is_noticed_without_snakemake_s_records(edited, tmp_path):
    edited.path(".snakemake").rename(tmp_path / "records")
    edited.edit("src/gearmesh/reproduction/figures/fig2.py", '"""Fig. 2', '"""Figure 2')
    assert edited.plan("all") == {"fig2", *END}


def test_a_damaged_picture_is_drawn_again(edited):
    picture = edited.study / "figures" / "fig2.png"
    content = picture.read_bytes()
    picture.unlink()  # the file is shared with other projects
    picture.write_bytes(content[:-1])
    assert edited.plan("all") == {"fig2", *END}
