"""Attractors: the motions on which runs end, and the initial conditions that lead there.

Many runs are integrated through their transients side by side. The end of each run is then compared
with the orbits that Newton's method finds from there. Motions that are not orbits are classified by
the damping that still acts and by their Lyapunov exponents.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np

from gearmesh.dynamics.continuation import at_phase
from gearmesh.dynamics.lyapunov import LyapunovSpectrum, lyapunov_spectrum
from gearmesh.dynamics.orbits import Orbit, correct, newton_correction
from gearmesh.dynamics.starts import coordinates
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem, State
from gearmesh.solvers.reduced.period_map import passage
from gearmesh.solvers.simulation import simulate

PERIODIC, NEUTRAL, QUASI_PERIODIC, CHAOTIC, MOVING, LOST = (
    "periodic",
    "neutral",
    "quasi-periodic",
    "chaotic",
    "moving",
    "lost",
)
"""Kinds of attractors: an orbit; motion on which no damping acts any more; motion that fills a
closed curve; chaos; a motion that still changes after the transient; a run that failed."""

TRANSIENT = 60
"""Revolutions of a run before its end is classified."""

_MOST_PERIODS = 8
_NEAR = 0.1  # distance from an orbit, in y_st, at which a run may be approaching it
_SETTLED = 1e-5  # distance at which it has arrived
_PATIENCE = 10.0  # time constants of the orbit within which the distance must fall
_APPROACH = 0.5  # to this share; it may grow first
_MEASURED = 400  # mesh periods over which a motion that is not an orbit is classified
_LEAST_GROWTH = 1e-3  # Lyapunov exponent of chaos, in Omega_s
_LEAST_CHANGE = 1e-6  # of the greatest and least y, in y_st
_SAME = 1e-6  # of the extrema of one orbit, in y_st
_SAMPLES = 64  # in a mesh period


@dataclass(frozen=True)
class Attractor:
    """A motion on which runs end.

    Attributes
    ----------
    kind : str
        ``"periodic"``, ``"neutral"``, ``"quasi-periodic"``, ``"chaotic"``, ``"moving"`` or
        ``"lost"``.
    orbit : Orbit, optional
        The orbit of a periodic attractor.
    spectrum : LyapunovSpectrum, optional
        Lyapunov exponents of a motion that is no orbit.
    """

    kind: str
    orbit: Orbit | None = None
    spectrum: LyapunovSpectrum | None = None

    @property
    def label(self) -> str:
        """A name that depends on the attractor alone, not on how it was found.

        For an orbit it is the period and the stroboscopic point (y, y') of greatest y at mesh
        phase 0; otherwise the kind.
        """
        if self.orbit is None:
            return self.kind
        return f"period {self.orbit.periods} at ({self.strobe_y:.4f}, {self.strobe_v:.4f})"

    @cached_property
    def _strobe(self) -> np.ndarray:
        if self.orbit is None:
            return np.full(4, math.nan)
        return max(points(at_phase(self.orbit, 0.0)), key=lambda point: float(point[0]))

    @property
    def strobe_y(self) -> float:
        """The greatest y of an orbit at mesh phase 0; not a number if it is none."""
        return float(self._strobe[0])

    @property
    def strobe_v(self) -> float:
        """Rate y' at that point."""
        return float(self._strobe[1])

    @property
    def y_max(self) -> float:
        """Greatest y of an orbit."""
        return self.orbit.y_max if self.orbit else math.nan

    @property
    def y_min(self) -> float:
        """Least y of an orbit."""
        return self.orbit.y_min if self.orbit else math.nan

    @property
    def time_constant(self) -> float:
        """Mesh periods in which a deviation from an orbit falls by e; not a number if none."""
        if self.orbit is None:
            return math.nan
        return -self.orbit.periods / math.log(abs(self.orbit.multipliers[0]))


class Reached(NamedTuple):
    """Which attractor each of several runs reaches.

    Attributes
    ----------
    attractors : list of Attractor
        Orbits in the order of their period and their greatest y, then the other kinds.
    labels : ndarray of int, shape (n,)
        Index of the attractor of each run.
    """

    attractors: list[Attractor]
    labels: np.ndarray


def reached(problems: Sequence[Problem], transient: int = TRANSIENT) -> Reached:
    """Return which attractors runs of one gear pair at one frequency reach.

    Parameters
    ----------
    problems : sequence of Problem
        They differ in initial state and initial phase only.
    transient : int
        Revolutions before the motion is classified.
    """
    runs = [replace(one, revolutions=transient, kept_revolutions=0) for one in problems]
    known: list[Attractor] = []
    labels = np.empty(len(runs), int)
    for i, response in enumerate(simulate(runs, estimate_errors=False)):
        if response.final_state is None:
            found = Attractor(LOST)
        else:
            found = attractor_at(runs[i], coordinates(response.final_state), known)
        labels[i] = next((j for j, one in enumerate(known) if _same(one, found)), len(known))
        if labels[i] == len(known):
            known.append(found)
    order = sorted(range(len(known)), key=lambda j: _rank(known[j]))
    return Reached([known[j] for j in order], np.argsort(order)[labels])


def grid(problem: Problem) -> list[Problem]:
    """Return runs from a grid of initial conditions that reaches through the backlash."""
    rest = -2.0 / problem.bearing_stiffness
    heights = (-problem.backlash - 1.0, -0.5 * problem.backlash, 0.0, 1.0, 2.0, 4.0)
    rates = (-4.0, -2.0, -0.7, 0.7, 2.0, 4.0)
    states = [State(y, v, rest, 0.0) for y, v in product(heights, rates)]
    return [replace(problem, initial_state=state) for state in states]


def attractor_at(problem: Problem, state: np.ndarray, known: Sequence[Attractor] = ()) -> Attractor:
    """Return the attractor of a motion from its state after the transient.

    Parameters
    ----------
    problem : Problem
    state : array_like, shape (4,)
        y, y', b, b' at `Problem.initial_phase`.
    known : sequence of Attractor
        Attractors of the same gear pair and frequency that are tried first.
    """
    for attractor in known:
        if attractor.orbit and _distance(attractor.orbit, problem, state) < _SETTLED:
            return attractor
    for periods in range(1, _MOST_PERIODS + 1):
        moved = passage(problem, state, periods)
        if np.abs(newton_correction(moved, state)).max() < _NEAR:
            try:
                orbit = correct(problem, state, periods)
            except NoOrbit:
                continue
            if orbit.stable and _arrives(orbit, state):
                return Attractor(PERIODIC, orbit)
    return _unordered(problem, state)


def _unordered(problem: Problem, state: np.ndarray) -> Attractor:
    """Classify a motion that is not an orbit."""
    spectrum = lyapunov_spectrum(problem, state, _MEASURED)
    if spectrum.exponents[0] > max(_LEAST_GROWTH, 3.0 * spectrum.errors[0]):
        return Attractor(CHAOTIC, spectrum=spectrum)
    if spectrum.damping == 0.0:
        return Attractor(NEUTRAL, spectrum=spectrum)
    first, second = (
        passage(problem, start, _MEASURED, _SAMPLES).samples[:, 0]
        for start in (state, spectrum.end)
    )
    change = max(abs(second.max() - first.max()), abs(second.min() - first.min()))
    return Attractor(QUASI_PERIODIC if change < _LEAST_CHANGE else MOVING, spectrum=spectrum)


def points(orbit: Orbit) -> list[np.ndarray]:
    """Return the states of an orbit at its phase in each of its mesh periods."""
    found = [orbit.state]
    for _ in range(orbit.periods - 1):
        found.append(passage(orbit.problem, found[-1]).end)
    return found


def _distance(orbit: Orbit, problem: Problem, state: np.ndarray) -> float:
    """Return the distance in y_st from a state to the nearest stroboscopic point of an orbit."""
    moved = points(at_phase(orbit, problem.initial_phase))
    return min(float(np.abs(point - state).max()) for point in moved)


def _arrives(orbit: Orbit, state: np.ndarray) -> bool:
    """Return whether the motion from a state near a stable orbit comes closer to it."""
    before = _distance(orbit, orbit.problem, state)
    if before < _SETTLED:
        return True
    if before > _NEAR:
        return False
    duration = math.ceil(-_PATIENCE / math.log(abs(orbit.multipliers[0])))
    end = passage(orbit.problem, state, orbit.periods * duration).end
    return _distance(orbit, orbit.problem, end) < _APPROACH * before


def _same(one: Attractor, other: Attractor) -> bool:
    if one.orbit is None or other.orbit is None:
        return one.label == other.label
    left, right = one.orbit, other.orbit
    away = max(abs(left.y_max - right.y_max), abs(left.y_min - right.y_min))
    return left.periods == right.periods and away < _SAME


def _rank(attractor: Attractor) -> tuple[bool, float, float, str]:
    orbit = attractor.orbit
    if orbit is None:
        return True, 0.0, 0.0, attractor.kind
    return False, orbit.periods, orbit.y_max, attractor.kind


class Basins(NamedTuple):
    """Which attractor each initial condition leads to.

    Attributes
    ----------
    attractors : list of Attractor
    labels : ndarray of int, shape (phases, heights, velocities)
        Index of the attractor that each initial condition leads to.
    shares : ndarray, shape (n_attractors, 3)
        Share of the initial conditions that lead to each attractor (basin stability), and the ends
        of its 95 % Wilson interval.
    """

    attractors: list[Attractor]
    labels: np.ndarray
    shares: np.ndarray


def basins(
    problem: Problem,
    y: np.ndarray,
    v: np.ndarray,
    phases: Sequence[float] | None = None,
    transient: int = TRANSIENT,
) -> Basins:
    """Return the attractors to which the initial conditions of a grid of y, y' and phase lead.

    Parameters
    ----------
    problem : Problem
    y, v : array_like, shape (heights,) and (velocities,)
        Initial relative motion and its rate; the bodies are in static equilibrium under F_st.
    phases : sequence of float, optional
        Initial phases; that of `problem` if not given.
    transient : int
        Revolutions before the motion is classified.
    """
    phases = [problem.initial_phase] if phases is None else list(phases)
    rest = -2.0 / problem.bearing_stiffness
    runs = [
        replace(problem, initial_phase=phase, initial_state=State(height, rate, rest, 0.0))
        for phase, height, rate in product(phases, map(float, y), map(float, v))
    ]
    found = reached(runs, transient)
    counts = np.bincount(found.labels, minlength=len(found.attractors))
    shares = np.array([wilson_interval(count, len(runs)) for count in counts])
    return Basins(found.attractors, found.labels.reshape(len(phases), len(y), len(v)), shares)


def wilson_interval(count: int, total: int, deviations: float = 1.959964) -> list[float]:
    """Return the share of `count` in `total`, and its Wilson interval (95 % by default)."""
    share, square = count / total, deviations**2
    middle = (share + 0.5 * square / total) / (1.0 + square / total)
    half = deviations / (1.0 + square / total)
    half *= math.sqrt(share * (1.0 - share) / total + 0.25 * square / total**2)
    return [share, middle - half, middle + half]
