"""What tests share: the root of the project, and the study of the paper."""

import fcntl
import os
from pathlib import Path

import pytest
from hypothesis import settings
from project import Project
from small_run import compute

from gearmesh.study.cases import Study
from gearmesh.study.loading import load_study
from gearmesh.study.pair import Pair

# Compilation and a busy machine make single examples slow; tests never judge times.
settings.register_profile("gearmesh", deadline=None, derandomize=True)
settings.load_profile("gearmesh")

ROOT = Path(__file__).parents[1]

SLOW = (
    "browser",
    *("docs", "dynamics", "identification/test_samples", "interface", "reproduction/test_figures"),
    *("solvers/test_continuation", "solvers/test_full", "solvers/test_hard", "solvers/test_peers"),
    *("solvers/test_reduced", "solvers/test_series", "solvers/test_simulation"),
    *("study/test_problem", "study/test_loading"),
    *("test_commands", "test_installation", "workflow"),
)
"""Beginnings of the paths of tests that `make test-fast` leaves out."""


FIRST = ("workflow", "solvers")
"""Those that take longest, and compile; started last, they would keep one process alone busy."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if _place(item).startswith(SLOW):
            item.add_marker(pytest.mark.slow)
    items.sort(key=lambda item: not _place(item).startswith(FIRST))


def _place(item: pytest.Item) -> str:
    return item.path.relative_to(ROOT / "tests").as_posix()


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def study() -> Study:
    return load_study(ROOT / "config" / "paper.yaml")


@pytest.fixture(scope="session")
def pair(study: Study) -> Pair:
    return study.pair


@pytest.fixture(scope="session")
def small_study() -> Study:
    return load_study(ROOT / "config" / "smoke.yaml")


@pytest.fixture(scope="session")
def small_run(small_study: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a root below which the results of the smoke study stand."""
    root = tmp_path_factory.mktemp("small-run")
    compute(small_study, root)
    return root


@pytest.fixture(scope="session")
def smoke(tmp_path_factory: pytest.TempPathFactory) -> Project:
    """The smoke study, run to its end by the pipeline.

    Where several processes run the tests, one runs the study, and each has a copy.
    """
    common = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        common = common.parent
    place, output = common / "smoke-once", common / "smoke-once.txt"
    with (common / "smoke-once.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not output.exists():
            made = Project.create(place, "config/smoke.yaml")
            output.write_text(made.run("all").stdout, encoding="utf-8")
        made = Project(place, "config/smoke.yaml")
        project = made.copy(tmp_path_factory.mktemp("smoke") / "project")
    project.output = output.read_text(encoding="utf-8")
    return project


@pytest.fixture(scope="session")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Project:
    """A study of 14 cases with its datasets, made by the pipeline."""
    project = Project.create(tmp_path_factory.mktemp("tiny") / "project", "config/tiny.yaml")
    finished = project.run("data")
    assert finished.returncode == 0, finished.stdout
    return project
