"""What a plan loads, and the files and facts that its jobs depend on."""

import hashlib
from pathlib import Path

import pytest
from project import ROOT

from gearmesh.data import paths, provenance
from gearmesh.data.manifest import Manifest
from gearmesh.data.paths import Places
from gearmesh.errors import InputError
from gearmesh.identification import layout
from gearmesh.identification.settings import load_settings
from gearmesh.pipeline import plan as pipeline
from gearmesh.pipeline.inputs import inputs
from gearmesh.pipeline.plan import Plan
from gearmesh.pipeline.stages import STAGES
from gearmesh.reproduction.claims import load_ledger
from gearmesh.study.loading import load_study

ARGUMENTS = {
    "cases": "c",
    "case": "c-material",
    "figure": "fig2",
    "samples": "main",
    "box": "main",
}


@pytest.fixture
def plan(monkeypatch):
    """The plan of the paper's study; nothing is written."""
    monkeypatch.chdir(ROOT)
    return Plan(load_study("config/paper.yaml"))


@pytest.fixture
def bare(plan, tmp_path):
    """The plan of a study without a ledger and without orbits."""
    file = tmp_path / "bare.yaml"
    file.write_text(f"base: {ROOT / 'config' / 'paper.yaml'}\nmechanisms: null\n")
    return Plan(load_study(file))


def test_a_plan_holds_what_the_files_state(plan, bare):
    assert plan.ledger == load_ledger(paths.CLAIMS) != []
    assert bare.ledger == []
    assert plan.mechanisms is plan.study.plan.mechanisms is not None
    with pytest.raises(KeyError, match="mechanisms"):
        _ = bare.mechanisms
    assert plan.designs == load_settings(layout.SETTINGS)
    assert plan.places == Places("paper")
    assert plan.pair["parameters_sha256"] == plan.study.pair.digest()
    assert {letter: len(cases) for letter, cases in plan.letters.items()}.keys() == {*"abcdefgh"}
    assert all(case.variant.letter == "c" for case in plan.letters["c"])
    assert "_digests" not in repr(plan)


@pytest.fixture
def checked(monkeypatch):
    """Let the check of manifests find one job that holds, and write nothing."""
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(Plan, "check", lambda self: frozenset({"cases-c"}))


def test_a_study_is_loaded_by_option_by_file_or_the_papers(checked):
    smoke = "config/smoke.yaml"
    for options, files, name in (
        ({}, [], "paper"),
        ({"study": smoke}, [], "smoke"),
        ({}, [Path(smoke)], "smoke"),
    ):
        found = pipeline.load(options, files)
        assert (found.study.name, found.holding) == (name, {"cases-c"})
    assert pipeline.load({}, [], main=False).holding is None


def test_what_cannot_be_loaded_is_told(checked, monkeypatch, tmp_path):
    for options, files, told in (
        ({"stduy": "config/smoke.yaml"}, [], "--config stduy: unknown; allowed is study=FILE"),
        ({"study": "config/smoke.yaml"}, ["config/paper.yaml"], "found several studies"),
        ({}, ["config/smoke.yaml", "config/paper.yaml"], "found several studies"),
    ):
        with pytest.raises(InputError, match=told):
            pipeline.load(options, files)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="the code would come from"):
        pipeline.load({}, [])


def test_a_plan_that_is_not_checked_lets_every_job_be(plan):
    assert plan.again("cases", "c") == []
    plan.holding = frozenset({"cases-c"})
    assert plan.again("cases", "c") == []
    assert plan.again("cases", "b") == [plan.places.again]


@pytest.mark.parametrize("stage", sorted(STAGES))
def test_all_committed_files_of_a_stage_exist(plan, stage):
    files, unused = pipeline._files(stage, *([ARGUMENTS[stage]] if stage in ARGUMENTS else []))
    assert all(file.is_file() for file in files)
    assert all(file.is_file() for file in unused)
    assert bool(files) == (stage in pipeline._COMMITTED or stage == "figure")
    assert bool(unused) == (stage in ("figure", "printed"))


