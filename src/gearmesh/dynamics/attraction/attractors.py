"""Attractors: the motions on which runs end, and how they are told apart."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearmesh.dynamics.orbits import Orbit, correct
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.ensembles import advance, laws_of
from gearmesh.solvers.reduced.period_map import passage

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

WEIGHTS = np.array([1.0, 1.0, 0.01, 0.01])
"""Weights of y, y', b, b' in distances: the bodies hardly act on the mesh."""

SAME = 1e-6
"""Distance, in y_st, of two numbers that are the same."""

_MOST_PERIODS = 12
_NEAR = 0.1  # distance after n periods, in y_st, of a state that may be close to an orbit
_AS_CLOSE = 2.0


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
    exponent : float
        Largest Lyapunov exponent, in Omega_s.
    time_constant : float
        Mesh periods in which a deviation falls by e: -n/ln|mu| with the largest multiplier mu of
        an orbit; of neutral motion that of the periodic motion in contact, which only the bearings
        damp. Not-a-number if there is none.
    """

    kind: str
    orbit: Orbit | None = None
    exponent: float = math.nan
    time_constant: float = math.nan

    @classmethod
    def of(cls, orbit: Orbit) -> "Attractor":
        """Return the attractor that a stable orbit is."""
        growth = math.log(abs(orbit.multipliers[0])) / orbit.periods
        return cls(PERIODIC, orbit, growth / orbit.problem.period, -1.0 / growth)

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
        moved = self.orbit.at_phase(0.0)
        points = [moved.state]
        for _ in range(moved.periods - 1):
            points.append(passage(moved.problem, points[-1]).end)
        return max(points, key=lambda point: float(point[0]))

    @property
    def strobe_y(self) -> float:
        """The greatest y of an orbit at mesh phase 0; not-a-number if it is none."""
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

    def same_as(self, other: "Attractor") -> bool:
        """Return whether two attractors of one gear pair at one frequency are the same."""
        if self.orbit is None or other.orbit is None:
            return self.kind == other.kind
        away = max(abs(self.y_max - other.y_max), abs(self.y_min - other.y_min))
        return self.orbit.periods == other.orbit.periods and away < SAME

    @property
    def rank(self) -> tuple[bool, float, float, str]:
        """Place in lists: orbits by period and y_max, then the other kinds by name."""
        if self.orbit is None:
            return True, 0.0, 0.0, self.kind
        return False, self.orbit.periods, self.y_max, self.kind


def stable_orbits_near(problem: Problem, states: np.ndarray, most: int) -> Iterator[Orbit]:
    """Yield stable orbits close to states after a transient.

    Parameters
    ----------
    problem : Problem
    states : ndarray, shape (n, 4)
        y, y', b, b' at `Problem.initial_phase`.
    most : int
        Number of states from which orbits are searched for: those that return closest to
        themselves within 12 mesh periods.
    """
    laws, moved = laws_of([problem]), [states]
    for _ in range(_MOST_PERIODS):
        moved.append(advance(laws, moved[-1], 1))
    away = np.abs((np.array(moved[1:]) - states) * WEIGHTS).max(axis=2)
    closest = away.min(axis=0)
    for i in np.argsort(closest)[:most]:
        if not closest[i] < _NEAR:
            break
        # The least period of those that return about as close.
        periods = int(np.argmax(away[:, i] < _AS_CLOSE * closest[i] + SAME)) + 1
        try:
            orbit = correct(problem, states[i], periods)
        except NoOrbit:
            continue
        if orbit.stable:
            yield orbit
