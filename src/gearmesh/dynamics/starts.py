"""Initial states for the search for orbits."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import product

import numpy as np
from scipy.linalg import expm

from gearmesh.model.motion import state_at
from gearmesh.model.problem import Problem, State
from gearmesh.solvers.reduced.derivatives.period_map import segments_of
from gearmesh.solvers.simulation import simulate

Values = float | np.ndarray

_TRANSIENT = 40
"""Revolutions after which the end of a run serves as an initial state."""

_HEIGHTS, _VELOCITIES = (0.0, 1.0, 2.0, 3.0), (-2.0, -0.7, 0.7, 2.0)


def starts(problem: Problem) -> Iterator[np.ndarray]:
    """Yield states (y, y', b, b') near which orbits may lie, the most likely first.

    They are the periodic motion that never loses contact (`linear_orbit`), the end of a long run
    from rest, the ends of long runs from a grid of y and v, and the grid itself.
    """
    yield linear_orbit(problem)
    long = replace(problem, revolutions=_TRANSIENT, kept_revolutions=0, initial_state=None)
    grid = initial_states(problem, _HEIGHTS, _VELOCITIES)
    runs = [long, *(replace(long, initial_state=State(*state)) for state in grid.tolist())]
    for response in simulate(runs, estimate_errors=False):
        if response.final_state is not None:
            yield coordinates(response.final_state)
    yield from grid


def coordinates(state: State) -> np.ndarray:
    """Return y, y', b, b' of a state."""
    return np.array([state.y, state.v, state.b, state.b_rate])


def initial_coordinates(problem: Problem) -> np.ndarray:
    """Return y, y', b, b' at the start of a run."""
    return coordinates(problem.initial_state or state_at(problem))


def initial_states(problem: Problem, y: Iterable[float], v: Iterable[float]) -> np.ndarray:
    """Return the states of a grid of y and y' with the bodies in equilibrium under F_st."""
    rest = -2.0 / problem.bearing_stiffness
    return np.array([(height, rate, rest, 0.0) for height, rate in product(y, v)])


def linear_orbit(problem: Problem) -> np.ndarray:
    """Return the state (y, y', b, b') of the periodic motion that never loses contact.

    Only the linear damping of the material acts. The equations are then linear, and a matrix
    exponential for each segment of the mesh period solves them.
    """
    lengths, c, g = segments_of(problem).T
    whole = np.eye(5)
    for passed in expm(linear_rates(problem, c, g) * lengths[:, None, None]):
        whole = passed @ whole
    return np.linalg.solve(np.eye(4) - whole[:4, :4], whole[:4, 4])


def linear_rates(problem: Problem, c: Values, g: Values) -> np.ndarray:
    """Return the matrices of the linear equations of (y, y', b, b', 1) in normal mesh.

    Parameters
    ----------
    problem : Problem
        Only the linear damping of the material counts.
    c, g : float, or ndarray of shape (n,)
        C/C_s, and friction's share of the elastic force.

    Returns
    -------
    ndarray, shape (5, 5) or (n, 5, 5)
    """
    two_mu, damper = 2.0 / problem.body_mass, problem.material[0]
    support = problem.bearing_stiffness / problem.body_mass
    damped = 2.0 * problem.bearing_damping_ratio * math.sqrt(support)
    rates = np.zeros((*np.shape(c), 5, 5))
    rates[..., 0, 1] = rates[..., 2, 3] = rates[..., 1, 4] = 1.0
    rates[..., 3, 0] = -two_mu * c
    rates[..., 3, 1] = -two_mu * damper
    rates[..., [1, 3], 2] = -support
    rates[..., [1, 3], 3] = -damped
    rates[..., 1, 0] = rates[..., 3, 0] - c + g * c
    rates[..., 1, 1] = rates[..., 3, 1] - damper
    return rates
