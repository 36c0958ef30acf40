"""Derivatives of maps by differences of sixth order."""

from collections.abc import Callable

import numpy as np

LARGEST_STEP = 1e-3
"""The step where the map has no kink nearby."""

_SHARES = (1.0, 0.1, 0.01, 0.001)
_SMOOTH = 1e-8  # difference between orders without a kink
_PLACES = np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
_SIXTH = np.array([-1.0, 9.0, -45.0, 45.0, -9.0, 1.0]) / 60.0
_FOURTH = np.array([0.0, 1.0, -8.0, 8.0, -1.0, 0.0]) / 12.0


def jacobian(
    function: Callable[[np.ndarray], np.ndarray],
    place: np.ndarray,
    largest: float = LARGEST_STEP,
) -> np.ndarray:
    """Return the Jacobian of a map by differences of sixth order.

    Differences of fourth order serve as a check: they deviate if the map has a kink nearby. In
    these directions the step is then reduced.

    Parameters
    ----------
    function : callable
        From places, shape (m, n), to their images, shape (m, k).
    place : ndarray, shape (n,)
    largest : float
        The first step.

    Returns
    -------
    ndarray, shape (k, n)
    """
    n = place.size
    waiting, best, columns = np.arange(n), np.full(n, np.inf), [place] * n
    for step in largest * np.array(_SHARES):
        away = step * _PLACES[:, None, None] * np.eye(n)[waiting]
        sides = function((place + away).reshape(-1, n)).reshape(len(_PLACES), len(waiting), -1)
        sixth, fourth = (np.tensordot(one, sides, 1) / step for one in (_SIXTH, _FOURTH))
        errors = np.abs(sixth - fourth).max(axis=1)
        for i, column, error in zip(waiting, sixth, errors, strict=True):
            if error < best[i]:
                columns[i], best[i] = column, error
        waiting = waiting[errors >= _SMOOTH]
        if not waiting.size:
            break
    return np.column_stack(columns)
