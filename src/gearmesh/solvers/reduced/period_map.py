"""The stroboscopic map of the reduced system, its exact Jacobian, and the events on the way."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit

from gearmesh.model import motion
from gearmesh.model.motion import Problem
from gearmesh.solvers.compilation import persistent
from gearmesh.solvers.reduced import variational
from gearmesh.solvers.reduced.runs import _pattern, _stretches

TOLERANCE = 1e-16
"""Bound of the last terms of a step, relative to the state: rounding decides the accuracy."""

LONGEST_ANGLE = 1.0
"""Bound of a step times the highest natural frequency."""

STATUSES = ("complete", "too many steps", "too many events", "diverged")
"""Outcomes of a passage, by their number in `gearmesh.solvers.reduced.variational`."""

_EVENTS_PER_PERIOD = 64
# u = y - b in the coordinates (u, u', b, b') of `Problem.initial_state`.
_TO_SUM = np.array([[1.0, 0, 1, 0], [0, 1, 0, 1], [0, 0, 1, 0], [0, 0, 0, 1]])
_FROM_SUM = np.array([[1.0, 0, -1, 0], [0, 1, 0, -1], [0, 0, 1, 0], [0, 0, 0, 1]])


def _build_propagation(sources: str, cache: bool) -> Callable[..., tuple[int, int, float, float]]:
    @njit(cache=cache, nogil=True)
    def compiled(*arguments):  # type: ignore[no-untyped-def]
        sources  # noqa: B018 (see persistent)
        return variational.propagate(*arguments)  # type: ignore[call-arg]

    return compiled


_propagate = persistent(_build_propagation, variational, motion)


@dataclass(frozen=True, slots=True)
class Passage:
    """What the motion over whole mesh periods does.

    Attributes
    ----------
    status : str
        ``"complete"``, or why the motion ends early.
    end : ndarray, shape (4,)
        u, u', b, b' at the end.
    jacobian : ndarray, shape (4, 4)
        Derivatives of `end` with respect to the state at the start.
    events : ndarray, shape (n, variational.EVENT_SIZE)
        Extrema, changes of regime, and jumps of C(t) and gamma(t), with the columns of
        `gearmesh.solvers.reduced.variational`; times from the start, in tau_s.
    damping : float
        Integral of the slope D of the damping law of the mesh.
    log_determinant : float
        Logarithm of the determinant of `jacobian` by Liouville's formula.
    least_force : float
        Least force in F_st between flanks that touch; infinity if none do.
    samples : ndarray, shape (n, 4)
        y, v, y'' and the regime.
    """

    status: str
    end: np.ndarray
    jacobian: np.ndarray
    events: np.ndarray
    damping: float
    log_determinant: float
    least_force: float
    samples: np.ndarray


def passage(
    problem: Problem,
    state: np.ndarray,
    periods: int = 1,
    samples_per_period: int = 0,
    longest_angle: float = LONGEST_ANGLE,
) -> Passage:
    """Return what the motion from a state does over whole mesh periods.

    Parameters
    ----------
    problem : Problem
        Reducible: without run-out, profile deviation and Fourier stiffness.
    state : array_like, shape (4,)
        u, u', b, b' at `Problem.initial_phase`.
    periods : int
        Mesh periods, >= 1.
    samples_per_period : int
        Samples of the time course in a mesh period.
    longest_angle : float
        Bound of a step times the highest natural frequency.
    """
    bearing = math.sqrt(problem.bearing_stiffness / problem.body_mass)
    two_mu = 2.0 / problem.body_mass
    highest = math.sqrt(problem.stiffness_max * (1.0 + two_mu) + bearing**2)
    bearings = np.array([two_mu, bearing**2, 2.0 * problem.bearing_damping_ratio * bearing])
    end = _TO_SUM @ np.asarray(state, float)
    jacobian = _TO_SUM.copy()
    events = np.empty((_EVENTS_PER_PERIOD * periods, variational.EVENT_SIZE))
    samples = np.empty((samples_per_period * periods, 4))
    outcome, n_events, damping, least_force = _propagate(
        segments_of(problem),
        np.array([problem.lubricant, problem.material]),
        problem.backlash,
        bearings,
        periods,
        longest_angle / highest,
        TOLERANCE,
        end,
        jacobian,
        events,
        samples,
        samples_per_period,
    )
    return Passage(
        STATUSES[outcome],
        _FROM_SUM @ end,
        _FROM_SUM @ jacobian,
        events[:n_events],
        damping,
        -(1.0 + two_mu) * damping - bearings[2] * periods * problem.period,
        least_force,
        samples,
    )


def segments_of(problem: Problem) -> np.ndarray:
    """Return length in tau_s, C/C_s and g of each segment of the mesh period, shape (m, 3)."""
    friction = problem.friction_coefficient * math.tan(problem.pressure_angle)
    return np.array(
        [
            (
                segment.length * problem.period,
                problem.stiffness_max if segment.double else problem.stiffness_min,
                friction * segment.gamma,
            )
            for segment in _stretches(*_pattern(problem))
        ]
    )
