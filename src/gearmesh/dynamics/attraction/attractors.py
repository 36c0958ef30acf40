"""Attractors: the motions on which runs end, and how they are told apart."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearmesh.dynamics.attraction.kinds import PERIODIC
from gearmesh.dynamics.attraction.maps import PoincareMap
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.errors import NoOrbit

SAME = 1e-6
"""Distance, in y_st, of two numbers that are the same."""

MOST_PERIODS = 12
"""Longest orbit that is searched for, in mesh periods."""

_MOST_STEPS = 4  # the same in steps of the map, where a step takes several mesh periods
_NEAR = 0.1  # distance after n periods, in y_st, of a state that may be close to an orbit
_AS_CLOSE = 2.0


@dataclass(frozen=True)
class Attractor:
    """A motion on which runs end.

    Attributes
    ----------
    kind : str
        One of `gearmesh.dynamics.attraction.kinds.KINDS`.
    orbit : Shot, optional
        The orbit of a periodic attractor.
    exponent : float
        Largest Lyapunov exponent, in Omega_s.
    time_constant : float
        Mesh periods in which a deviation falls by e: -n/ln|mu| with the largest multiplier mu of
        an orbit; of neutral motion that of the periodic motion in contact, which only the bearings
        damp, or infinity if nothing does. Not-a-number if there is none.
    """

    kind: str
    orbit: Shot | None = None
    exponent: float = math.nan
    time_constant: float = math.nan

    @classmethod
    def of(cls, orbit: Shot) -> "Attractor":
        """Return the attractor that a stable orbit is."""
        growth = orbit.growth
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
            return np.full(2, math.nan)
        return max(self.orbit.at_phase(0.0).strobes, key=lambda point: float(point[0]))

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


def returns_after(away: np.ndarray) -> int:
    """Return after how many steps a motion returns, from its distances after 1, 2, 3, ... steps.

    Of those after which it is about as close, the least number counts.
    """
    return int(np.argmax(away < _AS_CLOSE * away.min() + SAME)) + 1


def stable_orbits_near(moved: PoincareMap, states: np.ndarray, most: int) -> Iterator[Shot]:
    """Yield stable orbits close to states after a transient.

    Parameters
    ----------
    moved : PoincareMap
    states : ndarray, shape (n, k)
    most : int
        Number of states from which orbits are searched for: those that return closest to
        themselves within 12 mesh periods, or 4 steps of the map.
    """
    path = [states]
    for _ in range(max(_MOST_STEPS, MOST_PERIODS // moved.block)):
        path.append(moved.advance(path[-1], 1))
    places = np.array([moved.coordinates(one) for one in path])
    away = np.abs((places[1:] - places[0]) * moved.weights).max(axis=2)
    closest = away.min(axis=0)
    for i in np.argsort(closest)[:most]:
        if not closest[i] < _NEAR:
            break
        try:
            orbit = moved.orbit(states[i], returns_after(away[:, i]))
        except NoOrbit:
            continue
        if orbit.stable:
            yield orbit
