"""Every command and every Python block that README and docs print, run as printed.

The blocks of a page run one after the other in a copy of the project: each command in a process,
Python blocks in one, as a reader would type them into one session. A YAML block that begins with
the name of a file becomes that file. Code cells of the site are run by `make docs`.
"""

import re
import shlex
import subprocess
from pathlib import Path
from subprocess import CompletedProcess
from typing import NamedTuple

import pytest
from project import ROOT, Project
from python_process import PATIENCE

PAGES = sorted(
    path.relative_to(ROOT).as_posix()
    for path in (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md"))
    if "_build" not in path.parts
)
FENCE = re.compile(
    r"^(?P<indent> *)```(?P<kind>[^\n`]*)\n(?P<code>.*?)^(?P=indent)```", re.M | re.S
)
SHELL = ("", "sh", "bash", "console")
SHOWN = ("text", "yaml")
"""Kinds that are only read: files, output, and code that belongs into a file."""

PAPER = "results/paper"
SMOKE = "config/smoke.yaml"

ELSEWHERE = {
    "make reproduce": "tests/workflow/test_workflow.py runs the same targets on a small study",
    "make test": "runs this test",
    "make test-fast": "is a part of make test",
    "make verify": "tests/verification runs it on single cases",
    "make mutants": "takes hours, and runs the tests again and again",
    "make lint": ".ci/run runs it",
    "make docs": ".ci/run runs it",
    "make identify": "tests/identification/test_samples.py runs a small design",
    ".venv/bin/pre-commit install": "changes the hooks of the repository that it runs in",
    ".venv/bin/snakemake --profile profiles/slurm": "tests/workflow/test_slurm.py runs it",
    "snakemake --profile profiles/slurm": "tests/workflow/test_slurm.py runs it",
    ".venv/bin/snakemake --config study=config/mine.yaml": "all of the paper's cases; "
    "docs/howto/pair.md does the same with fewer",
    "snakemake": "as make reproduce",
    "snakemake data": "tests/workflow/test_workflow.py runs it on a small study",
    "snakemake results/paper/cases/c-material/nu-0.6600.nc": "computes a letter of the paper",
    "snakemake all --report report.zip": "needs the results of make reproduce",
}
"""Commands that do not run here, each with what runs it instead."""


class Block(NamedTuple):
    """A fenced block of a page."""

    kind: str
    code: str


def blocks(page: str) -> list[Block]:
    text = (ROOT / page).read_text(encoding="utf-8")
    found = []
    for match in FENCE.finditer(text):
        lines = match["code"].splitlines()
        code = "\n".join(line.removeprefix(match["indent"]) for line in lines)
        found.append(Block(match["kind"].strip(), code))
    return found


def commands(code: str) -> list[str]:
    """Return the commands of a shell block: prompts, comments and output aside."""
    joined = code.replace("\\\n", " ")
    lines = [re.sub(r"\s+# .*", "", line).strip() for line in joined.splitlines()]
    if any(line.startswith("$ ") for line in lines):
        lines = [line[2:] for line in lines if line.startswith("$ ")]
    return [" ".join(line.split()) for line in lines if line and not line.startswith("#")]


def here(command: str) -> bool:
    """Return whether a command runs here; `make X CORES=2` counts as `make X`."""
    plain = " ".join(word for word in command.split() if not re.fullmatch(r"[A-Z]+=\S+", word))
    return plain not in ELSEWHERE


def run(command: str, project: Project) -> CompletedProcess[str]:
    """Run a shell command; Python's own without importing again what takes long."""
    words = shlex.split(command)
    if (name := words[0].removeprefix(".venv/bin/")) in ("gearmesh", "snakemake"):
        return project.start_python("-m", name, *words[1:]).wait()
    return subprocess.run(
        ["bash", "-c", command],
        cwd=project.folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=PATIENCE,
        check=False,
    )


def executed(page: str) -> list[str]:
    """Return the commands and the Python blocks of a page that run here."""
    found = []
    for block in blocks(page):
        if block.kind in SHELL:
            found += filter(here, commands(block.code))
        elif block.kind == "python":
            found.append(block.code)
    return found


@pytest.mark.parametrize("page", [page for page in PAGES if executed(page)])
def test_what_a_page_prints_works_as_printed(
    page: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    if any(SMOKE in code for code in executed(page)):  # there already, and found up to date
        project = request.getfixturevalue("smoke").copy(tmp_path / "project")
    else:
        project = Project.create(tmp_path / "project", "config/paper.yaml")
    if any(PAPER in code for code in executed(page)):
        smoke = request.getfixturevalue("smoke")  # the paper's study, only smaller
        project.path(PAPER).parent.mkdir()
        project.path(PAPER).symlink_to(smoke.path("results/smoke"))
    python = []
    for block in blocks(page):
        if block.kind == "yaml" and (name := re.match(r"# (\S+\.yaml)\n", block.code)):
            project.path(name[1]).write_text(block.code, encoding="utf-8")
        elif block.kind in SHELL:
            for command in filter(here, commands(block.code)):
                finished = run(command, project)
                assert finished.returncode == 0, f"{command}\n\n{finished.stdout}"
        elif block.kind == "python":
            python.append(block.code)
    if python:
        project.path("blocks.py").write_text("\n".join(python), encoding="utf-8")
        finished = project.start_python("blocks.py").wait()
        assert finished.returncode == 0, finished.stdout


@pytest.mark.parametrize("page", PAGES)
def test_each_block_says_what_it_is(page: str) -> None:
    kinds = {block.kind for block in blocks(page) if not block.kind.startswith("{")}
    assert kinds <= {*SHELL, *SHOWN, "python"}


def test_what_runs_elsewhere_is_printed_somewhere() -> None:
    printed = {
        " ".join(command.split())
        for page in PAGES
        for block in blocks(page)
        if block.kind in SHELL
        for command in commands(block.code)
    }
    assert [command for command in ELSEWHERE if command not in printed] == []


def test_what_runs_elsewhere_names_a_test_or_a_step_that_is_there() -> None:
    named = {name for how in ELSEWHERE.values() for name in re.findall(r"[\w.]+/[\w/.]+\w", how)}
    assert [name for name in named if not (ROOT / name).exists()] == []
    steps = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    run_there = [command for command, how in ELSEWHERE.items() if ".ci/run" in how]
    assert [command for command in run_there if command not in steps] == []
