"""How long a step may be, how many a run may take, and how far it may go: for both solvers."""

import math

from gearmesh.model.problem import Problem

FARTHEST = 1e6
"""Beyond this distance from the backlash, in y_st, a run has diverged."""

_LONGEST_ANGLE = 2.0
# Steps of a mesh period in which little is fast, and steps in one unit of the fastest time.
_STEPS_PER_PERIOD = 2000.0
_STEPS_PER_UNIT = 20.0
# A mesh period that takes more is not integrated at all.
_MOST_PER_PERIOD = 1e6


def highest_frequency(problem: Problem) -> float:
    """Return a bound of the natural frequencies in contact: the trace of the coupled stiffness."""
    bearing = math.sqrt(problem.bearing_stiffness / problem.body_mass)
    # With a contact ratio of 1 there never are two pairs.
    stiffest = problem.stiffness_max if problem.contact_ratio > 1.0 else problem.stiffness_min
    return math.sqrt(stiffest * (1.0 + 2.0 / problem.body_mass) + bearing**2)


def longest_step(problem: Problem) -> float:
    """Return the longest step in tau_s, two radians of the fastest oscillation.

    It keeps the places of a step where events are looked for close together. It also keeps the
    series of a mode that is hardly excited within its convergence: such a mode would grow from
    rounding errors that the tolerance does not see.
    """
    return _LONGEST_ANGLE / highest_frequency(problem)


def farthest(problem: Problem) -> float:
    """Return the |y| in y_st at which a run counts as diverged."""
    return FARTHEST + problem.backlash


def most_steps(problem: Problem) -> float:
    """Return the number of steps after which a run is given up; 0 if it cannot be done at all."""
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
