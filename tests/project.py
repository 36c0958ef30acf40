"""A copy of the project in which the real pipeline runs, for tests that edit, break and kill."""

import functools
import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from subprocess import CompletedProcess

from python_process import PATIENCE, Run

import gearmesh as gm
from gearmesh.model.variants import variant
from gearmesh.solvers.simulation import simulate

ROOT = Path(__file__).parents[1]
COPIED = (
    *("Snakefile", "config", "docs", "notebooks", "profiles", "src", "workflow"),
    *("README.md", "CITATION.cff", "requirements.lock"),
)
TINY = """\
base: smoke.yaml
title: A few cases
nu: {start: 0.6, stop: 1.2, step: 0.2}
variants: [a-conservative, c-material, c-lubricant]
strong_damping: {variant: c-material, factor: 5, nu: {start: 0.6, stop: 0.8, step: 0.2}}
time_courses: null
"""
"""A study of 14 cases, for tests that do without figures."""


@functools.cache
def compile_solvers() -> None:
    """Compile what studies and pages run here, so that no copy of the project has to."""
    pair = gm.paper()
    simulate([pair.problem(variant("c-both"), 0.7)], estimate_errors=False)
    gm.simulate(pair, "c-both", 0.7)
    gm.find_orbit(pair, "c-lubricant", 0.9)
    gm.simulate(pair.replace(eccentricity="1 um"), "c-both", 0.7)  # by the general solver


class Project:
    """The project in a folder of its own.

    Parameters
    ----------
    folder : Path
        Where it is.
    config : str
        The study that runs there.
    """

    def __init__(self, folder: Path, config: str) -> None:
        self.folder = folder
        self.config = config
        self.environment = os.environ | {"PYTHONPATH": str(folder / "src")}
        # Every job would compile all modules again.
        self.environment.pop("PYTHONDONTWRITEBYTECODE", None)

    @classmethod
    def create(cls, folder: Path, config: str) -> "Project":
        """Copy the working tree, compiled code included."""
        compile_solvers()
        folder.mkdir(parents=True)
        for name in COPIED:
            source = ROOT / name
            if source.is_dir():
                shutil.copytree(source, folder / name)
            elif source.exists():
                shutil.copy2(source, folder / name)
        (folder / "config" / "tiny.yaml").write_text(TINY)
        return cls(folder, config)

    def copy(self, folder: Path, linked: bool = False) -> "Project":
        """Copy a project with its results and with what Snakemake knows of them.

        Parameters
        ----------
        folder : Path
            Where the copy is made.
        linked : bool
            Share the files of its results: quicker, for tests that only plan.
        """
        folder.mkdir(parents=True)
        for source in self.folder.iterdir():
            shared = linked and source.name in ("results", ".snakemake")
            if source.is_dir():
                how = os.link if shared else shutil.copy2
                shutil.copytree(source, folder / source.name, copy_function=how)
            else:
                shutil.copy2(source, folder / source.name)
        return Project(folder, self.config)

    @property
    def study(self) -> Path:
        """The folder with the results of the study."""
        return self.folder / "results" / Path(self.config).stem

    def start(self, *arguments: str, options: Sequence[str] = ()) -> Run:
        """Start a run of targets."""
        return self.start_python("-m", "snakemake", *self.command(*arguments, options=options))

    def start_python(self, *arguments: str) -> Run:
        """Start what a user types after `python`."""
        return Run(self.folder, self.environment, arguments)

    def run(self, *arguments: str, options: Sequence[str] = ()) -> CompletedProcess[str]:
        """Run targets to the end."""
        return self.start(*arguments, options=options).wait()

    def command(self, *arguments: str, options: Sequence[str] = ()) -> list[str]:
        """Return what a user types after `snakemake` for a run of targets."""
        return [*options, "--config", f"study={self.config}", "--", *arguments]

    def execute(self, *arguments: str) -> CompletedProcess[str]:
        """Execute `snakemake` in a fresh interpreter, for tests of what surrounds it."""
        return subprocess.run(
            [sys.executable, "-m", "snakemake", *arguments],
            cwd=self.folder,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=PATIENCE,
            check=False,
        )

    def plan(self, *arguments: str) -> set[str]:
        """Return the jobs that a run would execute, as their logs are called."""
        options = ("--dry-run", "--quiet", "host", "reason")
        found = self.run(*arguments, options=options)
        assert found.returncode == 0, found.stdout
        lines = [line.strip() for line in found.stdout.splitlines()]
        logs = {Path(line.removeprefix("log: ")) for line in lines if line.startswith("log: ")}
        return {log.stem for log in logs}

    def path(self, name: str | Path) -> Path:
        """Return the path of a file of the project."""
        return self.folder / name

    def edit(self, name: str, old: str, new: str) -> None:
        """Replace a text that must be there."""
        path = self.path(name)
        text = path.read_text(encoding="utf-8")
        assert old in text, f"{name} has no {old!r}"
        path.write_text(text.replace(old, new, 1), encoding="utf-8")

    def results(self) -> dict[str, str]:
        """Return every result of the study with its SHA-256; what differs from run to run aside."""
        return {
            str(path.relative_to(self.study)): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(self.study.rglob("*"))
            if path.is_file()
            and path.parent.name not in ("logs", "benchmarks")
            and path.name not in (".run.lock", ".jobs.lock", ".again")
        }
