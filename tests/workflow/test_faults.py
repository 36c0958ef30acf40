"""Faults during a run: a rerun ends with the same bytes, or its message gives the remedy.

Real runs of real processes, on a tiny study.
"""

import contextlib
import fcntl
import os
import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from project import Project

from gearmesh.data.datasets import open_dataset

KILLS = 10

BRIEF = """\
base: paper.yaml
nu: {start: 0.6, stop: 0.8, step: 0.2}
variants: [c-material]
strong_damping: null
time_courses: null
"""
"""Two cases."""


@pytest.fixture(scope="module")
def brief(tmp_path_factory: pytest.TempPathFactory) -> Project:
    """Two cases and their datasets."""
    project = Project.create(tmp_path_factory.mktemp("brief") / "project", "config/brief.yaml")
    project.path(project.config).write_text(BRIEF)
    finished = project.run("data")
    assert finished.returncode == 0, finished.stdout
    return project


@pytest.fixture
def fresh(brief: Project, tmp_path: Path) -> Project:
    """The same without results; what is compiled is there."""
    project = brief.copy(tmp_path / "project")
    shutil.rmtree(project.path("results"))
    shutil.rmtree(project.path(".snakemake"))
    return project


def heals(project: Project, undisturbed: Project) -> bool:
    """Run again, and return whether the results are as if nothing had happened."""
    finished = project.run("data")
    assert finished.returncode == 0, finished.stdout
    return project.results() == undisturbed.results()


@contextlib.contextmanager
def mounted(folder: Path, options: str):
    """Mount a small file system, where this machine lets us."""
    folder.mkdir(exist_ok=True)
    command = ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder)]
    if os.geteuid() or shutil.which("mount") is None:
        pytest.skip("mounting a file system needs root")
    if subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip("this machine does not let us mount a file system")
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=False)


def workers(project: Project) -> list[int]:
    """Return the processes that compute cases for this project."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            words = (process / "cmdline").read_bytes().split(b"\0")
            if Path(os.readlink(process / "cwd")) == project.folder and words[1:4] == [
                *(b"-m", b"gearmesh.pipeline", b"cases"),
            ]:
                found.append(int(process.name))
    return found


def written(project: Project) -> int:
    """Return how many files and folders of results there are, temporary ones included."""
    return len([*project.path("results").rglob("*")])


@pytest.mark.parametrize("tenth", range(KILLS // 2))
def test_a_run_that_is_killed_twice_heals(brief, fresh, tenth):
    """kill -9 as files appear, in ten steps: of all processes, or of Snakemake alone."""
    for step, to_all in ((tenth, bool(tenth % 2)), (tenth + KILLS // 2, True)):
        run = fresh.start("data")
        run.wait_for(lambda step=step: written(fresh) >= written(brief) * step / KILLS)
        time.sleep(random.Random(step).uniform(0, 0.2))
        run.send(signal.SIGKILL, to_all=to_all)
        run.wait()
    assert heals(fresh, brief)


def test_a_killed_worker_heals(brief, fresh):
    run = fresh.start("data")
    if found := run.wait_for(lambda: workers(fresh)):
        os.kill(found[0], signal.SIGKILL)
    assert run.wait().returncode != 0
    assert heals(fresh, brief)


def test_an_interrupted_run_heals(brief, fresh):
    run = fresh.start("data")
    run.wait_for(lambda: workers(fresh))
    run.send(signal.SIGINT)
    assert run.wait().returncode != 0
    assert heals(fresh, brief)


def test_a_full_disk_is_told_and_heals(brief, fresh):
    results = fresh.path("results")
    with mounted(results, "size=60k"):
        finished = fresh.run("data")
        assert finished.returncode != 0
        assert "the disk is full; free some space and run again" in finished.stdout
        subprocess.run(["mount", "-o", "remount,size=50m", str(results)], check=True)
        assert heals(fresh, brief)


def test_results_that_cannot_be_written_are_told(fresh):
    with mounted(fresh.path("results"), "size=1m,ro"):
        finished = fresh.run("data")
        assert finished.returncode != 0
        assert "gearmesh: error: results/brief: cannot be written" in finished.stdout


WRONG = {
    "backlsh: 40 um": "backlsh: unknown key (did you mean 'backlash'?)",
    "nu: {step: 1e-9}": "nu.step: makes 600000001 frequencies; allowed are at most",
    "title: !!python/object/apply:os.system [touch results]": "tags (!) are not supported",
}


def refusal(project: Project) -> str:
    """Run, and return the one line with which the run is refused."""
    finished = project.run("data")
    assert finished.returncode == 2
    assert "Traceback" not in finished.stdout
    (line,) = (line for line in finished.stdout.splitlines() if line.startswith("gearmesh:"))
    return line


@pytest.mark.parametrize("text", WRONG)
def test_a_wrong_configuration_is_told_before_anything_is_written(fresh, text):
    fresh.path("config/brief.yaml").write_text(f"base: paper.yaml\n{text}\n")
    before = sorted(fresh.folder.iterdir())
    line = refusal(fresh)
    assert line.startswith("gearmesh: error: config/brief.yaml: ")
    assert WRONG[text] in line
    snakemake_s_own = fresh.path(".snakemake")
    assert sorted(set(fresh.folder.iterdir()) - {snakemake_s_own}) == before


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("config/identify.yaml", "ranges: {backlash: {low: 1}}"),
        ("config/claims.yaml", "F2.1: {where: Fig. 2, figure: fig9}"),
        ("config/claims.yaml", "- F2.1"),
    ],
)
def test_a_slip_elsewhere_is_told_like_one_in_the_study(fresh, name, text):
    fresh.config = "config/smoke.yaml"  # it has a ledger
    fresh.path(name).write_text(f"{text}\n")
    assert refusal(fresh).startswith(f"gearmesh: error: {name}: ")
    assert not fresh.path("results").exists()


def test_two_runs_at_once_do_not_disturb_each_other(brief, fresh):
    running = fresh.start("data")
    running.wait_for(fresh.path("results/brief/.run.lock").exists)
    second, first = fresh.run("data"), running.wait()
    assert first.returncode == 0, first.stdout
    if second.returncode:  # it came while the first was at work
        assert "another run is at work here; wait for its end, or stop it" in second.stdout
    assert fresh.results() == brief.results()


def test_a_run_that_is_turned_away_changes_nothing(brief, tmp_path):
    project = brief.copy(tmp_path / "project")
    (project.study / "datasets" / "resonance.nc").write_bytes(b"not a dataset")
    before = project.results()
    with (project.study / ".run.lock").open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        project.edit("config/brief.yaml", "[c-material]", "[c-lubricant]")
        for path in (project.study / "batches").iterdir():
            path.unlink()
            del before[f"batches/{path.name}"]
        second = project.run("data")
    assert second.returncode
    assert "another run is at work here" in second.stdout
    assert project.results() == before


SITE = """\
import errno, fcntl
def refuse(*_):
    raise OSError(errno.ENOLCK, "No locks available")
