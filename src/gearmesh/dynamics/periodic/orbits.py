"""Periodic orbits of the reduced system: shooting, Floquet multipliers, and their certificates.

A period-n orbit is a fixed point of the n-th power of the stroboscopic map P, which takes the
state (y, y', b, b') at the initial phase to the state one mesh period later. Newton's method on
P^n(x) - x uses the exact Jacobian of `gearmesh.solvers.reduced.derivatives.period_map`.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from gearmesh.dynamics.periodic.events import extrema_of, jumping_segments, jumps_of
from gearmesh.dynamics.starts import starts
from gearmesh.errors import NoOrbit
from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, regime_of
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.derivatives.curves import FARTHEST, LARGEST_RESIDUAL
from gearmesh.solvers.reduced.derivatives.period_map import (
    FIXED,
    Passage,
    advance,
    passage,
    passage_of,
    segments_of,
    statement,
    trace,
)
from gearmesh.solvers.reduced.derivatives.variational import (
    CROSSING,
    HEIGHT,
    KIND,
    REGIME,
    TURN,
)
from gearmesh.solvers.reduced.runs import is_reducible

_MOST_CORRECTIONS = 40
# States closer than this count as the same, so an orbit that returns so early has a shorter period.
_SAME = 1e-8
# An orbit without damping is unstable if a multiplier exceeds 1 in size by more than this.
_LEAST_GROWTH = 1e-7


class Certificate(NamedTuple):
    """How far the numbers of an orbit can be trusted.

    Attributes
    ----------
    residual : float
        |P^n(x) - x|, in y_st and y_st Omega_s.
    extremum_margin : float
        Least distance in y_st from an extremum of y to the ends of its regime. It is negative if
        an event was missed, and near 0 if the orbit grazes.
    least_force : float
        Least force in F_st between flanks that touch; infinity if none do. If it is negative, the
        damping law pulls the flanks together.
    multiplier_error : float
        Estimated error of the multipliers: their change with half the step and one more
        correction of the state, or the error of their product by Liouville's formula.
    """

    residual: float
    extremum_margin: float
    least_force: float
    multiplier_error: float


class TimeCourse(NamedTuple):
    """The time course of an orbit over its own period; every array has shape (n,).

    Attributes
    ----------
    time : ndarray
        In tau_s, from the initial phase.
    y, v, a : ndarray
        y and its first two derivatives.
    regime : ndarray of int
        See `gearmesh.model.contact`.
    """

    time: np.ndarray
    y: np.ndarray
    v: np.ndarray
    a: np.ndarray
    regime: np.ndarray


@dataclass(frozen=True)
class Orbit:
    """A periodic orbit of the reduced system, in dimensionless form.

    Attributes
    ----------
    problem : Problem
        The gear pair; its initial state and its revolutions do not matter.
    periods : int
        The least period n, in mesh periods.
    state : ndarray, shape (4,)
        y, y', b, b' at `Problem.initial_phase`.
    known : Passage, optional
        The motion over the period of the orbit, if it is known already.
    """

    problem: Problem
    periods: int
    state: np.ndarray
    known: Passage | None = field(default=None, repr=False)

    @cached_property
    def passage(self) -> Passage:
        """The motion over the period of the orbit."""
        return self.known or passage(self.problem, self.state, self.periods)

    @property
    def repeats_after(self) -> int:
        """Mesh periods after which the excitation repeats."""
        return 1

    @property
    def period(self) -> float:
        """Mesh period T in tau_s."""
        return self.problem.period

    @property
    def backlash(self) -> float:
        """Constant part of the backlash, s / y_st."""
        return self.problem.backlash

    @property
    def y(self) -> float:
        """Relative motion y at the initial phase."""
        return float(self.state[0])

    @property
    def v(self) -> float:
        """Velocity y' at the initial phase."""
        return float(self.state[1])

    @cached_property
    def points(self) -> np.ndarray:
        """y, y', b, b' at the initial phase of each mesh period, shape (periods, 4)."""
        found = [self.state]
        for _ in range(self.periods - 1):
            found.append(passage(self.problem, found[-1]).end)
        return np.array(found)

    @property
    def strobes(self) -> np.ndarray:
        """Stroboscopic points: y and y' at the start of each mesh period, shape (periods, 2)."""
        return self.points[:, :2]

    @property
    def defect(self) -> np.ndarray:
        """P^n(x) - x, shape (4,)."""
        return self.passage.end - self.state

    @property
    def gradient(self) -> np.ndarray:
        """Jacobian of the defect, shape (4, 4)."""
        return self.monodromy - np.eye(4)

    @property
    def monodromy(self) -> np.ndarray:
        """Jacobian of P^n, shape (4, 4)."""
        return self.passage.jacobian

    @property
    def stretched(self) -> np.ndarray:
        """Derivative of the defect with respect to the logarithm of the mesh period."""
        return self.passage.stretched

    @property
    def undamped(self) -> bool:
        """Whether no damping of the mesh acts along the orbit."""
        return self.passage.damping == 0.0

    @property
    def residual(self) -> float:
        """|P^n(x) - x|."""
        return float(np.abs(self.defect).max())

    @cached_property
    def multipliers(self) -> np.ndarray:
        """Floquet multipliers, complex array of shape (4,), the largest modulus first."""
        return sorted_multipliers(np.linalg.eigvals(self.monodromy))

    @property
    def multiplier_error(self) -> float:
        """Estimated error of the multipliers, as of `certificate`."""
        return self.certificate.multiplier_error

    @property
    def growth(self) -> float:
        """Logarithm of the greatest growth of a deviation in a mesh period."""
        return float(np.log(np.abs(self.multipliers[0]))) / self.periods

    @property
    def neutral(self) -> bool:
        """Whether no damping of the mesh acts along the orbit and nothing grows.

        Its multipliers are then on the unit circle, except for the effect of the bearings.
        """
        return bool(judged(self.multipliers, self.undamped)[1])

    @property
    def stable(self) -> bool:
        """Whether all multipliers are inside the unit circle and the orbit is not neutral."""
        return bool(judged(self.multipliers, self.undamped)[0])

    @cached_property
    def signature(self) -> tuple[int, ...]:
        """Regimes in their order over the orbit's own period, normal mesh first if it occurs.

        The orbit is cyclic, so the signature begins where it is greatest and does not depend on
        the initial phase.
        """
        events = self.passage.events
        sequence = [int(event[REGIME]) for event in events[events[:, KIND] == CROSSING]]
        if not sequence:
            return (int(regime_of(self.y, self.problem.backlash)),)
        return max(tuple(sequence[i:] + sequence[:i]) for i in range(len(sequence)))

    @cached_property
    def extrema(self) -> np.ndarray:
        """Extrema of y over the orbit's own period, shape (n, 3): time, y, kind (1 or -1)."""
        return extrema_of(self.passage.events)

    @cached_property
    def gap_extrema(self) -> np.ndarray:
        """Extrema of y + s over the orbit's own period, shape (n, 3) as of `extrema`."""
        return self.extrema + np.array([0.0, self.problem.backlash, 0.0])

    @cached_property
    def stiffness_jumps(self) -> np.ndarray:
        """The events at which C(t) jumps."""
        return jumps_of(self.passage.events, jumping_segments(segments_of(self.problem)))

    @property
    def _turns(self) -> np.ndarray:
        events = self.passage.events
        return events[events[:, KIND] == TURN]

    @property
    def y_max(self) -> float:
        """Greatest y."""
        return float(self.extrema[:, 1].max(initial=self.y))

    @property
    def y_min(self) -> float:
        """Least y."""
        return float(self.extrema[:, 1].min(initial=self.y))

    @cached_property
    def certificate(self) -> Certificate:
        """Residual, margin of the extrema, least force and error of the multipliers."""
        turns, back = self._turns, -self.problem.backlash
        inside = turns[:, REGIME] * turns[:, HEIGHT]
        lost, inverse = turns[:, REGIME] == CONTACT_LOSS, turns[:, REGIME] == INVERSE_MESH
        inside[lost] = np.minimum(-turns[lost, HEIGHT], turns[lost, HEIGHT] - back)
        inside[inverse] = back - turns[inverse, HEIGHT]
        corrected = self.state + newton_correction(self.passage, self.state)
        finer = passage(self.problem, corrected, self.periods, share=0.5)
        others = np.linalg.eigvals(finer.jacobian)
        changes = [float(np.abs(others - one).min()) for one in self.multipliers]
        product = np.linalg.det(self.passage.jacobian)
        error = max(*changes, float(abs(product - np.exp(self.passage.log_determinant))))
        return Certificate(
            self.residual, float(inside.min(initial=np.inf)), self.passage.least_force, error
        )

    def shot(self, problem: Problem, state: np.ndarray, periods: int) -> "Orbit":
        """Return another motion, from `state` over mesh periods.

        Raises
        ------
        NoOrbit
            If the motion cannot be integrated.
        """
        if not is_reducible(problem):
            raise NoOrbit("other coordinates are needed there: a term appears")
        if problem.initial_state is not None:
            problem = replace(problem, initial_state=None)
        moved = passage(problem, state, periods)
        if moved.status != "complete":
            raise NoOrbit(f"the motion ends with {moved.status}")
        return Orbit(problem, periods, state, moved)

    def at_phase(self, phase: float) -> "Orbit":
        """Return the orbit with its state taken at another mesh phase."""
        share = (phase - self.problem.initial_phase) % 1.0
        if share == 0.0:
            return self
        state = advance(self.problem, self.state, share)
        problem = replace(self.problem, initial_phase=phase)
        return Orbit(problem, self.periods, state)

    def time_course(self, samples_per_period: int = 256) -> TimeCourse:
        """Return the time course, with `samples_per_period` samples in a mesh period."""
        moved = passage(self.problem, self.state, self.periods, samples_per_period)
        y, v, a, regime = moved.samples.T
        time = np.arange(y.size) * (self.problem.period / samples_per_period)
        return TimeCourse(time, y, v, a, regime.astype(np.int8))


