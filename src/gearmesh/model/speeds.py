"""How the mesh turns in time: at a constant speed, or at one that changes linearly.

The drive prescribes the mean rotation of both wheels; the vibration does not act back on it. The
torque that accelerates the wheels does not move the mesh: in R_b3 phi_3 + R_b2 phi_2 the mean
rotations cancel.

With theta'' = a, nu^2 grows linearly with the angle theta: after n mesh periods it is
nu^2 + 4 pi a n. So every jump of the laws, which is at a given angle, has a time in closed form.
The forms below lose no digits where a is small.
"""

import numpy as np

from gearmesh.model.problem import Problem
from gearmesh.model.stiffness import TURN


def frequency_after(problem: Problem, periods: np.ndarray) -> np.ndarray:
    """Return nu after so many mesh periods of a run."""
    if problem.final_nu is None:
        return np.full(np.shape(periods), problem.nu)
    share = np.asarray(periods) / problem.periods
    squares: np.ndarray = problem.nu**2 * (1.0 - share) + problem.final_nu**2 * share
    return np.sqrt(squares)


def time_of(problem: Problem, periods: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Return how long so many mesh periods last, in tau_s, after `before` others of a run."""
    begins, ends = (frequency_after(problem, at) for at in (before, before + periods))
    length: np.ndarray = 2.0 * TURN * np.asarray(periods) / (begins + ends)
    return length


def kept_time(problem: Problem) -> float:
    """Return how long the kept revolutions last, in tau_s."""
    kept = problem.kept_periods
    if problem.final_nu is None:
        return kept * problem.period
    return float(time_of(problem, np.array(kept), np.array(problem.periods - kept)))


def mean_period(problem: Problem) -> float:
    """Return the mean mesh period of the kept revolutions, in tau_s."""
    if problem.final_nu is None or not problem.kept_periods:
        return problem.period
    return kept_time(problem) / problem.kept_periods
