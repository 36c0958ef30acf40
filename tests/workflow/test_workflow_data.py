"""Cases and datasets of a tiny study: what is kept, what is computed, and always the same bytes."""

import os
import re
import shutil
from pathlib import Path

import pytest
from project import Project

CASE = "cases/c-lubricant/nu-0.8000.nc"
DATASET = "datasets/bifurcation.nc"


@pytest.fixture
def copied(tiny: Project, tmp_path: Path) -> Project:
    return tiny.copy(tmp_path / "project")


def counts(project: Project) -> tuple[int, int]:
    """Run, and return how many cases were computed and kept; (0, 0) if no job processed them."""
    finished = project.run("data")
    assert finished.returncode == 0, finished.stdout
    found = re.findall(r"(\d+) computed, (\d+) kept", finished.stdout)
    computed, kept = (sum(int(pair[i]) for pair in found) for i in (0, 1))
    return computed, kept


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
    ("name", "harm", "kind"),
    [
        (CASE, Path.unlink, "missing"),
        (CASE, cut_short, "damaged"),
        (CASE, alter_secretly, "damaged"),
        ("batches/c.nc", alter_secretly, "damaged"),
        (DATASET, Path.unlink, "missing"),
        (DATASET, alter_secretly, "damaged"),
    ],
)
def test_a_lost_or_damaged_file_is_named_and_made_again(tiny, copied, name, harm, kind):
    harm(copied.study / name)
    planned = copied.run("data", options=("--dry-run",))
    assert f"gearmesh: results/tiny/{name}: {kind}; to be made again" in planned.stdout
    computed, _ = counts(copied)
    assert computed == (1 if name == CASE else 0)
    assert copied.results() == tiny.results()


def test_a_dry_run_deletes_no_data(copied):
    alter_secretly(copied.study / CASE)
    before = {path for path in copied.study.rglob("*.nc")}
    copied.plan("data")
    assert {path for path in copied.study.rglob("*.nc")} == before


def test_text_in_a_title_damages_nothing(copied):
    copied.edit("config/tiny.yaml", "A few cases", "# made of gearmesh-seal 0123456789abcdef")
    assert counts(copied) == (0, 0)
    assert counts(copied) == (0, 0)


@pytest.mark.parametrize("form", ["{}", "./{}", "{root}/{}"])
def test_a_case_file_can_be_asked_for_by_its_name(tiny, copied, form):
    (copied.study / CASE).unlink()
    finished = copied.run(form.format(f"results/tiny/{CASE}", root=copied.folder))
    assert finished.returncode == 0, finished.stdout
    assert copied.results() == tiny.results()
    assert counts(copied) == (0, 0)


def test_a_case_file_is_never_that_of_another_study(tiny, copied):
    """Studies do not share a folder, also where one of the same name ran in between."""
    other = "base: tiny.yaml\nname: tiny\ndamping: 4.1 N s/mm\n"
    copied.path("config/other.yaml").write_text(other)
    copied.config = "config/other.yaml"
    assert copied.run("data", options=()).returncode == 0
    copied.config = tiny.config
    assert copied.results()[CASE] != tiny.results()[CASE]
    assert copied.run(f"results/tiny/{CASE}").returncode == 0
    assert copied.results()[CASE] == tiny.results()[CASE]


def test_a_case_that_the_study_does_not_have_is_refused(copied):
    finished = copied.run("results/tiny/cases/c-material/nu-0.6111.nc")
    assert finished.returncode != 0
    assert "nu-0.6111.nc: the study tiny has no such case file" in finished.stdout


def test_results_without_snakemake_s_records_are_not_taken_on_trust(tiny, copied):
    shutil.rmtree(copied.path(".snakemake"))
    copied.path("config/tiny.yaml").write_text(
        copied.path("config/tiny.yaml").read_text() + "damping: 4.1 N s/mm\n"
    )
    assert counts(copied) == (10, 4)
    assert copied.results()["datasets/resonance.nc"] != tiny.results()["datasets/resonance.nc"]


def test_a_study_of_its_own_has_a_folder_of_its_own(tiny, copied):
    copied.path("config/other.yaml").write_text("base: tiny.yaml\ndamping: 4.1 N s/mm\n")
    copied.config = "config/other.yaml"
    assert counts(copied) == (14, 0)
    copied.config = tiny.config
    assert copied.results() == tiny.results()


