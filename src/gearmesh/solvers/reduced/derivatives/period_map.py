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
from gearmesh.solvers.reduced.derivatives import curves, variational
from gearmesh.solvers.reduced.derivatives.deviations import DEVIATIONS, ORDER, SIZE
from gearmesh.solvers.reduced.runs import check_reducible

TOLERANCE = 1e-16
"""Bound of the last terms of a step, relative to the state: rounding decides the accuracy."""

_LONGEST_ANGLE = 2.0
"""Bound of a step times the highest natural frequency."""

STATUSES = ("complete", "too many steps", "too many events", "diverged")
"""Outcomes of a passage, by their number in `gearmesh.solvers.reduced.derivatives.variational`."""

Statement = tuple[np.ndarray, np.ndarray, float, np.ndarray, int, float, float, float]
"""A problem and a number of mesh periods, as `curves.trace` takes them."""

_EVENTS_PER_PERIOD = 64
_NO_SAMPLES = np.empty((0, 4))

FIXED = np.eye(curves.DIMENSIONS)[SIZE]
"""Normal of the plane of all states at one mesh frequency."""


def _build_trace(key: str, cache: bool) -> Callable[..., tuple[int, float]]:
    @njit(cache=cache, nogil=True)
    def compiled(stated, unit, corrections, length, longest, limits, points, events, samples):  # type: ignore[no-untyped-def]
        key  # noqa: B018 (see persistent)
        return curves.trace(
            stated, unit, corrections, length, longest, limits, points, events, samples
        )

    return compiled


_trace = persistent(_build_trace)


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
        `gearmesh.solvers.reduced.derivatives.variational`; times from the start, in tau_s.
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
    share: float = 1.0,
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
    share : float
        Share of each step that is taken, to see what the steps change.
    """
    stated = statement(problem, periods, share)
    samples = np.empty((samples_per_period * periods, 4))
    points, events, _ = trace(stated, np.append(state, 1.0), FIXED, problem.nu, samples=samples)
    return passage_of(stated, problem.nu, points[0], events[0], samples)


def statement(problem: Problem, periods: int = 1, share: float = 1.0) -> Statement:
    """Return a reducible problem and a number of mesh periods as the compiled code takes them."""
    check_reducible(problem)
    parts = segments_of(problem)
    return (
        parts,
        np.array([problem.lubricant, problem.material]),
        float(problem.backlash),
        _bearings(problem),
        periods * len(parts),
        share * _LONGEST_ANGLE / highest_frequency(problem),
        TOLERANCE * share ** (ORDER + 1),
        float(problem.nu),
    )


def trace(
    stated: Statement,
    place: np.ndarray,
    normal: np.ndarray,
    unit: float,
    corrections: int = 0,
    steps: int = 0,
    length: float = 0.0,
    longest: float = 0.0,
    limits: tuple[float, float] = (0.0, 0.0),
    samples: np.ndarray = _NO_SAMPLES,
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return points, their events, and the next length, of `curves.trace`.

    Parameters
    ----------
    stated : tuple
        Of `statement`.
    place, normal : ndarray, shape (5,) or (n, 5)
        The places of the points, and the normals of the planes in which they are corrected. A curve
        has one, its first point.
    unit, corrections, length, longest, limits
        As for the compiled function.
    steps : int
        Most points behind the first.
    samples : ndarray, shape (n, 4)
        Filled with samples of the last point, evenly over the mesh periods.
    """
    periods = stated[4] // len(stated[0])
    given = place.size // curves.DIMENSIONS
    points = np.empty((given + steps + 1, curves.POINT_SIZE))
    events = np.empty((len(points), _EVENTS_PER_PERIOD * periods, variational.EVENT_SIZE))
    points[:given, : curves.DIMENSIONS] = place
    points[:given, curves.TANGENT : curves.DETERMINANT] = normal
    low, high = limits
    count, length = _trace(
        stated,
        unit,
        corrections,
        length,
        longest,
        (low, high),
        points,
        events,
        samples,
    )
    return points[:count], events, length


def passage_of(
    stated: Statement,
    unit: float,
    point: np.ndarray,
    events: np.ndarray,
    samples: np.ndarray = _NO_SAMPLES,
) -> Passage:
    """Return what the compiled code found of a point."""
    jacobian = point[curves.JACOBIAN : curves.TANGENT].reshape(SIZE, DEVIATIONS)
    damping, (two_mu, _, bearing) = float(point[curves.DAMPING]), stated[3]
    duration = 2.0 * math.pi * (stated[4] // len(stated[0])) / (float(point[SIZE]) * unit)
    return Passage(
        STATUSES[int(point[curves.OUTCOME])],
        point[curves.END : curves.JACOBIAN],
        jacobian[:, :SIZE],
        jacobian[:, SIZE],
        events[: int(point[curves.N_EVENTS])],
        damping,
        -(1.0 + two_mu) * damping - bearing * duration,
        float(point[curves.LEAST_FORCE]),
        samples,
    )


def advance(problem: Problem, state: np.ndarray, share: float) -> np.ndarray:
    """Return the state that the motion reaches after a share of a mesh period, 0 to 1."""
    parts, *others = statement(problem)
    ends = np.cumsum(parts[:, 0])
    begins = ends - parts[:, 0]
    parts[:, 0] = np.minimum(ends, share * problem.period) - begins
    parts = parts[parts[:, 0] > 0.0]
    others[3] = len(parts)
    points, _, _ = trace((parts, *others), np.append(state, 1.0), FIXED, problem.nu)  # type: ignore[arg-type]
    return points[0, curves.END : curves.JACOBIAN]


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
