"""Lyapunov exponents of a motion, from the exact Jacobian of each mesh period."""

from typing import NamedTuple

import numpy as np

from gearmesh.dynamics.starts import initial_coordinates
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.period_map import passage

_BLOCKS = 8


class LyapunovSpectrum(NamedTuple):
    """Lyapunov exponents of a motion.

    Attributes
    ----------
    exponents : ndarray, shape (4,)
        Mean rates of growth in Omega_s, the largest first.
    errors : ndarray, shape (4,)
        Their standard errors, from the scatter of the rates in equal parts of the time.
    end : ndarray, shape (4,)
        y, y', b, b' at the end.
    damping : float
        Integral of the slope of the damping law of the mesh; 0 if no damping acts.
    """

    exponents: np.ndarray
    errors: np.ndarray
    end: np.ndarray
    damping: float


def lyapunov_spectrum(
    problem: Problem, state: np.ndarray, periods: int = 1000, transient: int = 200
) -> LyapunovSpectrum:
    """Return the Lyapunov exponents of the motion from a state.

    Parameters
    ----------
    problem : Problem
        Without run-out, profile deviation and Fourier stiffness.
    state : array_like, shape (4,)
        y, y', b, b' at `Problem.initial_phase`.
    periods : int
        Mesh periods over which growth is measured, at least 8.
    transient : int
        Mesh periods before the measurement, in which the directions of growth align.

    Raises
    ------
    NoOrbit
        If the motion runs away.
    """
    frame, growth, damping = np.eye(4), np.zeros((periods, 4)), 0.0
    for n in range(-transient, periods):
        moved = passage(problem, state)
        if moved.status != "complete":
            raise NoOrbit(f"the motion ends with {moved.status}")
        state = moved.end
        frame, stretch = np.linalg.qr(moved.jacobian @ frame)
        if n >= 0:
            growth[n] = np.log(np.abs(np.diag(stretch))) / problem.period
            damping += moved.damping
    parts = np.array([part.mean(axis=0) for part in np.array_split(growth, _BLOCKS)])
    exponents = growth.mean(axis=0)
    errors = parts.std(axis=0, ddof=1) / np.sqrt(_BLOCKS)
    order = np.argsort(-exponents)
    return LyapunovSpectrum(exponents[order], errors[order], state, damping)


def spectrum_of(problem: Problem, periods: int, transient: int) -> LyapunovSpectrum:
    """Return the Lyapunov exponents of a run; not-a-number if it runs away."""
    try:
        return lyapunov_spectrum(problem, initial_coordinates(problem), periods, transient)
    except NoOrbit:
        nothing = np.full(4, np.nan)
        return LyapunovSpectrum(nothing, nothing, nothing, np.nan)
