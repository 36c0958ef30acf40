"""Time and space against an earlier commit, both measured in one go on this machine.

Run from the root of the project: ``python -m benchmarks.against FOLDER [ROW…]``. `FOLDER` keeps a
clone of each commit with an environment of its own, made where it is missing; what is not committed
does not count. Without rows all are measured.

Processor time is compared, not time on the clock: other work on the machine disturbs it least.
Short commands run several times, the two commits in turns, and the least time of each counts.
"""

import csv
import os
import resource
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from benchmarks.pipeline_layout import ROOT

BASE = "13961cb"
CORES = "2"
SEVERAL = 5
ADDED = ("orbits", "basins", "sweeps", "bands", "lyapunov", "special_curves", "why", "explorer")
"""Jobs that the base does not have; the rows on the study leave out what they took."""


def main() -> None:
    """Measure the rows and print them."""
    folder = Path(sys.argv[1]).resolve()
    rows = sys.argv[2:] or list(ROWS)
    print(table(folder, rows))


def table(folder: Path, rows: list[str]) -> str:
    """Return the table of some rows, with the reason for each that falls short."""
    base, here = _clone(folder / "base", BASE), _clone(folder / "here", "FETCH_HEAD")
    lines = [f"{'':32}{BASE:>10}{'here':>10}{'ratio':>8}{'asked':>8}"]
    for name in rows:
        row = ROWS[name]
        tries = [(row.measure(base), row.measure(here)) for _ in range(row.tries)]
        before, now = (min(measured) for measured in zip(*tries, strict=True))
        ratio = now / before
        lines.append(
            f"{f'{name}, {row.unit}':32}{before:10.2f}{now:10.2f}{ratio:8.2f}{row.asked:8.2f}"
            + (f"  {row.reason}" if ratio > row.asked else "")
        )
        print(lines[-1], file=sys.stderr, flush=True)
    return "\n".join(lines)


def _clone(place: Path, commit: str) -> Path:
    """Bring a clone to a commit; what was fetched last is the tip of this checkout."""
    if not place.exists():
        subprocess.run(["git", "clone", "--quiet", "--no-checkout", ROOT, place], check=True)
    subprocess.run(["git", "fetch", "--quiet", ROOT, "HEAD"], cwd=place, check=True)
    subprocess.run(["git", "checkout", "--quiet", commit], cwd=place, check=True)
    return place


def _spent(folder: Path, *command: str | Path, **more: str) -> float:
    """Run a command in a clone; return the seconds of processor time."""
    # Bytecode is kept, as on most machines; else each process would compile all modules.
    ordinary = {"PYTHONPATH": str(folder / "src"), "PYTHONDONTWRITEBYTECODE": ""}
    environment = os.environ | ordinary | more
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def _python(folder: Path) -> Path:
    if not (folder / ".venv" / ".installed").exists():
        _spent(folder, "make", ".venv/.installed")
    return folder / ".venv" / "bin" / "python"


def _snakemake(folder: Path, *arguments: str) -> float:
    return _spent(folder, _python(folder), "-m", "snakemake", "--cores", CORES, *arguments)


def _environment(folder: Path) -> float:
    shutil.rmtree(folder / ".venv", ignore_errors=True)
    return _spent(folder, "make", ".venv/.installed")


def _forget(folder: Path) -> None:
    """Remove the results, and what Snakemake knows of them."""
    for found in (folder / "results").glob("[!R]*"):
        shutil.rmtree(found) if found.is_dir() else found.unlink()
    shutil.rmtree(folder / ".snakemake", ignore_errors=True)


def _cold(folder: Path) -> float:
    for compiled in [*(folder / "src").rglob("__pycache__")]:
        shutil.rmtree(compiled)
    return _warm(folder)


def _warm(folder: Path) -> float:
    _forget(folder)
    return _snakemake(folder) - _of_jobs(folder, ADDED)


def _of_jobs(folder: Path, names: tuple[str, ...]) -> float:
    """Return the processor time of some jobs, as Snakemake measured it."""
    spent = 0.0
    for path in folder.glob("results/*/benchmarks/*.tsv"):
        [row] = csv.DictReader(path.open(), delimiter="\t")
        if path.stem.startswith(names) and row["cpu_time"] != "NA":
            spent += float(row["cpu_time"])
    return spent


def _disk(folder: Path) -> float:
    """Return the megabytes of the results, as blocks of the file system."""
    files = (file for file in (folder / "results").rglob("*") if file.is_file())
    return sum(file.stat().st_blocks for file in files) * 512 / 1e6


def _atlas(folder: Path) -> float:
    _forget(folder)
    return _snakemake(folder, "--config", "study=config/atlas.yaml", "--", "data")


def _simulate(folder: Path, **more: str) -> float:
    command = ["-m", "gearmesh", "simulate", "--config", "config/paper.yaml"]
    command += ["--variant", "c-lubricant", "--nu", "0.66", "-o", "results/one.nc"]
    return _spent(folder, _python(folder), *command, **more)


def _first(folder: Path) -> float:
    kept = folder / "results" / "compiled"
    shutil.rmtree(kept, ignore_errors=True)
    return _simulate(folder, NUMBA_CACHE_DIR=str(kept))


def _tests(folder: Path) -> float:
    return _spent(folder, _python(folder), "-m", "pytest", "-q", "-n", CORES, "--dist", "loadfile")


@dataclass(frozen=True, slots=True)
class Row:
    """What is measured, its unit, the ratio that is asked, and why it may fall short."""

    measure: Callable[[Path], float]
    unit: str
    asked: float
    reason: str
    tries: int = 1


ROWS = {
    "environment": Row(
        *(_environment, "s", 0.6),
        "more packages: JupyterLab, and what checks types, CF, RO-Crate and pages in a browser",
    ),
    "study cold": Row(*(_cold, "s", 0.55), "numba compiles kernels of the added jobs, too"),
    "study warm": Row(
        *(_warm, "s", 0.5),
        "SciPy writes a case file in 1 ms, and each of 8 jobs loads numba for the better part of a "
        "second; the rest are notebooks and the thresholds",
    ),
    "nothing to do": Row(
        *(_snakemake, "s", 0.8), "Snakemake itself takes most of it", tries=SEVERAL
    ),
    "disk": Row(
        *(_disk, "MB", 0.5),
        "a case file of 10 KB takes three blocks of 4 KB, and its numbers, names, units and "
        "parameters do not fit in two; time courses, datasets and batches are as large as before, "
        "and what the base does not have takes 13 MB",
    ),
    "gearmesh simulate": Row(
        *(_simulate, "s", 0.5),
        "two thirds of it are Python, NumPy and numba with its tables of types",
        tries=SEVERAL,
    ),
    "first compilation": Row(
        *(_first, "s", 0.6),
        "two thirds of it are passes of numba that are written in Python, whatever they compile",
    ),
    "atlas": Row(
        *(_atlas, "s", 0.5),
        "integration and compression of the datasets take 40 % of it, and are as they were",
    ),
    "tests": Row(*(_tests, "s", 0.7), "there are more than twice as many tests"),
}

if __name__ == "__main__":
    main()