def find_orbit(problem: Problem, periods: int = 1, start: np.ndarray | None = None) -> Orbit:
    """Return an orbit of least period `periods`.

    Parameters
    ----------
    problem : Problem
        Without run-out, profile deviation and Fourier stiffness.
    periods : int
        Least period n in mesh periods, >= 1.
    start : array_like, shape (4,), optional
        y, y', b, b' at the initial phase near the orbit. By default several are tried: the
        periodic motion without contact loss, the ends of long runs, and a grid of states.

    Raises
    ------
    NoOrbit
        If no initial state leads to an orbit.
    """
    if not is_reducible(problem):
        raise NoOrbit(
            "orbits: unequal wheels, run-out, profile deviation, Fourier stiffness and other "
            "general terms are not covered"
        )
    if start is not None:
        return correct(problem, np.asarray(start, float), periods)
    reason = ""
    for state in starts(problem):
        try:
            orbit = correct(problem, state, periods)
        except NoOrbit as error:
            reason = reason or str(error)
            continue
        if max(orbit.y_max, -orbit.y_min) < FARTHEST:
            return orbit
    raise NoOrbit(reason or "the motions that were found are too large")


def correct(problem: Problem, state: np.ndarray, periods: int = 1) -> Orbit:
    """Return the orbit of least period `periods` to which Newton's method leads from a state.

    Raises
    ------
    NoOrbit
        If it does not converge, or leads to an orbit of a shorter period.
    """
    if problem.initial_state is not None:
        problem = replace(problem, initial_state=None)
    stated = statement(problem, periods)
    place = np.append(state, 1.0)
    points, events, _ = trace(stated, place, FIXED, problem.nu, _MOST_CORRECTIONS)
    moved = passage_of(stated, problem.nu, points[0], events[0])
    orbit = Orbit(problem, periods, points[0, :4], moved)
    if moved.status != "complete":
        raise NoOrbit(f"the motion ends with {moved.status}")
    if not orbit.residual < LARGEST_RESIDUAL:
        raise NoOrbit(f"Newton's method stops at a residual of {orbit.residual:.1e}")
    for shorter in range(1, periods):
        if periods % shorter == 0:
            end = passage(problem, orbit.state, shorter).end
            if np.abs(end - orbit.state).max() < _SAME:
                raise NoOrbit(f"Newton's method leads to an orbit of period {shorter}")
    return orbit


def newton_correction(moved: Passage, state: np.ndarray) -> np.ndarray:
    """Return Newton's correction of a state on P^n(x) - x; the shortest one if it is singular."""
    matrix = moved.jacobian - np.eye(4)
    return np.linalg.lstsq(matrix, state - moved.end, rcond=1e-14)[0]


def judged(multipliers: np.ndarray, undamped: bool | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return whether orbits are stable, and whether they are neutral, as of `Orbit`.

    Parameters
    ----------
    multipliers : ndarray, shape (..., 4)
        The largest modulus first.
    undamped : bool or ndarray, shape (...)
    """
    size = np.abs(multipliers[..., 0])
    neutral = undamped & (size < 1.0 + _LEAST_GROWTH)
    return ~neutral & (size < 1.0), neutral


def sorted_multipliers(multipliers: np.ndarray) -> np.ndarray:
    """Return multipliers as complex numbers, the largest modulus first, conjugates together.

    The last axis holds those of an orbit.
    """
    values = multipliers.astype(complex)
    order = np.lexsort([-values.imag, -values.real, -np.abs(values)], axis=-1)
    return np.take_along_axis(values, order, axis=-1)
