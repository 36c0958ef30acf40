"""Cases and datasets of a tiny study: what is kept, what is computed, and always the same bytes."""

import os
import re
import shutil
import signal
from pathlib import Path
from subprocess import CompletedProcess

import pytest
from project import Project

CASE = "cases/c-lubricant/nu-0.8000.nc"
CONSERVATIVE = "cases/a-conservative/nu-0.6000.nc"
DATASET = "datasets/bifurcation.nc"

STUDY_OF_ONE_LETTER = """\
base: tiny.yaml
variants: [a-conservative]
strong_damping: null
"""


@pytest.fixture
def copied(tiny: Project, tmp_path: Path) -> Project:
    return tiny.copy(tmp_path / "project")


def counts(project: Project) -> tuple[int, int]:
    """Run, and return how many cases were computed and kept; (0, 0) if no job processed them."""
    finished = project.run("data")
    assert finished.returncode == 0, finished.stdout
    return counted(finished)


def counted(finished: CompletedProcess[str]) -> tuple[int, int]:
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


HARMS = (
    {
        CONSERVATIVE: (alter_secretly, "damaged"),
        CASE: (Path.unlink, "missing"),
        DATASET: (alter_secretly, "damaged"),
    },
    {CONSERVATIVE: (cut_short, "damaged"), "batches/c.nc": (alter_secretly, "damaged")},
)
"""One file of each job, because a job gives one reason."""


@pytest.mark.parametrize("harms", HARMS, ids=" and ".join)
def test_a_lost_or_damaged_file_is_named_and_made_again(tiny, copied, harms):
    for name, (harm, _) in harms.items():
        harm(copied.study / name)
    finished = copied.run("data")
    assert finished.returncode == 0, finished.stdout
    for name, (_, kind) in harms.items():
        assert f"gearmesh: results/tiny/{name}: {kind}; to be made again" in finished.stdout
    cases = [name for name in harms if name.startswith("cases/")]
    assert counted(finished) == (len(cases), 14 - len(cases))
    assert copied.results() == tiny.results()


def test_a_dry_run_deletes_no_data(copied):
    alter_secretly(copied.study / CASE)
    before = {path for path in copied.study.rglob("*.nc")}
    assert copied.plan("data") == {"cases-c", "datasets"}
    assert {path for path in copied.study.rglob("*.nc")} == before


def test_text_in_a_title_damages_nothing(copied):
    copied.edit("config/tiny.yaml", "A few cases", "# made of gearmesh-seal 0123456789abcdef")
    assert counts(copied) == (0, 0)
    assert counts(copied) == (0, 0)


def test_a_case_file_can_be_asked_for_by_its_name(tiny, copied):
    cases = [f"results/tiny/cases/c-lubricant/nu-{nu}.nc" for nu in ("0.6000", "0.8000", "1.0000")]
    for case in cases:
        copied.path(case).unlink()
    plain, dotted, absolute = cases
    finished = copied.run(plain, f"./{dotted}", f"{copied.folder}/{absolute}")
    assert finished.returncode == 0, finished.stdout
    assert copied.results() == tiny.results()
    assert counts(copied) == (0, 0)


def test_a_case_file_is_never_that_of_another_study(tiny, copied):
    """Studies do not share a folder, also where one of the same name ran in between."""
    other = "base: tiny.yaml\nname: tiny\ndamping: 4.1 N s/mm\n"
    copied.path("config/other.yaml").write_text(other)
    copied.config = "config/other.yaml"
    assert copied.run(f"results/tiny/{CASE}").returncode == 0
    copied.config = tiny.config
    assert copied.results()[CASE] != tiny.results()[CASE]
    assert copied.run(f"results/tiny/{CASE}").returncode == 0
    assert copied.results()[CASE] == tiny.results()[CASE]


def test_a_case_that_the_study_does_not_have_is_refused(copied):
    finished = copied.run("results/tiny/cases/c-material/nu-0.6111.nc")
    assert finished.returncode != 0
    assert "nu-0.6111.nc: the study tiny has no such case file" in finished.stdout


def test_a_study_of_its_own_has_a_folder_of_its_own(tiny, copied):
    """Its name is that of its file."""
    copied.path("config/other.yaml").write_text(STUDY_OF_ONE_LETTER)
    copied.config = "config/other.yaml"
    assert counts(copied) == (4, 0)
    copied.config = tiny.config
    assert copied.results() == tiny.results()


def test_another_damping_keeps_the_conservative_cases_and_may_be_undone(tiny, copied):
    """Results without Snakemake's records are not taken on trust either."""
    shutil.rmtree(copied.path(".snakemake"))
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
    """One core, the last letter first, odd names, another disk, and memory that is not blank."""
    fresh = Project.create(tmp_path / "a {folder}, été", "config/tiny.yaml")
    (tmp_path / "scratch").mkdir()
    fresh.path("results").symlink_to(tmp_path / "scratch")
    fresh.environment |= {"MALLOC_PERTURB_": "77", "NUMBA_DISABLE_JIT": "1"}
    one = fresh.run("results/tiny/batches/c.nc", options=("--cores", "1"))
    assert one.returncode == 0, one.stdout
    assert fresh.run("data", options=("--cores", "1")).returncode == 0
    assert fresh.results() == tiny.results()


def test_a_study_whose_file_has_an_odd_name_needs_a_name(tiny, copied):
    copied.config = "config/a study, été.yaml"
    copied.path("config/tiny.yaml").rename(copied.path(copied.config))
    assert copied.run("data").returncode == 2
    copied.edit(copied.config, "title:", "name: tiny\ntitle:")
    copied.path(f"results/tiny/{DATASET}").unlink()
    finished = copied.run("data")
    assert f"gearmesh: results/tiny/{DATASET}: missing; to be made again" in finished.stdout
    assert counted(finished) == (0, 0)
    copied.config = tiny.config
    assert copied.results() == tiny.results()


def test_a_killed_study_without_case_files_goes_on_and_gives_the_same_datasets(tiny, tmp_path):
    """As the atlas, whose cases are in its batches only."""
    fresh = Project.create(tmp_path / "fresh", "config/tiny.yaml")
    fresh.edit("config/tiny.yaml", "title:", "case_files: false\ntitle:")
    run = fresh.start("data", options=("--cores", "1"))
    run.wait_for(lambda: len([*(fresh.study / "logs").glob("cases-*")]) == 2)  # one is finished
    run.send(signal.SIGKILL)
    run.wait()
    [kept] = (fresh.study / "manifests").glob("cases-*")
    written = kept.stat().st_mtime_ns
    assert counts(fresh) == ({"cases-a": 10, "cases-c": 4}[kept.stem], 0)
    assert kept.stat().st_mtime_ns == written
    for name in ("datasets/resonance.nc", DATASET, "batches/a.nc", "batches/c.nc"):
        assert fresh.results()[name] == tiny.results()[name]
    assert not [name for name in fresh.results() if name.startswith("cases/")]
    (fresh.study / "batches" / "c.nc").unlink()
    assert counted(fresh.run("results/tiny/batches/c.nc")) == (10, 0)
    assert fresh.plan("data") == set()
