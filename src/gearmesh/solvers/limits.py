"""Limits of both solvers: the length of a step, the number of steps, the size of y."""

import math

from gearmesh.model.problem import Problem

FARTHEST = 1e6
"""Beyond this distance from the backlash, in y_st, a run has diverged."""

_LONGEST_ANGLE = 2.0
# Steps that are allowed in every mesh period, and in addition in each unit of the fastest time.
_STEPS_PER_PERIOD = 2000.0
_STEPS_PER_UNIT = 20.0
# A run with more steps in a mesh period is not integrated at all.
_MOST_PER_PERIOD = 1e6


def highest_frequency(problem: Problem) -> float:
    """Return a bound of the natural frequencies in contact: the trace of the coupled stiffness."""
    bearing = math.sqrt(problem.bearing_stiffness / problem.body_mass)
    # With a contact ratio of 1 there never are two pairs.
    stiffest = problem.stiffness_max if problem.contact_ratio > 1.0 else problem.stiffness_min
    return math.sqrt(stiffest * (1.0 + 2.0 / problem.body_mass) + bearing**2)


def longest_step(problem: Problem) -> float:
    """Return the longest step in tau_s, two radians of the fastest oscillation.

    The limit keeps the points of a step at which events are searched for close together. It also
    keeps the series of a hardly excited mode convergent: otherwise such a mode would grow from
    rounding errors that are below the tolerance.
    """
    return _LONGEST_ANGLE / highest_frequency(problem)


def farthest(problem: Problem) -> float:
    """Return the |y| in y_st at which a run counts as diverged."""
    return FARTHEST + problem.backlash


def most_steps(problem: Problem) -> float:
    """Return the greatest number of steps of a run; 0 if the run cannot be integrated at all."""
    required = problem.period / longest_step(problem)
    if required > _MOST_PER_PERIOD:
        return 0.0
    ordinary = _STEPS_PER_PERIOD + _STEPS_PER_UNIT * problem.period * _fastest_rate(problem)
    return min(ordinary, 2.0 * _MOST_PER_PERIOD) * problem.periods


def _fastest_rate(problem: Problem) -> float:
    """Return the sum of the fastest rates of the problem: oscillation, decay and excitation."""
    slopes = (k1 + 2.0 * k2 + 3.0 * k3 for k1, k2, k3 in (problem.material, problem.lubricant))
    decay = max(slopes) * (1.0 + 2.0 / problem.body_mass)
    harmonics = max(problem.stiffness_harmonics, len(problem.deviation))
    return highest_frequency(problem) + decay + harmonics * problem.nu
