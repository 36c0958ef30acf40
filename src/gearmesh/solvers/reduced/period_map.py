"""The stroboscopic map of the reduced system, its exact Jacobian, and the events on the way."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit

from gearmesh.model.problem import Problem
from gearmesh.model.segments import segments
from gearmesh.solvers.compilation import persistent
from gearmesh.solvers.limits import highest_frequency
from gearmesh.solvers.reduced import variational
from gearmesh.solvers.reduced.deviations import DEVIATIONS, SIZE

TOLERANCE = 1e-16
"""Bound of the last terms of a step, relative to the state: rounding decides the accuracy."""

LONGEST_ANGLE = 1.0
"""Bound of a step times the highest natural frequency."""

STATUSES = ("complete", "too many steps", "too many events", "diverged")
"""Outcomes of a passage, by their number in `gearmesh.solvers.reduced.variational`."""

_EVENTS_PER_PERIOD = 64
_NO_SAMPLES = np.empty((0, 4))


def _build_propagation(key: str, cache: bool) -> Callable[..., tuple[int, int, float, float]]:
    @njit(cache=cache, nogil=True)
    def compiled(*arguments):  # type: ignore[no-untyped-def]
        key  # noqa: B018 (see persistent)
        return variational.propagate(*arguments)

    return compiled


_propagate = persistent(_build_propagation)


@dataclass(frozen=True, slots=True)
class Passage:
    """The motion over whole mesh periods.

    Attributes
    ----------
    status : str
        ``"complete"``, or why the motion ends early.
    end : ndarray, shape (4,)
        y, y', b, b' at the end.
    jacobian : ndarray, shape (4, 4)
        Derivatives of `end` with respect to the state at the start.
    stretched : ndarray, shape (4,)
        Derivative of `end` with respect to the logarithm of the mesh period.
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
    stretched: np.ndarray
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
    """Return the motion from a state over whole mesh periods.

    Parameters
    ----------
    problem : Problem
        Reducible: without run-out, profile deviation and Fourier stiffness.
    state : array_like, shape (4,)
        y, y', b, b' at `Problem.initial_phase`.
    periods : int
        Mesh periods, >= 1.
    samples_per_period : int
        Samples of the time course in a mesh period.
    longest_angle : float
        Bound of a step times the highest natural frequency.
    """
    parts = segments_of(problem)
    events = np.empty((_EVENTS_PER_PERIOD * periods, variational.EVENT_SIZE))
    samples = np.empty((samples_per_period * periods, 4))
    visits = periods * len(parts)
    (outcome, n_events, damping, least_force), end, jacobian = _move(
        problem, parts, visits, state, events, longest_angle, samples, samples_per_period
    )
    two_mu, _, bearing = _bearings(problem)
    return Passage(
        STATUSES[outcome],
        end,
        jacobian[:, :SIZE],
        jacobian[:, SIZE],
        events[:n_events],
        damping,
        -(1.0 + two_mu) * damping - bearing * periods * problem.period,
        least_force,
        samples,
    )


def advance(problem: Problem, state: np.ndarray, share: float) -> np.ndarray:
    """Return the state that the motion reaches after a share of a mesh period, 0 to 1."""
    parts = segments_of(problem)
    ends = np.cumsum(parts[:, 0])
    begins = ends - parts[:, 0]
    parts[:, 0] = np.minimum(ends, share * problem.period) - begins
    parts = parts[parts[:, 0] > 0.0]
    events = np.empty((_EVENTS_PER_PERIOD, variational.EVENT_SIZE))
    return _move(problem, parts, len(parts), state, events)[1]


def _move(
    problem: Problem,
    parts: np.ndarray,
    visits: int,
    state: np.ndarray,
    events: np.ndarray,
    longest_angle: float = LONGEST_ANGLE,
    samples: np.ndarray = _NO_SAMPLES,
    samples_per_period: int = 0,
) -> tuple[tuple[int, int, float, float], np.ndarray, np.ndarray]:
    """Return what the compiled code returns, the state at the end and its derivatives."""
    end = np.array(state, float)
    jacobian = np.eye(SIZE, DEVIATIONS)
    measured = _propagate(
        parts,
        np.array([problem.lubricant, problem.material]),
        problem.backlash,
        _bearings(problem),
        visits,
        longest_angle / highest_frequency(problem),
        TOLERANCE,
        end,
        jacobian,
        events,
        samples,
        samples_per_period,
    )
    return measured, end, jacobian


def _bearings(problem: Problem) -> np.ndarray:
    """Return 2 mu, w^2 and 2 zeta w."""
    square = problem.bearing_stiffness / problem.body_mass
    damped = 2.0 * problem.bearing_damping_ratio * math.sqrt(square)
    return np.array([2.0 / problem.body_mass, square, damped])


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
            for segment in segments(problem)
        ]
    )
