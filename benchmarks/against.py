"""Time and space against an earlier commit, both measured in one go on this machine.

Run from the root of the project: ``python -m benchmarks.against FOLDER [ROW…]``. `FOLDER` keeps a
clone of each commit with an environment of its own, made where it is missing; what is not committed
does not count. Without rows all are measured. A row that cannot be measured says why, and the
others go on.

Processor time is compared, not time on the clock: other work on the machine disturbs it least.
Short commands run several times, the two commits in turns, and the least time of each counts.
"""

import functools
import os
import resource
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from benchmarks import processes
from benchmarks.pipeline_layout import ROOT

BASE = "13961cb"
CORES = "2"
SEVERAL = 5
PATIENCE = 1800
"""Seconds after which a command is given up."""
LISTED = "processes.jsonl"
"""Where a run of the study lists its processes."""
FAILED_TESTS = 1
"""With this status pytest has run all tests, and some have failed."""


def main() -> None:
    """Measure the rows and print them."""
    folder = Path(sys.argv[1])
    rows = sys.argv[2:] or list(ROWS)
    print(table(folder, rows))


def table(folder: Path, rows: list[str]) -> str:
    """Return the table of some rows, with the reason for each that falls short."""
    folder = folder.resolve()  # a checkout is refused if its code is found by another path
    base, here = _clone(folder / "base", BASE), _clone(folder / "here", "FETCH_HEAD")
    lines = [f"{'':40}{BASE:>10}{'here':>10}{'ratio':>8}{'asked':>8}"]
    for name in rows:
        lines.append(_line(name, ROWS[name], base, here))
        print(lines[-1], file=sys.stderr, flush=True)
    return "\n".join(lines)


def _line(name: str, row: "Row", base: Path, here: Path) -> str:
    try:
        tries = [(row.measure(base), row.measure(here)) for _ in range(row.tries)]
    except (subprocess.SubprocessError, OSError, ValueError) as error:
        return f"{f'{name}, {row.unit}':40}not measured: {_why(error)}"
    before, now = (min(measured) for measured in zip(*tries, strict=True))
    found = now if row.absolute else now / before
    return (
        f"{f'{name}, {row.unit}':40}{before:10.2f}{now:10.2f}{found:8.2f}{f'≤ {row.asked:.2f}':>8}"
        + (f"  {row.reason}" if found > row.asked else "")
    )


def _why(error: Exception) -> str:
    """Return why a row was not measured, in one line."""
    if isinstance(error, subprocess.CalledProcessError):
        last = error.stdout.decode(errors="replace").strip().splitlines()[-1:]
        return f"a command ended with status {error.returncode}: {''.join(last)}"
    if isinstance(error, subprocess.TimeoutExpired):
        return f"a command took more than {PATIENCE} s"
    return str(error)


HEYOKA = (
    ("sweep", "heyoka, batches", 16, "the samples take 40 % of the time"),
    ("single", "heyoka, scalar", 10, "a run has one lane, and each operation waits for the last"),
)
"""What is compared with which peer, what is asked, and why it falls short."""


def against_heyoka(results: dict) -> str:
    """Return the rows that compare with heyoka: how many times as fast the solver is."""
    times = {row["solver"]: row["seconds_a_case"] for row in results["table"]}
    lines = []
    for kind, peer, asked, reason in HEYOKA:
        name = f"{kind} against {peer}, times as fast"
        if peer not in times:
            lines.append(f"{name:40}not measured: {peer} is left out")
            continue
        found, bare = (
            times[peer][kind] / times[ours][kind] for ours in ("gearmesh", "gearmesh, no samples")
        )
        short = f"  {bare:.1f} without samples; {reason}" if found < asked else ""
        lines.append(f"{name:40}{'':10}{'':10}{found:8.2f}{f'≥ {asked}':>8}{short}")
    return "\n".join(lines)


def _clone(place: Path, commit: str) -> Path:
    """Bring a clone to a commit; what was fetched last is the tip of this checkout."""
    if not place.exists():
        subprocess.run(["git", "clone", "--quiet", "--no-checkout", ROOT, place], check=True)
    subprocess.run(["git", "fetch", "--quiet", ROOT, "HEAD"], cwd=place, check=True)
    subprocess.run(["git", "checkout", "--quiet", commit], cwd=place, check=True)
    return place


