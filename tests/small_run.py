"""The smoke study, computed without the pipeline: what figures, notebooks and report read."""

from pathlib import Path

from gearmesh.data import batches, casefile, datasets
from gearmesh.data.paths import Places
from gearmesh.solvers.simulation import simulate
from gearmesh.study.cases import Study


def compute(study: Study, root: Path) -> None:
    """Write the datasets of `study` and its cases with time courses below `root`."""
    pair, places = study.pair, Places(study.name)
    records = {}
    for with_course, samples in ((False, 0), (True, pair.samples_per_period)):
        cases = [case for case in study.cases if case.time_course == with_course]
        problems = [pair.problem(case.variant, case.nu) for case in cases]
        responses = simulate(problems, pair.tolerance, samples)
        for case, response in zip(cases, responses, strict=True):
            records[case] = casefile.record(response, pair)
    for case in (case for case in study.cases if case.time_course):
        file = root / places.case(case.variant.name, case.nu)
        casefile.write_case(file, casefile.attributes(pair, case), records[case])
    stored = root / places.batch("all")
    batches.write_batch(stored, pair, study.cases, [records[case] for case in study.cases])
    datasets.write_datasets(study, [stored], root / places.resonance, root / places.bifurcation)
    (root / places.thresholds).write_text("{}\n")
