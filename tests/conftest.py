"""What tests share: the root of the project, and the study of the paper."""

from pathlib import Path

import pytest
from hypothesis import settings
from small_run import compute

from gearmesh.configuration import Study, load_study
from gearmesh.parameters import Parameters

# Compilation and a busy machine make single examples slow; tests never judge times.
settings.register_profile("gearmesh", deadline=None, derandomize=True)
settings.load_profile("gearmesh")

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def study() -> Study:
    return load_study(ROOT / "config" / "paper.yaml")


@pytest.fixture(scope="session")
def parameters(study: Study) -> Parameters:
    return study.parameters


@pytest.fixture(scope="session")
def small_study() -> Study:
    return load_study(ROOT / "config" / "smoke.yaml")


@pytest.fixture(scope="session")
def small_run(small_study: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a root below which the results of the smoke study stand."""
    root = tmp_path_factory.mktemp("small-run")
    compute(small_study, root)
    return root
