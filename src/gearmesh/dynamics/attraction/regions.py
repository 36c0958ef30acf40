"""Trapping regions: ellipsoids around the points of a stable orbit that no motion leaves.

Let M be the Jacobian of the period of an orbit, and rho lie between its largest multiplier and 1.
The quadratic form V(d) = sum over k of |M^k d|^2 / rho^(2k) then falls by the factor rho^2 in each
period of the linear map, and near the orbit it falls in the full map too. How far from the orbit
that holds is tried: motions from the surface of the region have to come as close as the linear map
says. This is a check and no proof. A run that has entered such a region need not be followed to
its end.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from gearmesh.dynamics.attraction.attractors import WEIGHTS
from gearmesh.dynamics.orbits import Orbit
from gearmesh.solvers.reduced.ensembles import advance, laws_of
from gearmesh.solvers.reduced.period_map import passage

_SIZES = (1e-5, 1e-4, 1e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""Sizes that are tried, in y_st."""

_DIRECTIONS = 64  # motions that try a size, from each point of the orbit
_FALL = 0.7  # of the size, in the time over which it is tried
_MOST_PERIODS = 2000


@dataclass(frozen=True)
class Region:
    """A trapping region.

    Attributes
    ----------
    points : ndarray, shape (n, 4)
        States of the orbit at its phase in each of its mesh periods.
    forms : ndarray, shape (n, 4, 4)
        Square roots of the quadratic forms: V = |form d|^2.
    size : float
        Root of V on the surface of the region.
    """

    points: np.ndarray
    forms: np.ndarray
    size: float = 0.0

    def distances(self, states: np.ndarray) -> np.ndarray:
        """Return the least root of V of states of shape (m, 4), shape (m,)."""
        away = [
            np.linalg.norm((states - point) @ form.T, axis=1)
            for point, form in zip(self.points, self.forms, strict=True)
        ]
        return np.asarray(np.min(away, axis=0))

    def holds(self, states: np.ndarray) -> np.ndarray:
        """Return which states of shape (m, 4) are in the region, shape (m,)."""
        return self.distances(states) < self.size


def region_of(orbit: Orbit, phase: float) -> Region:
    """Return the trapping region of a stable orbit at a mesh phase.

    Its size is 0 if the orbit attracts too slowly to be tried.
    """
    orbit = orbit.at_phase(phase)
    rho = math.sqrt(abs(orbit.multipliers[0]))
    points, jacobians = [orbit.state], []
    for _ in range(orbit.periods):
        moved = passage(orbit.problem, points[-1])
        points.append(moved.end)
        jacobians.append(moved.jacobian)
    weights = np.diag(WEIGHTS**2)
    forms = []
    for i in range(orbit.periods):
        whole = np.eye(4)
        for jacobian in jacobians[i:] + jacobians[:i]:
            whole = jacobian @ whole
        form = solve_discrete_lyapunov(whole.T / rho, weights)
        forms.append(np.linalg.cholesky(0.5 * (form + form.T)).T)
    region = Region(np.array(points[:-1]), np.array(forms))
    return replace(region, size=_size(orbit, region, rho))


def _size(orbit: Orbit, region: Region, rho: float) -> float:
    """Return the largest size up to which motions come closer as the linear map says."""
    repeats = math.ceil(math.log(_FALL) / math.log(rho))
    if repeats * orbit.periods > _MOST_PERIODS:
        return 0.0
    directions = np.random.default_rng(0).standard_normal((_DIRECTIONS, 4))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    unit = np.concatenate([np.linalg.solve(form, directions.T).T for form in region.forms])
    centres = np.repeat(region.points, _DIRECTIONS, axis=0)
    starts = np.concatenate([centres + size * unit for size in _SIZES])
    ends = advance(laws_of([orbit.problem]), starts, repeats * orbit.periods)
    farthest = region.distances(ends).reshape(len(_SIZES), -1).max(axis=1)
    fits = farthest <= np.array(_SIZES) * rho**repeats
    return (0.0, *_SIZES)[int(np.logical_and.accumulate(fits).sum())]
