"""Where the processor time of a study goes: its processes, and its integration alone."""

import json
from collections import Counter
from pathlib import Path

ADDED = ("branches", "basins", "ensembles", "special_curves", "why", "explorer")
"""Jobs that the base does not have: the mechanisms and the explorer."""
NOTEBOOKS = ("figure", "run_notebook")
"""Jobs that execute a notebook, as they are called here and in the base, with their kernels."""
INTEGRATING = ("thresholds", "locate_thresholds")
"""Jobs that do little else than integrate."""
TRACED = Path(__file__).parent / "traced"
"""What is put before the search path of a run whose processes are to be listed."""
INTEGRATION = """
import time
try:
    from gearmesh.solvers.simulation import simulate
    from gearmesh.study.loading import load_study
    study = load_study("config/paper.yaml")
    all_cases, pair, tolerance = study.cases, study.pair, study.pair.tolerance
    samples = pair.samples_per_period
except ImportError:  # the base
    from gearmesh.configuration import load_study
    from gearmesh.integrator import simulate
    study = load_study("config/paper.yaml")
    all_cases, pair = study.cases(), study.parameters
    tolerance, samples = pair.solver.tolerance, pair.run.samples_per_period
spent = 0.0
for course in (False, True):
    cases = [case for case in all_cases if case.time_course == course]
    problems = [pair.problem(case.variant, case.nu) for case in cases]
    simulate(problems[:64], tolerance, samples * course)  # loads the compiled code
    for first in range(0, len(problems), 64):
        start = time.process_time()
        simulate(problems[first : first + 64], tolerance, samples * course)
        spent += time.process_time() - start
print(spent)
"""
"""Prints the processor time that the cases of the paper's study take, their files aside."""


def of_jobs(listed: Path) -> Counter[str]:
    """Return the processor time of each job, with that of the processes that it starts."""
    lines = [json.loads(line) for line in listed.read_text(encoding="utf-8").splitlines()]
    names = {pid: _name(arguments) for pid, _, arguments, _ in lines}
    spent: Counter[str] = Counter()
    for pid, parent, arguments, seconds in lines:
        kernel = "ipykernel_launcher" in arguments
        spent[names.get(parent, "kernel") if kernel else names[pid]] += seconds
    return spent


def _name(arguments: list[str]) -> str:
    if arguments[:2] == ["-m", "gearmesh.pipeline"]:
        return arguments[2]
    return arguments[1] if arguments[:1] == ["-m"] else Path((arguments or ["python"])[0]).stem