fcntl.flock = refuse
"""


def test_it_runs_without_a_home_and_where_there_are_no_locks_one_line_warns(brief, fresh, tmp_path):
    (tmp_path / "sitecustomize.py").write_text(SITE)
    fresh.environment["PYTHONPATH"] += f":{tmp_path}"
    for name in ("HOME", "USER"):
        fresh.environment.pop(name, None)
    finished = fresh.execute(*fresh.command("data"))
    assert finished.returncode == 0, finished.stdout
    assert finished.stdout.count("has no locks") == 1
    assert fresh.results() == brief.results()


@pytest.mark.parametrize(
    "options",
    [
        ("--config", "sudy=config/brief.yaml"),
        ("--configfile", "config/smoke.yaml", "--config", "study=config/brief.yaml"),
    ],
)
def test_unknown_or_several_studies_are_refused_in_one_line(fresh, options):
    finished = fresh.start_python("-m", "snakemake", *options).wait()
    assert finished.returncode == 2
    lines = [line for line in finished.stdout.splitlines() if "gearmesh: error" in line]
    assert len(lines) == 1, finished.stdout
    assert "Traceback" not in finished.stdout


def test_a_case_that_fails_stops_nothing_else(fresh):
    """Masses so small, and damping so strong, that no step is small enough.

    Flanks with damping in contact loss only never part, so their run ends, and it is in the same
    job.
    """
    stated = {
        "damping": "1e6 N s/mm",
        "damping_length": "1e-6 mm",
        "reduced_mass": "1e-9 N s^2/mm",
        "static_deflection": "10 mm",
        # Few mesh periods, for every one of them takes two million steps.
        "teeth": "3",
        "revolutions": "1",
    }
    lines = "".join(f"{name}: {value}\n" for name, value in stated.items())
    fresh.path("config/brief.yaml").write_text(
        BRIEF.replace("[c-material]", "[c-lubricant, c-material]").replace("0.8", "0.6") + lines
    )
    finished = fresh.run("data")
    assert finished.returncode == 0, finished.stdout
    assert "not integrated" in finished.stdout
    resonance = open_dataset(fresh.path("results/brief/datasets/resonance.nc"))
    status = resonance["status"].sel(variant=["c-lubricant", "c-material"]).values
    assert (status[0] == 0).all()
    assert (status[1] > 0).all()
    assert np.isnan(resonance["y_max"].sel(variant="c-material")).all()


def test_a_kernel_that_dies_is_told_and_heals(smoke, tmp_path):
    project = smoke.copy(tmp_path / "project")
    notebook = project.path("notebooks/fig2.ipynb")
    text = notebook.read_text(encoding="utf-8")
    project.edit(
        "notebooks/fig2.ipynb",
        "from gearmesh.reproduction.claims import",
        "import os; os.kill(os.getpid(), 9)\\nfrom gearmesh.reproduction.claims import",
    )
    finished = project.run("results/smoke/figures/fig2.png")
    assert finished.returncode != 0
    assert "died" in finished.stdout
    assert "run again" in finished.stdout
    assert not project.path("results/smoke/figures/fig2.png").exists()
    assert project.path("results/smoke/notebooks/fig2.ipynb").exists()
    notebook.write_text(text, encoding="utf-8")
    assert project.run("results/smoke/figures/fig2.png").returncode == 0
    assert project.results() == smoke.results()
