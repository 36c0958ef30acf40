"""Points of curves of orbits, and what is read of their motions."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from gearmesh.dynamics.periodic.shots import Motion, Shot


@dataclass(eq=False)
class Point:
    """A point of a curve of orbits.

    Attributes
    ----------
    place : ndarray, shape (k + m,)
        The k numbers of the state, and the m parameters in units of the curve.
    values : tuple of float
        The parameters.
    tangent : ndarray, shape (k + m,)
        Unit tangent of the curve.
    determinant : float
        Determinant of the Jacobian of P^n(x) - x (and of the condition) in state and parameters,
        bordered by the tangent.
    motion : Motion
    made : callable
        Returns the orbit.
    """

    place: np.ndarray
    values: tuple[float, ...]
    tangent: np.ndarray
    determinant: float
    motion: Motion = field(repr=False)
    made: Callable[[], Shot] = field(repr=False)

    @cached_property
    def orbit(self) -> Shot:
        """The orbit."""
        return self.made()

    @property
    def slope(self) -> float:
        """Change of the first parameter along the tangent, in units of the curve."""
        return float(self.tangent[-len(self.values)])

    @property
    def size(self) -> float:
        """Greatest distance of y from 0."""
        return max(self.motion.y_max, -self.motion.y_min)

    def reversed(self) -> "Point":
        """Return the same point, seen in the other direction along the curve."""
        back = -self.tangent, -self.determinant
        return Point(self.place, self.values, *back, self.motion, self.made)