def _spent(folder: Path, *command: str | Path, ends: tuple[int, ...] = (0,), **more: str) -> float:
    """Run a command in a clone; return the seconds of processor time."""
    # Bytecode is kept, as on most machines; else each process would compile all modules.
    ordinary = {"PYTHONPATH": str(folder / "src"), "PYTHONDONTWRITEBYTECODE": ""}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    finished = subprocess.run(
        command,
        cwd=folder,
        env=os.environ | ordinary | more,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        timeout=PATIENCE,
        check=False,
    )
    if finished.returncode not in ends:
        finished.check_returncode()
    if finished.returncode:
        last = finished.stdout.decode(errors="replace").splitlines()[-1]
        print(f"{folder.name}: {last}", file=sys.stderr)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def _python(folder: Path, stamp: str = ".installed") -> Path:
    """Return the interpreter of a clone, whose environment is made if need be."""
    _spent(folder, "make", f".venv/{stamp}")
    return folder / ".venv" / "bin" / "python"


def _snakemake(folder: Path, *arguments: str, **more: str) -> float:
    command = ("-m", "snakemake", "--cores", CORES, *arguments)
    return _spent(folder, _python(folder), *command, **more)


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
    return _study(folder)[0]


def _warm(folder: Path) -> float:
    return _again(folder)[0]


@functools.cache
def _again(folder: Path) -> tuple[float, Counter[str]]:
    """Run the study with compiled code there."""
    if not any((folder / "src").rglob("*.nbi")):
        _study(folder)
    return _study(folder)


def _study(folder: Path) -> tuple[float, Counter[str]]:
    """Run the study of the paper; return what it takes without the added jobs, and each job."""
    _forget(folder)
    listed = folder / LISTED
    listed.unlink(missing_ok=True)
    places = os.pathsep.join([str(processes.TRACED), str(folder / "src")])
    spent = _snakemake(folder, PYTHONPATH=places, PROCESSES=str(listed))
    jobs = processes.of_jobs(listed)
    return spent - sum(jobs[name] for name in processes.ADDED), jobs


def _neither(folder: Path) -> float:
    """Return the share of the study, warm, that is neither integration nor notebooks."""
    whole, jobs = _again(folder)
    known = sum(jobs[name] for name in processes.NOTEBOOKS + processes.INTEGRATING)
    command = (_python(folder), "-c", processes.INTEGRATION)
    environment = os.environ | {"PYTHONPATH": str(folder / "src")}
    cases = subprocess.check_output(
        command, cwd=folder, env=environment, timeout=PATIENCE, stderr=subprocess.STDOUT
    )
    return 1 - (known + float(cases.split()[-1])) / whole


def _idle(folder: Path) -> float:
    _snakemake(folder)
    return _snakemake(folder)


def _disk(folder: Path) -> float:
    """Return the megabytes of the results, as blocks of the file system."""
    _snakemake(folder)
    files = (file for file in (folder / "results").rglob("*") if file.is_file())
    return sum(file.stat().st_blocks for file in files) * 512 / 1e6


def _atlas(folder: Path) -> float:
    _again(folder)
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
    apart = (folder / "requirements-dev.lock").exists()
    python = _python(folder, ".installed-dev" if apart else ".installed")
    command = ("-m", "pytest", "-q", "-n", CORES, "--dist", "loadfile", "--no-loadscope-reorder")
    before = _busy()
    _spent(folder, python, *command, ends=(0, FAILED_TESTS))
    return _busy() - before


def _busy() -> float:
    """Return the processor time of all processes on this machine since it started, in seconds.

    Servers of the tests and browsers start processes that nobody waits for, so the time of the
    children leaves them out.
    """
    user, nice, system = Path("/proc/stat").read_text().split()[1:4]
    return (int(user) + int(nice) + int(system)) / os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True, slots=True)
class Row:
    """What is measured, its unit, the ratio that is asked, and why it may fall short.

    With `absolute`, what is asked is asked of this commit alone, not of the ratio.
    """

    measure: Callable[[Path], float]
    unit: str
    asked: float
    reason: str
    tries: int = 1
    absolute: bool = False


ROWS = {
    "environment": Row(
        *(_environment, "s", 0.6),
        "pip takes 20 s to choose and unpack packages and 20 s to compile their modules; most are "
        "those of the base: NumPy, SciPy, numba, pandas, matplotlib, Snakemake, heyoka",
    ),
    "study cold": Row(*(_cold, "s", 0.55), "numba compiles kernels of the added jobs, too"),
    "study warm": Row(
        *(_warm, "s", 0.5),
        "SciPy writes a case file in 1 ms, and each of 8 jobs loads numba for the better part of a "
        "second; the rest are notebooks and the thresholds",
    ),
    "neither integration nor notebooks": Row(
        *(_neither, "share", 0.5),
        "Snakemake, and starts and imports of the other jobs, and the case files",
        absolute=True,
    ),
    "nothing to do": Row(*(_idle, "s", 0.8), "Snakemake itself takes most of it", tries=SEVERAL),
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
