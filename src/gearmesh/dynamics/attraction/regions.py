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

from gearmesh.dynamics.attraction.maps import PoincareMap
from gearmesh.dynamics.periodic.shots import Shot

_SIZES = (1e-5, 1e-4, 1e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""Sizes that are tried, in y_st."""

_DIRECTIONS = 64  # motions that try a size, from each point of the orbit
_FEWEST = 16  # the least number of them, where a step of the map takes several mesh periods
_FALL = 0.7  # of the size, in the time over which it is tried
_MOST_PERIODS = 2000
_LEAST_RHO = 0.1


@dataclass(frozen=True)
class Region:
    """A trapping region.

    Attributes
    ----------
    points : ndarray, shape (n, m)
        Coordinates of the orbit after each of its steps of the Poincaré map.
    forms : ndarray, shape (n, m, m)
        Square roots of the quadratic forms: V = |form d|^2.
    size : float
        Root of V on the surface of the region.
    """

    points: np.ndarray
    forms: np.ndarray
    size: float = 0.0

    def distances(self, places: np.ndarray) -> np.ndarray:
        """Return the least root of V of places of shape (r, m), shape (r,)."""
        away = [
            np.linalg.norm((places - point) @ form.T, axis=1)
            for point, form in zip(self.points, self.forms, strict=True)
        ]
        return np.asarray(np.min(away, axis=0))

    def holds(self, places: np.ndarray) -> np.ndarray:
        """Return whether each place is in the region: shape (r, m) gives shape (r,)."""
        return self.distances(places) < self.size


def region_of(moved: PoincareMap, orbit: Shot) -> Region:
    """Return the trapping region of a stable orbit.

    Its size is 0 if the orbit attracts too slowly to be tried.
    """
    states, jacobians = [moved.state_of(orbit)], []
    for _ in range(max(1, orbit.periods // moved.block)):
        end, factors = moved.step(states[-1])
        states.append(end)
        whole = factors[0]
        for factor in factors[1:]:
            whole = factor @ whole
        jacobians.append(whole)
    weights = np.diag(moved.weights**2)
    forms, rho = [], 0.0
    for i in range(len(jacobians)):
        whole = np.eye(len(weights))
        for jacobian in jacobians[i:] + jacobians[:i]:
            whole = jacobian @ whole
        rho = rho or max(_LEAST_RHO, math.sqrt(np.abs(np.linalg.eigvals(whole)).max()))
        form = solve_discrete_lyapunov(whole.T / rho, weights)
        forms.append(np.linalg.cholesky(0.5 * (form + form.T)).T)
    visited = np.array(states[:-1])
    region = Region(moved.coordinates(visited), np.array(forms))
    return replace(region, size=_size(moved, visited, region, rho))


def _size(moved: PoincareMap, visited: np.ndarray, region: Region, rho: float) -> float:
    """Return the largest size up to which motions come closer as the linear map says."""
    repeats = math.ceil(math.log(_FALL) / math.log(rho))
    steps = repeats * len(visited)
    if steps * moved.block > max(_MOST_PERIODS, moved.block):
        return 0.0
    count = max(_FEWEST, _DIRECTIONS // moved.block)
    directions = np.random.default_rng(0).standard_normal((count, len(moved.weights)))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    unit = np.concatenate([np.linalg.solve(form, directions.T).T for form in region.forms])
    centres = np.repeat(visited, count, axis=0)
    fits = 0.0
    for size in _SIZES:
        ends = moved.coordinates(moved.advance(moved.displaced(centres, size * unit), steps))
        if not region.distances(ends).max() <= size * rho**repeats:
            break
        fits = size
    return fits
