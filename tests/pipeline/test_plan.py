"""What a job is made of, and when its manifest holds: the decisions about what reruns."""

import os
import shutil
import subprocess
from dataclasses import replace

import pytest
from project import COPIED, ROOT, TINY

from gearmesh.data import manifest, paths, provenance
from gearmesh.errors import InputError
from gearmesh.pipeline import plan as pipeline
from gearmesh.pipeline.inputs import inputs
from gearmesh.pipeline.plan import Plan
from gearmesh.study.loading import load_study


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A project without its code, with a small study, as the current folder."""
    for name in COPIED:
        if name != "src" and (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, tmp_path / name)
        elif name != "src":
            shutil.copy2(ROOT / name, tmp_path)
    (tmp_path / "config" / "tiny.yaml").write_text(TINY)
    monkeypatch.chdir(tmp_path)
    pipeline._commands.cache_clear()
    provenance._file_digest.cache_clear()
    return tmp_path


@pytest.fixture
def plan(place):
    return Plan(load_study("config/tiny.yaml"))


@pytest.fixture
def written(plan):
    """A manifest of the job cases-c, with files that it wrote and read."""
    folder = plan.places.folder
    files = [plan.places.batch("c"), plan.places.case("c-material", 0.6)]
    read = folder / "read.txt"
    for file in (*files, read):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(file.name)
    path = plan.places.manifest("cases-c")
    manifest.write(path, folder, plan.made_of("cases", "c"), files, [read])
    return path


def test_a_job_whose_manifest_holds_does_not_run_again(plan, written, capsys):
    held = replace(plan, holding=plan.check())
    assert held.holding == {"cases-c"}
    assert held.again("cases", "c") == []
    assert held.again("cases", "a") == [plan.places.again]
    assert capsys.readouterr().err == ""


def test_the_input_that_makes_a_job_run_is_newer_than_everything(plan, written):
    plan.check()
    first = plan.places.again.read_text()
    assert plan.places.again.stat().st_mtime > 4.2e9
    plan.check()
    assert plan.places.again.read_text() != first


@pytest.mark.parametrize("name", ["batches/c.nc", "cases/c-material/nu-0.6000.nc", "read.txt"])
@pytest.mark.parametrize("kind", ["missing", "damaged"])
def test_a_changed_file_breaks_the_manifest(plan, written, capsys, name, kind):
    path = plan.places.folder / name
    path.unlink() if kind == "missing" else path.write_text("other")
    assert plan.check() == frozenset()
    printed = capsys.readouterr().err
    assert f"{path}: {kind}; to be made again: cases-c" in printed


def test_several_faults_are_counted(plan, written, capsys):
    for name in ("batches/c.nc", "read.txt"):
        (plan.places.folder / name).unlink()
    plan.check()
    assert "batches/c.nc (and 1 more): missing" in capsys.readouterr().err


def test_a_foreign_case_file_breaks_the_manifest(plan, written, capsys):
    plan.places.case("c-material", 0.7).write_text("foreign")
    assert plan.check() == frozenset()
    assert "nu-0.7000.nc: not of this study" in capsys.readouterr().err


def test_case_files_of_other_letters_are_not_its_concern(plan, written):
    other = plan.places.case("b-material", 0.7)
    other.parent.mkdir(parents=True)
    other.write_text("foreign")
    assert plan.check() == {"cases-c"}


@pytest.mark.parametrize("text", ["# made of another\n", "nonsense\n", ""])
def test_a_job_made_of_something_else_runs_again(plan, written, capsys, text):
    written.write_text(text)
    assert plan.check() == frozenset()
    assert "other parameters or code; to be made again: cases-c" in capsys.readouterr().err


def test_a_manifest_of_a_job_that_the_study_does_not_have_does_not_hold(plan, written):
    for name in ("cases-h", "nonsense", "cases-c-d"):
        shutil.copy(written, written.with_name(f"{name}.sha256"))
    assert plan.check() == {"cases-c"}


JOBS = [("cases", "c"), ("datasets",), ("thresholds",), ("report",), ("crate",), ("hashes",)]

EDITS = {
    "backlash: 9 y_st\n": {"cases", "datasets", "thresholds", "report", "crate"},
    "title: Another\n": {"datasets", "report", "crate"},
    "case_files: false\n": {"cases", "report", "crate"},
    "tolerance: 1e-9\n": {"cases", "datasets", "thresholds", "report", "crate"},
    "nu: {start: 0.6, stop: 1.2, step: 0.3}\n": {"cases", "datasets", "report", "crate"},
    "# a comment\n": {"crate"},
}


@pytest.mark.parametrize("edit", EDITS)
def test_an_edit_of_the_study_changes_what_jobs_are_made_of(place, plan, edit):
    before = {job[0]: plan.made_of(*job) for job in JOBS}
    text = "".join(line for line in TINY.splitlines(True) if not edit.startswith(line[:6]))
    (place / "config" / "tiny.yaml").write_text(text + edit)
    provenance._file_digest.cache_clear()
    changed = Plan(load_study("config/tiny.yaml"))
    assert {job[0] for job in JOBS if changed.made_of(*job) != before[job[0]]} == EDITS[edit]


@pytest.mark.parametrize(
    ("rules", "old", "new", "expected"),
    [
        ("cases", "2>&1 | tee {log}", "2>&1 | tee -i {log}", {"cases", "crate"}),
        ("hashes", "{params.made_of} --read", "{params.made_of}  --read", {"hashes", "crate"}),
        ("report", "{input.shown}", " {input.shown}", {"report", "crate"}),
        ("study", 'report "$STUDY"', 'report  "$STUDY"', {"report", "crate"}),
        ("hashes", "# One file", "# A file", {"crate"}),
    ],
)
def test_the_command_of_a_rule_is_part_of_its_job(place, plan, rules, old, new, expected):
    before = {job[0]: plan.made_of(*job) for job in JOBS}
    path = place / "workflow" / "rules" / f"{rules}.smk"
    path.write_text(path.read_text().replace(old, new))
    pipeline._commands.cache_clear()
    provenance._file_digest.cache_clear()
    edited = Plan(plan.study)
    assert {job[0] for job in JOBS if edited.made_of(*job) != before[job[0]]} == expected


def test_jobs_of_one_stage_are_made_of_different_things(plan):
    assert plan.made_of("cases", "a") != plan.made_of("cases", "c")


def test_a_figure_depends_on_its_own_checks_only(plan):
    files, unused = pipeline._files("figure", "fig2")
    own, other = (provenance.module(f"reproduction/claims/{name}") for name in ("fig2", "fig3"))
    assert paths.notebook("fig2") in files
    assert other in unused and own not in unused
    files, unused = pipeline._files("printed")
    assert files == [] and other in unused


def test_the_inputs_of_a_study_are_named(place, plan):
    names = [path.as_posix() for path in inputs(plan.study)]
    assert names[0] == "Snakefile"
    assert {"config/tiny.yaml", "config/smoke.yaml", "config/paper.yaml"} <= {*names}
    assert "config/claims.yaml" not in names  # a study of one's own has no ledger
    paper = [path.as_posix() for path in inputs(load_study("config/paper.yaml"))]
    assert {"config/claims.yaml", "notebooks/fig2.ipynb", "requirements.lock"} <= {*paper}


def test_a_plan_is_refused_in_one_line(place):
    for options, files in (({"stduy": "x"}, []), ({"study": "config/tiny.yaml"}, ["other.yaml"])):
        with pytest.raises(InputError) as refused:
            pipeline.load(options, files)
        assert "\n" not in str(refused.value)


def test_a_user_without_a_name_gets_one(monkeypatch):
    def unknown() -> str:
        raise KeyError("uid not found")

    monkeypatch.setattr(pipeline.getpass, "getuser", unknown)
    monkeypatch.setenv("USER", "")
    pipeline._name_the_user()
    assert os.environ["USER"] == str(os.getuid())


def test_each_command_finds_python_and_the_study(plan):
    prefix = pipeline.prefix(plan)
    assert prefix.startswith("set -euo pipefail; ")
    assert " STUDY=config/tiny.yaml " in prefix
    settings = ("NUMBA_DISABLE_JIT", "PYTHONDONTWRITEBYTECODE", "PYTHONOPTIMIZE", "PYTHONWARNINGS")
    caller = os.environ | dict.fromkeys(settings, "1")
    seen = subprocess.run(
        ["bash", "-c", prefix + "env"], env=caller, capture_output=True, text=True, check=True
    )
    assert not any(f"{name}=" in seen.stdout for name in settings)
