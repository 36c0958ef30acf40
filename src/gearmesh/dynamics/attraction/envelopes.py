"""The envelope of motion that never loses contact, where nothing damps the mesh in contact.

The equations in normal mesh are then linear. The deviation from their periodic motion is a sum of
modes, each of which turns and, by what the bearings take, decays. The sum of the amplitudes bounds
y from below for all times. If this bound is above 0, contact is never lost again, and nothing in
the mesh damps the motion any more: it is neutral.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.linalg import expm

from gearmesh.dynamics.starts import linear_rates
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.derivatives.period_map import segments_of

RISE = 0.8
"""Contact losses vanish in the end if their margin rises to this share, or higher, while the time
from the start doubles or grows by half."""

_PLACES = 256  # in a mesh period
_STRIDE = 16  # of the places that are tried first
_GROWTH = 1e-9  # above 1, of a multiplier that grows
_CHUNK = 4096


@dataclass(frozen=True)
class Envelope:
    """The lower bound of y of motions in normal mesh.

    Attributes
    ----------
    centre : ndarray, shape (4,)
        State of the periodic motion.
    modes : ndarray, shape (4, 4)
        Complex; the amplitudes of the modes are ``modes @ (state - centre)``.
    height : ndarray, shape (m,)
        y of the periodic motion at m places of the mesh period.
    swing : ndarray, shape (m, 4)
        How far y swings there if the amplitude of a mode is 1.
    time_constant : float
        Mesh periods in which the slowest mode decays by e.
    """

    centre: np.ndarray
    modes: np.ndarray
    height: np.ndarray
    swing: np.ndarray
    time_constant: float

    def margins(self, states: np.ndarray) -> np.ndarray:
        """Return the bound of y over all later times for states of shape (n, 4), shape (n,)."""
        found = np.empty(len(states))
        for first in range(0, len(states), _CHUNK):
            chunk = slice(first, first + _CHUNK)
            amplitudes = np.abs((states[chunk] - self.centre) @ self.modes.T)
            found[chunk] = (self.height - amplitudes @ self.swing.T).min(axis=1)
        return found

    def is_above(self, states: np.ndarray, level: float) -> np.ndarray:
        """Return for which states the bound is above a level, shape (n,)."""
        coarse = replace(self, height=self.height[::_STRIDE], swing=self.swing[::_STRIDE])
        above = coarse.margins(states) > level
        above[above] = self.margins(states[above]) > level
        return above


def envelope_of(problem: Problem) -> Envelope | None:
    """Return the envelope in normal mesh; None if damping acts there, or if motion grows."""
    if any(problem.material):
        return None
    return _envelope_of(replace(problem, lubricant=(0.0, 0.0, 0.0), initial_state=None))


@lru_cache(maxsize=512)
def _envelope_of(problem: Problem) -> Envelope | None:
    """Return the envelope, which does not depend on the damping in contact loss."""
    moved, rows = np.eye(5), []
    for length, c, g in segments_of(problem):
        places = math.ceil(_PLACES * length / problem.period)
        step = expm(linear_rates(problem, c, g) * (length / places))
        for _ in range(places):
            rows.append(moved[0])
            moved = step @ moved
    multipliers, vectors = np.linalg.eig(moved[:4, :4])
    slowest = float(np.abs(multipliers).max())
    if slowest > 1.0 + _GROWTH:
        return None
    heights = np.array(rows)
    centre = np.linalg.solve(np.eye(4) - moved[:4, :4], moved[:4, 4])
    height = heights[:, :4] @ centre + heights[:, 4]
    if height.min() <= 0.0:
        return None
    return Envelope(
        centre,
        np.linalg.inv(vectors),
        height,
        np.abs(heights[:, :4] @ vectors),
        -1.0 / math.log(slowest) if slowest < 1.0 else math.inf,
    )
