"""Motions that are no orbits: chaotic, quasi-periodic, undamped, or not yet settled."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from gearmesh.dynamics.attraction.growth import LEAST_GROWTH, growth_rates
from gearmesh.dynamics.attraction.kinds import CHAOTIC, LOST, MOVING, NEUTRAL, QUASI_PERIODIC
from gearmesh.dynamics.attraction.maps import PoincareMap
from gearmesh.model.problem import Problem
from gearmesh.solvers.simulation import simulate

_SPAN = 400  # least mesh periods over which extrema are compared
_LEAST_CHANGE = 1e-3  # of the extrema, in y_st


def irregular_kinds(moved: PoincareMap, states: np.ndarray) -> tuple[list[str], np.ndarray]:
    """Return the kinds of motions that are no orbits, and their largest Lyapunov exponents.

    Parameters
    ----------
    moved : PoincareMap
    states : ndarray, shape (n, k)
        After the transient.
    """
    rates = growth_rates(moved, states)
    kinds = [
        LOST if math.isnan(rate) else CHAOTIC if rate > LEAST_GROWTH else NEUTRAL for rate in rates
    ]
    runs = moved.runs(states, _SPAN)
    damped = [
        i
        for i, run in enumerate(runs)
        if kinds[i] == NEUTRAL and (_in_contact_damped(run) or any(run.lubricant))
    ]
    for i, kind in zip(damped, _kinds([runs[i] for i in damped]), strict=True):
        kinds[i] = kind
    return kinds, rates


def _in_contact_damped(problem: Problem) -> bool:
    """Return whether motion that never loses contact is damped by more than the bearings."""
    return any(problem.material) or any(problem.terms.torsional_damping)


def _kinds(runs: Sequence[Problem]) -> Iterator[str]:
    """Yield the kinds of motions that do not grow, from the extrema of two spans."""
    first = simulate(runs, estimate_errors=False)
    again = [
        replace(run, initial_state=response.final_state)
        for run, response in zip(runs, first, strict=True)
    ]
    for run, one, two in zip(runs, first, simulate(again, estimate_errors=False), strict=True):
        change = max(abs(one.y_max - two.y_max), abs(one.y_min - two.y_min))
        if one.final_state is None or two.final_state is None:
            yield LOST
        elif two.contact_loss_fraction == 0.0 and not _in_contact_damped(run):
            yield NEUTRAL
        else:
            yield QUASI_PERIODIC if change < _LEAST_CHANGE else MOVING
