"""gearmesh's own solver, through the one door that the pipeline uses."""

from collections.abc import Sequence

from benchmarks.outcome import SAMPLES_PER_PERIOD, Outcome
from benchmarks.reduced import periods
from gearmesh.model.problem import Problem
from gearmesh.solvers.simulation import simulate


def solve(problems: Sequence[Problem], tolerance: float) -> list[Outcome]:
    """Solve the runs with what the peers deliver, no more."""
    return _solve(problems, tolerance, SAMPLES_PER_PERIOD, False)


def solve_without_samples(problems: Sequence[Problem], tolerance: float) -> list[Outcome]:
    """Solve the runs for extrema and stroboscopic points alone."""
    return _solve(problems, tolerance, 0, False)


def solve_with_estimates(problems: Sequence[Problem], tolerance: float) -> list[Outcome]:
    """Solve the runs as the pipeline does: no samples, but estimates of the errors."""
    return _solve(problems, tolerance, 0, True)


def _solve(problems, tolerance, samples_per_period, estimate_errors):
    responses = simulate(
        problems,
        tolerance=tolerance,
        samples_per_period=samples_per_period,
        estimate_errors=estimate_errors,
    )
    return [
        _outcome(problem, response) for problem, response in zip(problems, responses, strict=True)
    ]


def _outcome(problem, response):
    total, first_kept = periods(problem)
    n_samples = (total - first_kept) * SAMPLES_PER_PERIOD
    samples = response.samples
    return Outcome(
        response.extremum_y,
        response.strobe_y,
        response.strobe_v,
        None if samples is None else samples.y[:n_samples],
        None if samples is None else samples.v[:n_samples],
    )
