"""Periodic orbits as a user would find them: Newton's method on any map with a Jacobian.

The method converges quadratically, so its last correction bounds the error of the state before.
The Jacobian that it returns belongs to that state, too.
"""

from collections.abc import Callable

import numpy as np

Map = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""From a state to the state one mesh period later, and its Jacobian."""

Maps = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""From numbers of problems and states, shape (n, 4), to the states one mesh period later, and the
Jacobians, shape (n, 4, 4)."""

LARGEST_CORRECTION = 1e-9
"""Newton's method is done when a correction is smaller, in y_st and y_st Omega_s."""

_MOST = 20


def newton(stroboscopic: Map, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the fixed point near `start`, and the Jacobian.

    Raises
    ------
    ArithmeticError
        If the method does not converge.
    """
    state = start
    for _ in range(_MOST):
        end, jacobian = stroboscopic(state)
        correction = np.linalg.solve(jacobian - np.eye(4), state - end)
        state = state + correction
        if np.abs(correction).max() < LARGEST_CORRECTION:
            return state, jacobian
    raise ArithmeticError("Newton's method does not converge")


def newton_of_many(
    maps: Maps, which: np.ndarray, starts: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the fixed points of several problems, and the Jacobians.

    Each iteration moves only the orbits that are not found yet.

    Raises
    ------
    ArithmeticError
        If the method does not converge.
    """
    states, jacobians = starts.copy(), np.empty((len(which), 4, 4))
    left = np.arange(len(which))
    for _ in range(_MOST):
        ends, jacobians[left] = maps(which[left], states[left])
        defects = (states[left] - ends)[..., None]
        corrections = np.linalg.solve(jacobians[left] - np.eye(4), defects)[..., 0]
        states[left] += corrections
        left = left[np.abs(corrections).max(axis=1) >= LARGEST_CORRECTION]
        if not len(left):
            return states, jacobians
    raise ArithmeticError("Newton's method does not converge")
