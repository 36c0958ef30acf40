"""Motions that are no orbits: chaotic, quasi-periodic, undamped, or not yet settled."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearmesh.dynamics.attraction.attractors import CHAOTIC, LOST, MOVING, NEUTRAL, QUASI_PERIODIC
from gearmesh.dynamics.attraction.growth import LEAST_GROWTH, growth_rates
from gearmesh.model.problem import Problem, State
from gearmesh.solvers.simulation import simulate

_SPAN = 400  # mesh periods over which extrema are compared
_LEAST_CHANGE = 1e-3  # of the extrema, in y_st


def irregular_kinds(
    problems: Sequence[Problem], laws: np.ndarray, states: np.ndarray
) -> tuple[list[str], np.ndarray]:
    """Return the kinds of motions that are no orbits, and their largest Lyapunov exponents.

    Parameters
    ----------
    problems : sequence of Problem, length n
    laws : ndarray, shape (n,) or (1,)
        See `gearmesh.solvers.reduced.ensembles`.
    states : ndarray, shape (n, 4)
        y, y', b, b' after the transient.
    """
    rates = growth_rates(laws, states)
    kinds = [
        LOST if math.isnan(rate) else CHAOTIC if rate > LEAST_GROWTH else NEUTRAL for rate in rates
    ]
    damped = [
        i
        for i, problem in enumerate(problems)
        if kinds[i] == NEUTRAL and any(problem.material + problem.lubricant)
    ]
    changes = _changes([problems[i] for i in damped], states[damped])
    for i, change in zip(damped, changes, strict=True):
        kinds[i] = QUASI_PERIODIC if change < _LEAST_CHANGE else MOVING
    return kinds, rates


def _changes(problems: Sequence[Problem], states: np.ndarray) -> list[float]:
    """Return how much the extrema of motions change from one span to the next."""
    runs = []
    for problem, state in zip(problems, states.tolist(), strict=True):
        revolutions = math.ceil(_SPAN / problem.teeth)
        runs.append(
            replace(
                problem,
                revolutions=revolutions,
                kept_revolutions=revolutions,
                initial_state=State(*state),
            )
        )
    first = simulate(runs, estimate_errors=False)
    again = [
        replace(run, initial_state=response.final_state)
        for run, response in zip(runs, first, strict=True)
    ]
    return [
        max(abs(one.y_max - two.y_max), abs(one.y_min - two.y_min))
        for one, two in zip(first, simulate(again, estimate_errors=False), strict=True)
    ]
