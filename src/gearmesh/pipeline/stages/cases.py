"""Compute the cases of a letter of Tab. 1.

Case files that still match the manifest are kept if they are cases of this study. If only the
attributes of a file are out of date (because a parameter without effect on the case changed), its
numbers are kept and it is written again. All other cases are integrated.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from gearmesh.data import batches, casefile, manifest
from gearmesh.data.casefile import Record
from gearmesh.data.paths import Places
from gearmesh.errors import InputError
from gearmesh.model.variants import Variant
from gearmesh.pipeline.messages import say
from gearmesh.solvers.response import Response
from gearmesh.study.cases import Case, Study
from gearmesh.study.parameters import MOST_SAMPLES

CHUNK = 64
"""Cases that are integrated in one go: enough to fill the lanes, few enough to show progress."""

EVERY = 2.0
"""Seconds between two progress lines of a job."""


def cases(study: Study, places: Places, letter: str) -> list[Path]:
    """Bring the case files and the batch file of a letter up to date."""
    wanted = study.of_letter(letter)
    files = {
        case: places.case(case.variant.name, case.nu) for case in wanted if study.has_file(case)
    }
    records = _kept(study, places, files, places.manifest(f"cases-{letter}"))
    kept = len(records)
    if study.plan.direction:
        records = _sweep(study, places, wanted)
    failed = sum(int(record["status"]) != 0 for record in records.values())
    printed = time.monotonic()
    missing = [case for case in wanted if case not in records]
    for chunk in _chunks(missing, study.pair.kept_samples):
        computed = _integrate(study, places, chunk)
        failed += sum(int(record["status"]) != 0 for record in computed)
        records.update(zip(chunk, computed, strict=True))
        if time.monotonic() - printed > EVERY:
            say(f"{letter}: {len(records)} of {len(wanted)} cases")
            printed = time.monotonic()
    batch = places.batch(letter)
    batches.write_batch(batch, study.pair, wanted, [records[case] for case in wanted])
    written = list(files.values())
    _remove_others(places, letter, written)
    counts = f"{len(wanted) - kept} computed, {kept} kept"
    say(f"{letter}: {counts}{f', {failed} not integrated' if failed else ''}")
    return [batch, *written]


def case(study: Study, places: Places, variant: str, nu: str) -> list[Path]:
    """Compute one case, whose file was requested by its name."""
    file = places.case(variant, nu)
    if study.plan.direction:
        raise InputError(f"{file}: a run of a sweep is not computed alone; ask for 'data'")
    for found in study.cases:
        if places.case(found.variant.name, found.nu) == file and study.has_file(found):
            _integrate(study, places, [found])
            return [file]
    raise InputError(f"{file}: the study {study.name} has no such case file")


def _kept(study: Study, places: Places, files: dict[Case, Path], path: Path) -> dict[Case, Record]:
    """Return the contents of the case files that need no integration."""
    before = manifest.read(path)
    if before is None or study.plan.direction:
        return {}  # a run of a sweep depends on all runs before it
    names = {case: file.relative_to(places.folder).as_posix() for case, file in files.items()}
    known = [name for name in names.values() if name in before.written]
    hashes = manifest.Hashes(places.folder).of(known)
    kept = {}
    for case, name in names.items():
        if name in before.written and hashes[name] == before.written[name]:
            found = _reuse(study, case, files[case])
            if found is not None:
                kept[case] = found
    return kept


def _reuse(study: Study, case: Case, path: Path) -> Record | None:
    wanted = casefile.attributes(study.pair, case)
    try:
        attributes, record = casefile.read_case(path)
    except InputError:  # it is of another format, from an earlier version
        return None
    if attributes.get("case_sha256") != wanted["case_sha256"]:
        return None
    if attributes != wanted:
        casefile.write_case(path, wanted, record)
    return record


def _sweep(study: Study, places: Places, wanted: Sequence[Case]) -> dict[Case, Record]:
    """Integrate all cases, each from the end of its neighbour's run, and write their files."""
    from gearmesh.dynamics.sweeps import run_chains
    from gearmesh.solvers.simulation import simulate

    pair = study.pair
    down = study.plan.direction == "down"
    by_variant: dict[Variant, list[Case]] = {}
    for case in sorted(wanted, key=lambda case: case.nu, reverse=down):
        by_variant.setdefault(case.variant, []).append(case)
    chains = [
        [pair.problem(case.variant, case.nu) for case in chain] for chain in by_variant.values()
    ]
    records = {}
    samples = pair.samples_per_period if study.plan.loads else 0
    found = run_chains(chains, pair.tolerance, samples)
    for chain, responses in zip(by_variant.values(), found, strict=True):
        start = None
        for case, response in zip(chain, responses, strict=True):
            if case.time_course and not case.loads:  # again, with samples
                problem = pair.problem(case.variant, case.nu)
                if start is not None:
                    problem = replace(problem, initial_state=start)
                [response] = simulate([problem], pair.tolerance, pair.samples_per_period)
            records[case] = _record(study, case, response)
            start = response.final_state
            if study.has_file(case):
                path = places.case(case.variant.name, case.nu)
                casefile.write_case(path, casefile.attributes(pair, case), records[case])
    return records


def _integrate(study: Study, places: Places, chunk: Sequence[Case]) -> list[Record]:
    """Integrate cases that are alike, and write their files."""
    # Imported here: a job that finds everything done need not load compiled code.
    from gearmesh.solvers.simulation import simulate

    pair = study.pair
    problems = [pair.problem(case.variant, case.nu) for case in chunk]
    samples = pair.samples_per_period if chunk[0].time_course or chunk[0].loads else 0
    responses = simulate(problems, pair.tolerance, samples)
    records = [
        _record(study, case, response) for case, response in zip(chunk, responses, strict=True)
    ]
    for case, record in zip(chunk, records, strict=True):
        if study.has_file(case):
            path = places.case(case.variant.name, case.nu)
            casefile.write_case(path, casefile.attributes(pair, case), record)
    return records


def _record(study: Study, case: Case, response: Response) -> Record:
    """Return what the file of a case holds."""
    pair = study.pair
    problem = pair.problem(case.variant, case.nu) if case.loads else None
    columns = casefile.record(response, pair, problem)
    return columns if case.time_course else casefile.without_time_course(columns)


def _chunks(wanted: Sequence[Case], kept_samples: int) -> Iterator[list[Case]]:
    """Yield a few cases at a time, those with a time course apart from those without.

    Together they keep no more samples than one run may keep, so that they fit in memory.
    """
    for time_course in (False, True):
        alike = [case for case in wanted if case.time_course == time_course]
        most = CHUNK
        if any(case.time_course or case.loads for case in alike):
            most = max(1, min(CHUNK, MOST_SAMPLES // kept_samples))
        for first in range(0, len(alike), most):
            yield alike[first : first + most]


def _remove_others(places: Places, letter: str, written: Sequence[Path]) -> None:
    """Remove case files of the letter that are not of this study as it is now."""
    for folder in places.cases.glob(f"{letter}-*"):
        for file in {*folder.iterdir()} - {*written}:
            file.unlink()
        if not any(folder.iterdir()):
            folder.rmdir()
