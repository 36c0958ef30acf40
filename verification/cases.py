"""All cases of the study, compared in as many processes as there are cores."""

import multiprocessing
import os
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import NamedTuple

import netCDF4

from verification.comparison import DISPLACEMENT, Comparison, compare
from verification.runs import LANES, solve
from verification.statement import frequencies, load, run

CHUNK = 16 * LANES
"""Cases that a process compares in one go."""


class Wanted(NamedTuple):
    """A case of the study, and its file."""

    variant: str
    nu: float
    path: Path


def of_study(study: Path, results: Path) -> list[Wanted]:
    """Return all cases that the study states."""
    return [
        Wanted(variant, nu, results / "cases" / variant / f"nu-{nu:.4f}.nc")
        for variant, nus in frequencies(load(study)).items()
        for nu in nus
    ]


def other_files(wanted: Sequence[Wanted], results: Path) -> list[str]:
    """Return which case files are missing, and which are not of the study."""
    stated = {case.path for case in wanted}
    there = {*(results / "cases").glob("*/*.nc")}
    missing = [f"{path}: missing" for path in sorted(stated - there)]
    return missing + [f"{path}: not a case of the study" for path in sorted(there - stated)]


def compare_all(study: Path, wanted: Sequence[Wanted]) -> Iterator[Comparison]:
    """Compare all cases whose file exists, in their order."""
    existing = [case for case in wanted if case.path.exists()]
    chunks = [existing[first : first + CHUNK] for first in range(0, len(existing), CHUNK)]
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(os.cpu_count(), mp_context=context) as pool:
        done = 0
        for compared in pool.map(partial(_compare, study), chunks):
            yield from compared
            done += len(compared)
            if sys.stderr.isatty():
                print(f"\r{done} of {len(existing)} cases", end="", file=sys.stderr)
    if sys.stderr.isatty():
        print(file=sys.stderr)


def _compare(study: Path, chunk: Sequence[Wanted]) -> list[Comparison]:
    stated = load(study)
    runs = [run(stated, case.variant, case.nu) for case in chunk]
    samples = any(_has_time_course(case.path) for case in chunk)
    found = []
    outcomes = zip(
        chunk, runs, solve(runs, samples=samples), solve(runs, DISPLACEMENT), strict=True
    )
    for case, stated_run, outcome, displaced in outcomes:
        if not _has_time_course(case.path):
            outcome.samples = None
        found.append(compare(case.path, stated_run, outcome, displaced))
    return found


def _has_time_course(path: Path) -> bool:
    with netCDF4.Dataset(path) as file:
        return "time" in file.variables
