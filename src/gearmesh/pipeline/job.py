"""What all jobs of the pipeline share: locks against each other, a journal, and how they fail.

Two locks keep runs apart. They are held through open files, so the system lets go of them when a
process ends, however it ends: no lock is ever left behind. A run holds `run.lock` alone. Its jobs
share `jobs.lock`; jobs that outlive a run that was killed still hold it, and the next run waits
for them.

The journal has a line for each piece of work done in a run. From it come the progress line and
the summary.
"""

import contextlib
import fcntl
import json
import resource
import sys
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from gearmesh.data import paths
from gearmesh.errors import InputError

RUN_LOCK = paths.RESULTS / ".run.lock"
JOBS_LOCK = paths.RESULTS / ".jobs.lock"
JOURNAL = paths.RESULTS / ".journal"

STAGES = (
    *("drawings", "cases", "thresholds", "datasets", "figures", "ledger", "report"),
    "identification",
)
"""Stages of the pipeline, in their order."""

BAD_INPUT = 2


def tell(line: str) -> None:
    """Print a line of the pipeline's own."""
    print(f"gearmesh: {line}", file=sys.stderr, flush=True)


@contextlib.contextmanager
def job(stage: str) -> Iterator[None]:
    """Do the work of one job: locked, timed, and with errors in one line.

    Parameters
    ----------
    stage : str
        One of `STAGES`.
    """
    start, loading = time.monotonic(), time.process_time()
    try:
        with _open(JOBS_LOCK) as lock:
            fcntl.flock(lock, fcntl.LOCK_SH)
            yield
            seconds = time.monotonic() - start
            note({"stage": stage, "seconds": seconds, "loading": loading, **used()})
    except InputError as error:
        tell(f"error: {error}")
        sys.exit(BAD_INPUT)


@contextlib.contextmanager
def part(name: str) -> Iterator[None]:
    """Note the processor time of a part of a job; `benchmarks.pipeline_stages` alone reads it."""
    start = time.process_time()
    yield
    note({"part": name, "processor": time.process_time() - start})


def used() -> dict[str, float]:
    """Return what this process and those that it waited for took: processor time and memory."""
    own, others = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return {
        "processor": sum(usage.ru_utime + usage.ru_stime for usage in (own, others)),
        "megabytes": max(usage.ru_maxrss for usage in (own, others)) / 1024,
    }


def hold_results() -> bool:
    """Take the lock of a run until this process ends; return whether no other run has it.

    Jobs that outlive a run that was killed are waited for: they still write.

    Raises
    ------
    InputError
        If the results cannot be written.
    """
    global _held
    if _held is not None:
        return True
    lock = _open(RUN_LOCK)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        lock.close()
        return False
    _held = lock
    with _open(JOBS_LOCK) as jobs:
        try:
            fcntl.flock(jobs, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            tell("waiting for jobs of an interrupted run")
            fcntl.flock(jobs, fcntl.LOCK_EX)
    return True


def begin_run(cases: int) -> None:
    """Begin a run: hold the results, and start a new journal.

    Parameters
    ----------
    cases : int
        Number of cases of the study, or of those that the run will look at.

    Raises
    ------
    InputError
        If another run is at work in the results, or they cannot be written.
    """
    if not hold_results():
        raise InputError(
            f"{paths.RESULTS}: another run is at work here; wait for its end, or stop it"
        )
    JOURNAL.write_text(json.dumps({"cases": cases, "start": time.time()}) + "\n")


_held = None


def _open(path: Path):
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        return path.open("a")
    except OSError as error:
        raise InputError(
            f"{paths.RESULTS}: cannot be written: {error.strerror}; allowed is a folder that you "
            "may write to"
        ) from None


def note(work: dict[str, float | str]) -> None:
    """Add a line to the journal; the progress of a run does not hang on it."""
    with contextlib.suppress(OSError), JOURNAL.open("a") as journal:
        journal.write(json.dumps(work) + "\n")


def read_journal() -> tuple[dict[str, float], list[dict[str, float | str]]]:
    """Read the journal: what the run began with, and its work."""
    try:
        first, *others = map(json.loads, JOURNAL.read_text().splitlines())
        return first, others
    except (OSError, ValueError):
        return {"cases": 0, "start": time.time()}, []


def progress() -> str:
    """Return a line: cases done, cases a second, time left."""
    first, work = read_journal()
    done = Counter()
    for line in work:
        done.update({key: line[key] for key in ("computed", "kept") if key in line})
    elapsed = max(time.time() - first["start"], 1e-3)
    total = max(first["cases"], done.total())
    rate = done.total() / elapsed
    left = f", {(total - done.total()) / rate:.0f} s left" if 0 < done.total() < total else ""
    return f"{done.total()} of {total} cases, {rate:.0f} a second{left}"


def tell_summary() -> None:
    """Tell what a run has done."""
    for line in summary():
        tell(line)


def summary() -> list[str]:
    """Return lines on what a run has done: claims, cases, the time and memory that jobs took."""
    first, work = read_journal()
    seconds, cases = Counter(), Counter()
    lines = []
    for line in work:
        if "stage" in line:
            seconds[line["stage"]] += line["seconds"]
        elif "claims" in line:
            lines.append(line["claims"])
        elif "part" not in line:
            cases.update(line)
    if cases:
        told = [f"{cases['computed']} computed", f"{cases['kept']} kept"]
        told += [f"{cases['failed']} not integrated"] if cases["failed"] else []
        lines.append(f"cases: {', '.join(told)}")
    stages = [f"{stage} {seconds[stage]:.1f} s" for stage in STAGES if stage in seconds]
    if stages:
        total = time.time() - first["start"]
        lines.append(f"time of jobs: {', '.join(stages)}; {total:.0f} s in all")
        memory = max(line.get("megabytes", 0) for line in work)
        lines.append(f"memory of a job: at most {memory:.0f} MB")
    return lines
