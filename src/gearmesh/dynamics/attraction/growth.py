"""The rate at which neighbouring motions part, for many motions at once."""

import math

import numpy as np

from gearmesh.dynamics.attraction.maps import PoincareMap

LEAST_GROWTH = 2e-3
"""Largest Lyapunov exponent, in Omega_s, above which a motion is chaotic."""

_APART = 1e-7  # distance to which a neighbour is brought back
_TRANSIENT = 10  # spans in which the neighbours turn in the direction of growth
_SPANS = 40
_PERIODS = 10  # least mesh periods of a span


def growth_rates(moved: PoincareMap, states: np.ndarray) -> np.ndarray:
    """Return estimates of the largest Lyapunov exponents of motions, in Omega_s.

    Each motion has a neighbour, which is brought back close to it after every span. The exact
    Jacobian (`gearmesh.dynamics.attraction.lyapunov`) would take far longer.

    Parameters
    ----------
    moved : PoincareMap
    states : ndarray, shape (n, k)

    Returns
    -------
    ndarray, shape (n,)
        Not-a-number if a motion runs away.
    """
    steps = math.ceil(_PERIODS / moved.block)
    direction = np.zeros((len(states), len(moved.weights)))
    direction[:, 0] = 1.0
    total = np.zeros(len(states))
    for span in range(_TRANSIENT + _SPANS):
        neighbours = moved.displaced(states, _APART * direction)
        states, neighbours = (moved.advance(one, steps) for one in (states, neighbours))
        away = moved.coordinates(neighbours) - moved.coordinates(states)
        apart = np.linalg.norm(away, axis=1)
        direction = away / np.maximum(apart, np.finfo(float).tiny)[:, None]
        if span >= _TRANSIENT:
            total += np.log(np.maximum(apart, np.finfo(float).tiny) / _APART)
    return total / (_SPANS * steps * moved.duration)
