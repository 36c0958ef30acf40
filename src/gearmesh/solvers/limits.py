"""Limits of both solvers: the length of a step, the number of steps, the size of y."""

import math

from gearmesh.model.problem import Problem
from gearmesh.model.stiffness import TURN

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
    if problem.wheels is None:
        bearing = math.sqrt(problem.bearing_stiffness / problem.body_mass)
        return math.sqrt(_stiffest(problem) * (1.0 + 2.0 / problem.body_mass) + bearing**2)
    stiffnesses = [c / w.body_mass for w in problem.wheels for c in w.bearing_stiffness]
    return math.sqrt(_stiffest(problem) * _mobility(problem) + max(stiffnesses))


def _mobility(problem: Problem) -> float:
    """Return the acceleration of y that a force of 1 in the mesh gives."""
    return 1.0 + sum(1.0 / wheel.body_mass for wheel in problem.both_wheels)


def _stiffest(problem: Problem) -> float:
    """Return the greatest mesh stiffness, or a bound of it."""
    terms = problem.terms
    if terms.tooth_pair_stiffness:
        stiffest = math.ceil(problem.contact_ratio) * max(terms.tooth_pair_stiffness)
    elif terms.stiffness_table:
        stiffest = max(value for _, value in terms.stiffness_table)
    else:
        # With a contact ratio of 1 there never are two pairs.
        doubled = problem.contact_ratio > 1.0
        stiffest = problem.stiffness_max if doubled else problem.stiffness_min
        stiffest += sum(abs(c) + abs(s) for c, s in terms.stiffness_fourier)
    for factor in terms.tooth_factors:
        stiffest *= max(1.0, factor.factor)
    return stiffest


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
    slowest, fastest = sorted((problem.nu, problem.final_nu or problem.nu))
    period = TURN / slowest
    required = period / longest_step(problem)
    if required > _MOST_PER_PERIOD:
        return 0.0
    ordinary = _STEPS_PER_PERIOD + _STEPS_PER_UNIT * period * _fastest_rate(problem, fastest)
    return min(ordinary, 2.0 * _MOST_PER_PERIOD) * problem.periods


def _fastest_rate(problem: Problem, nu: float) -> float:
    """Return the sum of the fastest rates of the problem: oscillation, decay and excitation."""
    slopes = (k1 + 2.0 * k2 + 3.0 * k3 for k1, k2, k3 in (problem.material, problem.lubricant))
    decay = max(slopes) * _mobility(problem)
    terms = problem.terms
    orders: list[float] = [
        problem.stiffness_harmonics,
        len(problem.deviation),
        len(terms.stiffness_fourier),
        len(terms.restoring_fourier),
    ]
    for harmonics in (
        terms.torque_harmonics_3,
        terms.torque_harmonics_2,
        terms.backlash_harmonics,
    ):
        orders += [harmonic.order for harmonic in harmonics]
    return highest_frequency(problem) + decay + max(orders) * nu
