"""Sweeps: chains of runs, each of which starts from the end of the run before it."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import zip_longest

from gearmesh.model.problem import Problem
from gearmesh.solvers.response import Response
from gearmesh.solvers.simulation import simulate


def run_chains(
    chains: Sequence[Sequence[Problem]],
    tolerance: float,
    samples_per_period: int = 0,
    estimate_errors: bool = True,
) -> list[list[Response]]:
    """Integrate chains of runs side by side.

    Parameters
    ----------
    chains : sequence of sequences of Problem
        The first run of each chain starts from its own initial condition. Each other run starts
        from the end of the run before it, or from its own initial condition if that run failed.
    tolerance, samples_per_period, estimate_errors
        As for `gearmesh.solvers.simulation.simulate`.

    Returns
    -------
    list of list of Response
        In the order of `chains`.
    """
    found: list[list[Response]] = [[] for _ in chains]
    for step in zip_longest(*chains):
        waiting = [(i, problem) for i, problem in enumerate(step) if problem is not None]
        problems = [_continued(problem, found[i]) for i, problem in waiting]
        responses = simulate(problems, tolerance, samples_per_period, estimate_errors)
        for (i, _), response in zip(waiting, responses, strict=True):
            found[i].append(response)
    return found


def _continued(problem: Problem, before: Sequence[Response]) -> Problem:
    """Start a run from the end of the run before it, if there is one that did not fail."""
    if not before or before[-1].final_state is None:
        return problem
    return replace(problem, initial_state=before[-1].final_state)
