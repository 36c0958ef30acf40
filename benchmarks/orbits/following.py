"""Branches as a capable user would follow them: each orbit predicted from known ones.

Newton's method needs one or two mesh periods from such a prediction, where it needs three or four
from the orbit before.
"""

from collections.abc import Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.interpolate import make_interp_spline

from benchmarks.orbits.newton import Map, Maps, newton, newton_of_many

POINTS = 5
"""Known orbits through which the next one is best extrapolated: with six, Newton's method needs as
many mesh periods; with two, up to twice as many."""

COARSE = 16
"""Least number of orbits that are found one by one before the others are found in batches."""

DEGREE = 5
"""Of the splines through known orbits."""

Orbits = tuple[np.ndarray, np.ndarray]
"""States, shape (n, 4), and Jacobians, shape (n, 4, 4)."""


def one_by_one(
    maps: Sequence[Map], values: np.ndarray, first: np.ndarray, points: int = POINTS
) -> Orbits:
    """Return the orbits at ascending values of a parameter, each predicted from those before.

    Parameters
    ----------
    maps : sequence of Map
        The map at each value.
    values : ndarray, shape (n,)
    first : ndarray, shape (4,)
        The orbit at the first value.
    points : int
        Number of known orbits from which the next one is extrapolated.
    """
    n = len(values)
    states, jacobians = np.empty((n, 4)), np.empty((n, 4, 4))
    states[0], jacobians[0] = newton(maps[0], first)
    early = [_weights(values[: i + 1], i)[0] for i in range(1, min(n, points))]
    for i, weights in enumerate([*early, *_weights(values, points)], start=1):
        predicted = weights @ states[i - len(weights) : i]
        states[i], jacobians[i] = newton(maps[i], predicted)
    return states, jacobians


def from_coarse_to_fine(
    maps: Sequence[Map], lanes: Maps, values: np.ndarray, first: np.ndarray
) -> Orbits:
    """Return the same orbits, most of which are found many at once.

    A few are found one by one. Splines through all known orbits then predict those halfway between
    them, again and again, until no value is left.

    Parameters
    ----------
    maps, values, first
        As of `one_by_one`.
    lanes : Maps
        The same maps, for many states at once.
    """
    n = len(values)
    spacing = 2 ** int(np.log2(n / COARSE))
    known = np.union1d(np.arange(0, n, spacing), n - 1)
    states, jacobians = np.empty((n, 4)), np.empty((n, 4, 4))
    states[known], jacobians[known] = one_by_one([maps[i] for i in known], values[known], first)
    while spacing > 1:
        spacing //= 2
        new = np.setdiff1d(np.arange(0, n, spacing), known)
        predicted = make_interp_spline(values[known], states[known], DEGREE)(values[new])
        states[new], jacobians[new] = newton_of_many(lanes, new, predicted)
        known = np.union1d(known, new)
    return states, jacobians


def extrapolated(values: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return the state at the last value from the states at the values before it."""
    return _weights(values, len(states))[0] @ states


def _weights(values: np.ndarray, points: int) -> np.ndarray:
    """Return the weights with which Lagrange's polynomials give the next state from those before.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Of the parameter.
    points : int
        Number of states in each polynomial.

    Returns
    -------
    ndarray, shape (n - points, points)
    """
    windows = sliding_window_view(values, points + 1)
    nodes, at = windows[:, None, :points], windows[:, None, points:]
    apart = np.swapaxes(nodes, 1, 2) - nodes
    factors = np.ones_like(apart)
    np.divide(at - nodes, apart, out=factors, where=~np.eye(points, dtype=bool))
    return factors.prod(axis=2)
