"""A study too large for case files, cut down: it goes on after a kill."""

import signal
from pathlib import Path

import pytest
from project import Project

ATLAS = """\
base: atlas.yaml
title: A coarse atlas
nu: {start: 0.6, stop: 1.2, step: 0.2}
variants: [a-conservative, b-both, c-both, d-both]
"""
"""The atlas on a coarse grid: 16 cases in 4 batches."""


@pytest.fixture
def atlas(tmp_path: Path) -> Project:
    project = Project.create(tmp_path / "project", "config/coarse.yaml")
    project.path("config/coarse.yaml").write_text(ATLAS)
    return project


def finished(project: Project) -> dict[Path, int]:
    """Return the manifests that are there, and when the batch file of each was written."""
    found = (project.study / "manifests").glob("cases-*.sha256")
    return {path: path.stat().st_mtime_ns for path in found}


def test_a_killed_atlas_keeps_its_batches_and_ends_with_the_same_bytes(atlas, tmp_path):
    undisturbed = atlas.copy(tmp_path / "undisturbed")
    assert undisturbed.run("data").returncode == 0
    run = atlas.start("data", options=("--cores", "1"))
    run.wait_for(lambda: len(finished(atlas)) >= 2)
    run.send(signal.SIGKILL)
    run.wait()
    before = finished(atlas)
    assert 2 <= len(before) < 4
    again = atlas.run("data")
    assert again.returncode == 0, again.stdout
    assert atlas.results() == undisturbed.results()
    assert not any(name.startswith("cases/") for name in atlas.results())
    kept = {path for path, written in finished(atlas).items() if before.get(path) == written}
    assert len(kept) >= len(before) - 1  # one may have been under way
