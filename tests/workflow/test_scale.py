"""Studies too large for case files, cut down: they go on after a kill, and their memory is flat."""

import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from project import Project, end, wait_for

from gearmesh.data import batches
from gearmesh.study.loading import load_study

ATLAS = """\
base: atlas.yaml
study:
  nu: {start: 0.6, stop: 1.2, step: 0.025}
  cases_per_job: 92
"""
"""The atlas on a coarse grid: 550 cases in 6 batches."""


@pytest.fixture
def atlas(tmp_path: Path) -> Project:
    project = Project.create(tmp_path / "project", "config/coarse.yaml")
    project.path("config/coarse.yaml").write_text(ATLAS)
    return project


def finished(project: Project) -> dict[Path, int]:
    """Return the batch files that are there, and when each was written."""
    found = project.path("results/batches").glob("batch-*.nc")
    return {path: path.stat().st_mtime_ns for path in found}


def test_a_killed_atlas_keeps_its_batches_and_ends_with_the_same_bytes(atlas, tmp_path):
    undisturbed = atlas.copy(tmp_path / "undisturbed")
    assert undisturbed.run("data").returncode == 0
    process = atlas.start("data")
    wait_for(lambda: len(finished(atlas)) >= 3, process)
    end(process, signal.SIGKILL)
    before = finished(atlas)
    assert 3 <= len(before) < 6
    again = atlas.run("data")
    assert again.returncode == 0, again.stdout
    assert atlas.results() == undisturbed.results()
    assert not any(name.startswith("cases/") for name in atlas.results())
    kept = {path for path, written in finished(atlas).items() if before.get(path) == written}
    assert len(kept) >= len(before) - 2  # two may have been under way
    study = load_study(atlas.path(atlas.config))
    parts = batches.partition(study.cases, study.study.cases_per_job)
    computed = sum(len(part.cases) for part in parts if f"{part.name}.nc" not in names(kept))
    assert re.search(rf"cases: {computed} computed", again.stdout), again.stdout


def names(files: set[Path]) -> set[str]:
    return {file.name for file in files}


DATASETS = """\
import resource, sys
from pathlib import Path
import numpy as np
from gearmesh.data import batches, casefile, datasets
from gearmesh.study.loading import load_study
from gearmesh.solvers.response import Response

folder, count = Path(sys.argv[1]), int(sys.argv[2])
grid = f"{{start: 0.6, stop: {0.6 + (count - 1) * 1e-4:.4f}, step: 1e-4}}"
study = load_study("config/paper.yaml", [
    f"study.nu={grid}", "study.variants=[b-material, b-lubricant, c-material, c-lubricant]",
    "study.strong_damping=", "study.time_courses={}"])
cases = study.cases
# Only sizes matter here: sixty extrema a case, as light bodies have them.
many = np.linspace(0.0, 1.0, 60)
response = Response("ok", 9.5, many, many, np.ones(60, np.int8))
row = casefile.record(response, study.pair)
files = []
for batch in batches.partition(cases, 600):
    files.append(folder / f"{batch.name}.nc")
    stated = batches.attributes(study.pair, batch)
    batches.write_batch(files[-1], stated, batch, [row] * len(batch.cases))
datasets.write_datasets(study, files, folder / "resonance.nc", folder / "bifurcation.nc")
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)
"""


def peak(root: Path, folder: Path, count: int) -> int:
    """Return the MB that batches of some frequencies and their datasets take at the most."""
    folder.mkdir()
    command = [sys.executable, "-c", DATASETS, str(folder), str(count)]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return int(done.stdout)


def test_memory_does_not_grow_with_the_number_of_cases(root, tmp_path):
    """Eight times the cases, in batches of the same size."""
    small, large = peak(root, tmp_path / "small", 600), peak(root, tmp_path / "large", 4800)
    assert large < small + 25
