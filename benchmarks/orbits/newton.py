"""Periodic orbits as a user would find them: Newton's method on any map with a Jacobian."""

from collections.abc import Callable

import numpy as np

Map = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""From a state to the state one mesh period later, and its Jacobian."""

LARGEST_CORRECTION = 1e-9
"""Newton's method is done when a correction is smaller, in y_st and y_st Omega_s."""

_MOST = 20


def newton(stroboscopic: Map, start: np.ndarray) -> np.ndarray:
    """Return the fixed point near `start`.

    The method converges quadratically, so its last correction bounds the error of the state before.

    Raises
    ------
    ArithmeticError
        If it does not converge.
    """
    state = start
    for _ in range(_MOST):
        end, jacobian = stroboscopic(state)
        correction = np.linalg.solve(jacobian - np.eye(4), state - end)
        state = state + correction
        if np.abs(correction).max() < LARGEST_CORRECTION:
            return state
    raise ArithmeticError("Newton's method does not converge")
