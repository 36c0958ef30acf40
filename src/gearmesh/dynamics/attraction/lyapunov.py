"""Lyapunov exponents of a motion, from the Jacobian of each mesh period."""

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dgeqrf, dorgqr

from gearmesh.dynamics.attraction.maps import map_of
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem

_BLOCKS = 8


class LyapunovSpectrum(NamedTuple):
    """Lyapunov exponents of a motion.

    Attributes
    ----------
    exponents : ndarray, shape (m,)
        Mean rates of growth in Omega_s, the largest first.
    errors : ndarray, shape (m,)
        Their standard errors, from the scatter of the rates in equal parts of the time.
    end : ndarray, shape (k,)
        The state at the end.
    """

    exponents: np.ndarray
    errors: np.ndarray
    end: np.ndarray


def lyapunov_spectrum(
    problem: Problem, state: np.ndarray, periods: int = 1000, transient: int = 200
) -> LyapunovSpectrum:
    """Return the Lyapunov exponents of the motion from a state.

    Parameters
    ----------
    problem : Problem
    state : array_like, shape (k,)
        As the Poincaré map takes it: y, y', b, b' at `Problem.initial_phase` in the reduced system.
    periods : int
        Mesh periods over which growth is measured, at least 8.
    transient : int
        Mesh periods before the measurement, in which the directions of growth align. Both numbers
        are rounded up to whole steps of the Poincaré map.

    Raises
    ------
    NoOrbit
        If the motion runs away, or if the excitation does not repeat.
    """
    moved = map_of(problem)
    frame, stretched = np.eye(len(moved.weights)), []
    before, measured = (math.ceil(count / moved.block) for count in (transient, periods))
    for n in range(-before, measured):
        state, factors = moved.step(state)
        for factor in factors:
            # A QR decomposition. NumPy's own takes several times as long for a small matrix.
            reflected, scales, *_ = dgeqrf(factor @ frame)
            frame, *_ = dorgqr(reflected, scales)
            if n >= 0:
                stretched.append(reflected.diagonal())
    growth = np.log(np.abs(stretched)) / problem.period
    parts = np.array([part.mean(axis=0) for part in np.array_split(growth, _BLOCKS)])
    exponents = np.mean(growth, axis=0)
    errors = parts.std(axis=0, ddof=1) / np.sqrt(_BLOCKS)
    order = np.argsort(-exponents)
    return LyapunovSpectrum(exponents[order], errors[order], state)


def spectrum_of(problem: Problem, periods: int, transient: int) -> LyapunovSpectrum:
    """Return the Lyapunov exponents of a run; not-a-number if it runs away."""
    moved = map_of(problem)
    state = moved.start(problem)
    try:
        return lyapunov_spectrum(problem, state, periods, transient)
    except NoOrbit:
        nothing = np.full(len(moved.weights), np.nan)
        return LyapunovSpectrum(nothing, nothing, np.full_like(state, np.nan))
