"""What is read of the orbits of many points of a branch at once."""

from collections.abc import Sequence

import numpy as np

from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.tracing import Track
from gearmesh.dynamics.periodic.orbits import judged
from gearmesh.solvers.reduced.derivatives import curves


def extremes(points: Sequence[Point]) -> np.ndarray:
    """Return the greatest and the least y of each orbit, shape (n, 2)."""
    if isinstance(points, Track):
        return points.rows[:, [curves.Y_MAX, curves.Y_MIN]]
    return np.array([(one.motion.y_max, one.motion.y_min) for one in points])


def multipliers(points: Sequence[Point]) -> np.ndarray:
    """Return the Floquet multipliers of each orbit, the largest modulus first."""
    if isinstance(points, Track):
        return points.multipliers
    return np.array([one.orbit.multipliers for one in points])


def judgements(points: Sequence[Point]) -> np.ndarray:
    """Return whether each orbit is stable, and whether it is neutral, shape (n, 2)."""
    if isinstance(points, Track):
        undamped = points.rows[:, curves.DAMPING] == 0.0
        return np.stack(judged(points.multipliers, undamped), axis=1)
    return np.array([(one.orbit.stable, one.orbit.neutral) for one in points])
