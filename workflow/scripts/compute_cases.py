"""Compute a batch of cases.

Case files that are there, whole and made by the same recipe are kept. Where only the attributes of
a file are out of date (a parameter changed that this case does not depend on), it is written again
with what it holds. All others are integrated.
"""

import argparse
import time
from collections.abc import Iterable, Sequence
from pathlib import Path

from gearmesh.data import batches, casefile, paths
from gearmesh.data.batches import Batch
from gearmesh.data.casefile import Record
from gearmesh.errors import InputError
from gearmesh.pipeline.job import job, note, part, progress, tell
from gearmesh.study.cases import Case, Study
from gearmesh.study.loading import load_study

CHUNK = 64
"""Cases that are integrated in one go: enough to fill the lanes, few enough to show progress."""

TOLD_EVERY = 2.0
"""Seconds between two progress lines of a job."""


def compute(study: Study, batch: Batch) -> None:
    """Bring the case files and the file of a batch up to date."""
    parameters = study.pair
    attributes = batches.attributes(parameters, batch)
    output = paths.batch_file(batch.name)
    records = _kept(study, batch.cases)
    if len(records) == len(batch.cases) and casefile.is_whole(output, casefile.recipe(attributes)):
        return
    told = time.monotonic()
    missing = [case for case in batch.cases if case not in records]
    for chunk in _chunks(missing):
        records.update(zip(chunk, _integrate(study, chunk), strict=True))
        if time.monotonic() - told > TOLD_EVERY:
            tell(progress())
            told = time.monotonic()
    with part("batch files"):
        batches.write_batch(output, attributes, batch, [records[case] for case in batch.cases])


def _kept(study: Study, cases: Sequence[Case]) -> dict[Case, Record]:
    """Return what the case files hold that need no integration."""
    kept = {}
    for case in cases:
        if has_file(study, case):
            found = _reuse(study, case)
            if found is not None:
                kept[case] = found
    note({"kept": len(kept)})
    return kept


def _reuse(study: Study, case: Case) -> Record | None:
    path = paths.case_file(case.variant.name, case.nu)
    wanted = casefile.attributes(study.pair, case)
    if not casefile.is_whole(path):
        return None
    try:
        attributes, columns = casefile.read_case(path)
    except InputError:
        return None
    if attributes.get("case_sha256") != wanted["case_sha256"]:
        return None
    if not casefile.is_whole(path, casefile.recipe(wanted)):
        casefile.write_case(path, wanted, columns)
    return columns


def has_file(study: Study, case: Case) -> bool:
    """Tell whether a case has a file of its own; one with a time course always has."""
    return study.plan.case_files or case.time_course


def _integrate(study: Study, cases: Sequence[Case]) -> list[Record]:
    """Integrate cases that are alike, and write their files."""
    # Imported here: a job that finds everything done need not load compiled code.
    with part("loading"):
        from gearmesh.solvers.simulation import simulate

    parameters = study.pair
    problems = [parameters.problem(case.variant, case.nu) for case in cases]
    samples = parameters.samples_per_period if cases[0].time_course else 0
    with part("integration"):
        responses = simulate(problems, parameters.tolerance, samples)
    records = [casefile.record(response, parameters) for response in responses]
    with part("case files"):
        for case, record in zip(cases, records, strict=True):
            if has_file(study, case):
                path = paths.case_file(case.variant.name, case.nu)
                casefile.write_case(path, casefile.attributes(parameters, case), record)
    failed = sum(response.status != "ok" for response in responses)
    note({"computed": len(cases), "failed": failed})
    return records


def _chunks(cases: Iterable[Case]) -> Iterable[list[Case]]:
    """Yield a few cases at a time, those with a time course apart from those without."""
    ordered = sorted(cases, key=lambda case: case.time_course)
    chunk: list[Case] = []
    for case in ordered:
        if chunk and (len(chunk) == CHUNK or case.time_course != chunk[0].time_course):
            yield chunk
            chunk = []
        chunk.append(case)
    if chunk:
        yield chunk


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("config", type=Path)
    parser.add_argument("batch", type=int)
    options = parser.parse_args()
    with job("cases"):
        study = load_study(options.config)
        batch = batches.partition(study.cases, 1400)[options.batch]
        compute(study, batch)
        tell(progress())


if __name__ == "__main__":
    main()