def test_the_committed_files_of_some_stages(plan):
    def names(stage, *arguments):
        return [file.name for file in pipeline._files(stage, *arguments)[0]]

    style = "gearmesh.mplstyle"
    assert names("why") == ["why.ipynb", style, "points.html.j2", "parts.html.j2"]
    assert names("figure", "fig2") == ["fig2.ipynb", style, "claims.html.j2"]
    pages = ["notebook.html.j2", "base.html.j2", "report.css"]
    assert names("notebook_pages") == pages
    assert {"explorer.html.j2", "explorer.css"} <= {*names("explorer")}
    assert any(name.endswith(".js") for name in names("explorer"))
    assert {"fig7.rst", "lyapunov.rst", "report.css", "claims.yaml"} <= {*names("report")}
    assert names("identification_notebook")[-1] == "identification.html.j2"
    # A figure depends on no checks but its own, and those that its own import.
    _, unused = pipeline._files("figure", "fig6")
    checks = {provenance.module(f"reproduction/claims/{name}").name for name in paths.CHECKED}
    assert {file.name for file in unused} == checks - {"fig5.py", "fig6.py"}


def test_the_facts_of_a_job_are_the_parts_of_the_study_that_it_depends_on(plan):
    facts = pipeline._FACTS
    pair, cases, written = facts["cases"](plan, "c")
    assert pair == plan.pair
    assert cases[0][:2] == ("c-material", 0.6)
    assert len(cases) == len(plan.letters["c"])
    assert written == (plan.study.plan.case_files, plan.study.plan.direction)
    assert facts["branches"](plan)[-1] == plan.study.plan.nu.all
    claims = facts["figure"](plan, "fig2")[-1]
    assert [one.id for one in claims] == [f"F2.{n}" for n in range(1, 8)]
    assert {one.figure for one in facts["printed"](plan)[-1]} == {"printed"}
    assert facts["ledger"](plan) == plan.ledger
    grid = dict(facts["datasets"](plan)[-1])
    assert grid["c-material"][0] == 0.6 and grid["c-material"][-1] == 1.2
    stated = dict(facts["crate"](plan)[-1])
    assert stated["Snakefile"] == provenance.digest([Path("Snakefile")])
    assert [*stated] == [str(path) for path in inputs(plan.study)]
    title, _, mechanisms = facts["why"](plan)
    assert (title, mechanisms) == (plan.study.title, plan.mechanisms)
    name, parameters, plain = facts["explorer"](plan)
    assert (name, parameters) == ("paper", plan.study.pair.parameters)
    assert '"title"' in plain


def test_the_report_depends_on_what_the_verification_found(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    places = Places("mine")
    assert pipeline._verified(places) is None
    places.folder.mkdir(parents=True)
    places.verification.write_text("found")
    assert pipeline._verified(places) == hashlib.sha256(b"found").hexdigest()


def test_only_jobs_of_cases_mind_foreign_case_files(plan, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    known, foreign = (plan.places.case("c-material", nu) for nu in (0.6, 0.7))
    for file in (known, foreign):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch()
    written = Manifest("0", {known.relative_to(plan.places.folder).as_posix(): "0"})
    assert plan._foreign("cases", written, ["c"]) == ["cases/c-material/nu-0.7000.nc"]
    assert plan._foreign("cases", written, ["b"]) == []
    assert plan._foreign("datasets", written, []) == []


def test_the_inputs_of_a_study_in_their_order(plan, bare):
    names = [path.as_posix() for path in inputs(plan.study)]
    rules = [path.as_posix() for path in sorted(Path("workflow/rules").glob("*.smk"))]
    notebooks = [path.as_posix() for path in sorted(Path("notebooks").glob("*.ipynb"))]
    end = [path.as_posix() for path in (layout.IDENTIFIED, layout.SETTINGS)]
    assert names == [
        *("Snakefile", *rules, "config/paper.yaml"),
        *("config/claims.yaml", *notebooks),
        *(*end, "requirements.lock", "CITATION.cff"),
    ]
    assert (ROOT / "config" / "paper.yaml") in inputs(bare.study)
