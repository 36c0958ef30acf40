"""gearmesh's own solver, through the one door that the pipeline uses."""

from collections.abc import Sequence

from benchmarks.outcome import SAMPLES_PER_PERIOD, Outcome
from benchmarks.reduced import periods
from gearmesh.integrator import simulate
from gearmesh.motion import Problem


def solve(problems: Sequence[Problem], tolerance: float) -> list[Outcome]:
    """Solve the runs with everything that the peers deliver."""
    return _solve(problems, tolerance, SAMPLES_PER_PERIOD)


def solve_without_samples(problems: Sequence[Problem], tolerance: float) -> list[Outcome]:
    """Solve the runs with what the pipeline needs of most cases: no dense samples."""
    return _solve(problems, tolerance, 0)


def _solve(problems, tolerance, samples_per_period):
    outcomes = []
    responses = simulate(problems, tolerance=tolerance, samples_per_period=samples_per_period)
    for problem, response in zip(problems, responses, strict=True):
        total, first_kept = periods(problem)
        n_samples = (total - first_kept) * SAMPLES_PER_PERIOD
        samples = response.samples
        outcomes.append(
            Outcome(
                response.extremum_y,
                response.strobe_y,
                response.strobe_v,
                None if samples is None else samples.y[:n_samples],
                None if samples is None else samples.v[:n_samples],
            )
        )
    return outcomes
