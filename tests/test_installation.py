"""What `pip install gearmesh` brings: the library alone, and the paper's parameters with it."""

import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKED = ("src", "config", "pyproject.toml", "README.md", "LICENSE")
POSIX = ("fcntl", "grp", "pwd", "resource", "termios")
"""Modules that Windows does not have."""

WITHOUT = """
import sys
for name in {absent}:
    sys.modules[name] = None  # importing it fails
import gearmesh as gm
run = gm.simulate(gm.paper(), "c-material", nu=0.62)
assert run.y.units == "mm"
"""


def run(*command: str | Path, folder: Path, **environment: str) -> None:
    inherited = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    finished = subprocess.run(
        command,
        cwd=folder,
        env=inherited | environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a wheel that is built from a copy of the project."""
    source, output = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("wheel")
    for path in (*(ROOT / name for name in PACKED), *ROOT.glob("requirements*.in")):
        if path.is_dir():
            ignored = shutil.ignore_patterns("__pycache__", "*.egg-info")
            shutil.copytree(path, source / path.name, symlinks=True, ignore=ignored)
        else:
            shutil.copy2(path, source)
    pip = (sys.executable, "-m", "pip", "--quiet", "wheel", "--no-index", "--no-deps")
    run(*pip, "--no-build-isolation", "--wheel-dir", output, source, folder=output)
    [built] = output.glob("*.whl")
    return built


def test_a_wheel_carries_the_papers_study_itself(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        carried = archive.read("gearmesh/reproduction/paper.yaml")
    assert carried == (ROOT / "config" / "paper.yaml").read_bytes()


def test_the_library_works_from_a_wheel_without_what_only_a_study_needs(
    wheel: Path, tmp_path: Path
) -> None:
    site = tmp_path / "site"
    pip = (sys.executable, "-m", "pip", "--quiet", "install", "--no-index", "--no-deps")
    run(*pip, "--target", site, wheel, folder=tmp_path)
    lines = (ROOT / "requirements-study.in").read_text(encoding="utf-8").splitlines()
    names = [found[0] for line in lines if (found := re.match(r"[\w-]+", line))]
    absent = [*POSIX, *(name.replace("-", "_") for name in names)]
    code = WITHOUT.format(absent=absent)
    run(sys.executable, "-c", code, folder=tmp_path, PYTHONPATH=str(site))
