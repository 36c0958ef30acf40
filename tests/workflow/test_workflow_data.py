"""Cases and datasets of a tiny study: what is kept, what is computed, and always the same bytes."""

import os
import re
import shutil
from pathlib import Path

import pytest
from project import Project

CASE = "results/cases/c-lubricant/nu-0.8000.nc"
DATASET = "results/datasets/bifurcation.nc"


@pytest.fixture
def copied(tiny: Project, tmp_path: Path) -> Project:
    return tiny.copy(tmp_path / "project")


def counts(project: Project) -> tuple[int, int]:
    """Run, and return how many cases were computed and kept; (0, 0) if no job looked at them."""
    finished = project.run("data")
    assert finished.returncode == 0, finished.stdout
    told = re.search(r"cases: (\d+) computed, (\d+) kept", finished.stdout)
    return (int(told[1]), int(told[2])) if told else (0, 0)


def cut_short(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:5000])


def alter_a_byte(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def alter_secretly(path: Path) -> None:
    times = path.stat()
    alter_a_byte(path)
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))


@pytest.mark.parametrize(
    ("name", "harm"),
    [
        (CASE, Path.unlink),
        (CASE, cut_short),
        (CASE, alter_a_byte),
        (DATASET, cut_short),
        (DATASET, alter_secretly),
    ],
)
def test_a_lost_or_damaged_file_is_made_again(tiny, copied, name, harm):
    harm(copied.path(name))
    computed, _ = counts(copied)
    assert computed == (1 if name == CASE else 0)
    assert copied.results() == tiny.results()


def test_a_damaged_batch_file_is_made_again_from_the_cases(tiny, copied):
    alter_secretly(copied.path("results/batches/batch-0001.nc"))
    assert counts(copied)[0] == 0
    assert copied.results() == tiny.results()


def test_a_plan_names_a_lost_case_file_and_leaves_a_damaged_one(copied):
    copied.path(CASE).unlink()
    assert copied.plan("data") == {"cases_1", "datasets", "data"}
    other = copied.path("results/cases/c-material/nu-0.8000.nc")
    alter_secretly(other)
    copied.plan("data")
    assert other.exists()


def test_a_case_file_can_be_asked_for_by_its_name(tiny, copied):
    copied.path(CASE).unlink()
    assert copied.run(CASE).returncode == 0
    assert copied.results() == tiny.results()


def test_results_without_snakemake_s_records_are_not_taken_on_trust(tiny, copied):
    shutil.rmtree(copied.path(".snakemake"))
    copied.edit("config/paper.yaml", "damping: 3.9537", "damping: 4.1")
    assert counts(copied) == (10, 4)
    assert copied.results()["datasets/resonance.nc"] != tiny.results()["datasets/resonance.nc"]


def test_a_touched_case_file_reruns_nothing(copied):
    copied.path(CASE).touch()
    assert copied.plan("data") == set()


def test_another_damping_keeps_the_conservative_cases_and_may_be_undone(tiny, copied, tmp_path):
    """A study that shares the folder writes the same case files, and fewer batches."""
    other = "base: tiny.yaml\nprinted: {damping: 4.1 N s/mm}\nstudy: {cases_per_job: 100}\n"
    fresh = Project.create(tmp_path / "fresh", "config/tiny.yaml")
    for project in (copied, fresh):
        project.config = "config/other.yaml"
        project.path(project.config).write_text(other)
    assert counts(copied) == (10, 4)
    assert counts(fresh) == (14, 0)
    assert without_batches(copied) == without_batches(fresh)
    changed = {name for name, digest in copied.results().items() if tiny.results()[name] != digest}
    # Their files state the parameters of the study, and are written again for that.
    assert {"cases/a-conservative/nu-0.6000.nc", "datasets/resonance.nc"} <= changed
    copied.config = tiny.config
    assert counts(copied) == (10, 4)
    assert copied.results() == tiny.results()


def test_more_frequencies_keep_the_cases_that_exist(tiny, copied):
    copied.edit(
        "config/tiny.yaml",
        "nu: {start: 0.6, stop: 1.2, step: 0.2}",
        "nu: {start: 0.6, stop: 1.2, step: 0.2, values: [0.7]}",
    )
    assert counts(copied) == (3, 14)
    cases = {name: d for name, d in tiny.results().items() if name.startswith("cases/")}
    assert cases.items() <= copied.results().items()


def test_another_factor_of_the_strong_damping_computes_its_cases(copied):
    copied.edit("config/tiny.yaml", "factor: 5", "factor: 6")
    assert counts(copied)[0] == 2


def test_another_size_of_batches_computes_nothing_and_changes_no_byte(tiny, copied):
    copied.edit("config/tiny.yaml", "cases_per_job: 7", "cases_per_job: 4")
    assert counts(copied) == (0, 14)
    assert without_batches(copied) == without_batches(tiny)


def test_cores_batches_order_and_place_change_no_byte_of_a_fresh_run(tiny, tmp_path):
    """One core, smaller batches, the last one first, odd names, and memory that is not blank."""
    fresh = Project.create(tmp_path / "a folder", "config/a study, été.yaml")
    fresh.path("config/tiny.yaml").rename(fresh.path(fresh.config))
    fresh.edit(fresh.config, "cases_per_job: 7", "cases_per_job: 5")
    fresh.environment |= {"MALLOC_PERTURB_": "77"}
    assert fresh.run("results/batches/batch-0002.nc", cores=1).returncode == 0
    assert fresh.run("data", cores=1).returncode == 0
    assert without_batches(fresh) == without_batches(tiny)


def test_a_study_without_case_files_gives_the_same_datasets(tiny, tmp_path):
    fresh = Project.create(tmp_path / "fresh", "config/tiny.yaml")
    fresh.edit("config/tiny.yaml", "cases_per_job: 7", "cases_per_job: 7\n  case_files: false")
    assert counts(fresh) == (14, 0)
    assert without_batches(fresh) == {
        name: digest for name, digest in tiny.results().items() if name.startswith("datasets/")
    }
    fresh.path("results/batches/batch-0001.nc").unlink()
    assert counts(fresh) == (7, 0)


def without_batches(project: Project) -> dict[str, str]:
    return {n: d for n, d in project.results().items() if not n.startswith("batches/")}