def test_another_damping_keeps_the_conservative_cases_and_may_be_undone(tiny, copied):
    stated = copied.path("config/tiny.yaml")
    before = stated.read_text()
    stated.write_text(f"{before}damping: 4.1 N s/mm\n")
    assert counts(copied) == (10, 4)
    changed = {name for name, digest in copied.results().items() if tiny.results()[name] != digest}
    # Their files state the parameters of the study, and are written again for that.
    assert {"cases/a-conservative/nu-0.6000.nc", "datasets/resonance.nc"} <= changed
    stated.write_text(before)
    assert counts(copied) == (10, 4)
    assert copied.results() == tiny.results()


def test_more_frequencies_keep_the_cases_that_exist_and_fewer_leave_no_orphans(tiny, copied):
    step = "nu: {start: 0.6, stop: 1.2, step: 0.2}"
    copied.edit("config/tiny.yaml", step, "nu: {start: 0.6, stop: 1.2, step: 0.2, values: [0.7]}")
    assert counts(copied) == (3, 14)
    cases = {name: d for name, d in tiny.results().items() if name.startswith("cases/")}
    assert cases.items() <= copied.results().items()
    copied.edit("config/tiny.yaml", ", values: [0.7]}", "}")
    assert counts(copied) == (0, 14)
    assert copied.results() == tiny.results()


def test_letters_and_variants_that_are_left_out_leave_no_orphans(copied):
    copied.edit("config/tiny.yaml", "[a-conservative, c-material, c-lubricant]", "[c-material]")
    assert counts(copied) == (0, 6)
    names = copied.results()
    assert {name.split("/")[1] for name in names if name.startswith("cases/")} == {
        "c-material",
        "c-material-5x",
    }
    assert "batches/a.nc" not in names
    assert not [name for name in names if "cases-a" in name]


def test_a_foreign_case_file_is_removed(tiny, copied):
    shutil.copy(copied.study / CASE, copied.study / "cases/c-lubricant/nu-0.6543.nc")
    assert counts(copied) == (0, 10)
    assert copied.results() == tiny.results()


def test_another_factor_of_the_strong_damping_computes_its_cases(copied):
    copied.edit("config/tiny.yaml", "factor: 5", "factor: 6")
    assert counts(copied)[0] == 2


def test_cores_order_and_place_change_no_byte_of_a_fresh_run(tiny, tmp_path):
    """One core, the last letter first, odd names, and memory that is not blank."""
    fresh = Project.create(tmp_path / "a {folder}, été", "config/tiny.yaml")
    fresh.environment |= {"MALLOC_PERTURB_": "77", "NUMBA_DISABLE_JIT": "1"}
    one = fresh.run("results/tiny/batches/c.nc", options=("--cores", "1"))
    assert one.returncode == 0, one.stdout
    assert fresh.run("data", options=("--cores", "1")).returncode == 0
    assert fresh.results() == tiny.results()


def test_a_study_whose_file_has_an_odd_name_needs_a_name(tiny, tmp_path):
    fresh = Project.create(tmp_path / "project", "config/a study, été.yaml")
    fresh.path("config/tiny.yaml").rename(fresh.path(fresh.config))
    assert fresh.run("data").returncode == 2
    fresh.edit(fresh.config, "title:", "name: tiny\ntitle:")
    assert fresh.run("data").returncode == 0
    fresh.config = "tiny.yaml"
    assert fresh.results() == tiny.results()


def test_results_may_be_on_another_disk(tiny, tmp_path):
    fresh = Project.create(tmp_path / "project", "config/tiny.yaml")
    (tmp_path / "scratch").mkdir()
    fresh.path("results").symlink_to(tmp_path / "scratch")
    assert fresh.run("data").returncode == 0
    assert fresh.results() == tiny.results()


def test_a_study_without_case_files_gives_the_same_datasets(tiny, tmp_path):
    fresh = Project.create(tmp_path / "fresh", "config/tiny.yaml")
    fresh.edit("config/tiny.yaml", "title:", "case_files: false\ntitle:")
    assert counts(fresh) == (14, 0)
    for name in ("datasets/resonance.nc", DATASET, "batches/a.nc"):
        assert fresh.results()[name] == tiny.results()[name]
    assert not [name for name in fresh.results() if name.startswith("cases/")]
    (fresh.study / "batches" / "c.nc").unlink()
    assert counts(fresh) == (10, 0)
