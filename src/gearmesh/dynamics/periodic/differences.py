"""Derivatives of maps by differences of sixth order."""

from collections.abc import Callable

import numpy as np

LARGEST_STEP = 1e-3
"""The step where the map has no kink nearby."""

_SHARES = (1.0, 0.1, 0.01, 0.001)
_SMOOTH = 1e-8  # difference between orders without a kink
_SIXTH = np.array([-1.0, 9.0, -45.0, 45.0, -9.0, 1.0]) / 60.0
_FOURTH = np.array([0.0, 1.0, -8.0, 8.0, -1.0, 0.0]) / 12.0


def slope(
    function: Callable[[np.ndarray], np.ndarray],
    place: np.ndarray,
    along: np.ndarray,
    largest: float = LARGEST_STEP,
) -> np.ndarray:
    """Return the derivative of a function along a direction, by differences of sixth order.

    Differences of fourth order serve as a check: they deviate if the function has a kink nearby.
    The step is then reduced, starting from `largest`.
    """
    best = np.inf
    for step in largest * np.array(_SHARES):
        sides = [function(place + n * step * along) for n in (-3, -2, -1, 1, 2, 3)]
        sixth, fourth = (np.dot(weights, sides) / step for weights in (_SIXTH, _FOURTH))
        error = float(np.abs(sixth - fourth).max())
        if error < best:
            found, best = sixth, error
        if error < _SMOOTH:
            break
    return np.asarray(found)
