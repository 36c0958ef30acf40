"""The smoke study, computed without the pipeline: what figures, notebooks and report read."""

from pathlib import Path

from gearmesh.data import batches, casefile, datasets, paths
from gearmesh.solvers.simulation import simulate
from gearmesh.study.cases import Study


def compute(study: Study, root: Path) -> None:
    """Write the datasets of `study` and its cases with time courses below `root`."""
    pair = study.pair
    (batch,) = batches.partition(study.cases, len(study.cases))
    records = {}
    for with_course, samples in ((False, 0), (True, pair.samples_per_period)):
        cases = [case for case in batch.cases if case.time_course == with_course]
        problems = [pair.problem(case.variant, case.nu) for case in cases]
        responses = simulate(problems, pair.tolerance, samples)
        for case, response in zip(cases, responses, strict=True):
            records[case] = casefile.record(response, pair)
    for case in (case for case in batch.cases if case.time_course):
        casefile.write_case(
            root / paths.case_file(case.variant.name, case.nu),
            casefile.attributes(pair, case),
            records[case],
        )
    stored = root / paths.batch_file(batch.name)
    ordered = [records[case] for case in batch.cases]
    batches.write_batch(stored, batches.attributes(pair, batch), batch, ordered)
    datasets.write_datasets(study, [stored], root / paths.RESONANCE, root / paths.BIFURCATION)
    (root / paths.THRESHOLDS).write_text("{}\n")
