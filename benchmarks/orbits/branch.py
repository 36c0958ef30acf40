"""Orbits of c-material over nu_s from 0.6 to 1.2, by all methods.

The frequencies are those that `gm.follow` chooses, or those of a grid. All methods but brute force
give the states and all Floquet multipliers. Only `gearmesh` chooses frequencies and finds special
points. The others get the frequencies, the problems with all their constants, and the first orbit
before their time counts.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

import gearmesh as gm
from benchmarks.orbits import following, heyoka_lanes, heyoka_map, scipy_map, settling
from benchmarks.orbits.newton import newton
from benchmarks.reduced import initial_state
from gearmesh.dynamics.continuation.branches import Branch
from gearmesh.dynamics.periodic.orbits import find_orbit, sorted_multipliers

VARIANT, LIMITS, BEGIN = "c-material", (0.6, 1.2), 0.9
N_SCIPY, N_BRUTE = 9, 36
"""Number of orbits, spread over the branch, that the slow methods find."""


@dataclass(frozen=True, slots=True)
class Found:
    """What one method found in one round.

    Attributes
    ----------
    seconds : float
        CPU time of an orbit.
    error : float
        Largest distance of a state from that of `gearmesh`, in y_st and y_st Omega_s; of
        `gearmesh` itself, the largest residual.
    multipliers : float or None
        Largest distance of a multiplier, if there are any.
    orbits : int
    """

    seconds: float
    error: float
    multipliers: float | None
    orbits: int


def ours(nus: np.ndarray | None = None) -> tuple[Found, Branch]:
    """Follow the branch and find its special points, and then the orbits at `nus`, if given."""
    pair = gm.paper()
    start = time.process_time()
    found = gm.follow(gm.find_orbit(pair, VARIANT, BEGIN), "nu", LIMITS).found
    if nus is not None:
        found = found.resampled(nus)
    n_orbits = len(found.multipliers)
    spent = time.process_time() - start
    residual = max(orbit.residual for orbit in found.orbits)
    return Found(spent / n_orbits, residual, 0.0, n_orbits), found


def with_find_orbit(branch: Branch) -> Found:
    """Find the same orbits without the branch, each from the one before."""
    problems = [orbit.problem for orbit in branch.orbits]

    def follow() -> following.Orbits:
        orbits = [branch.orbits[0]]
        for problem in problems[1:]:
            orbits.append(find_orbit(problem, start=orbits[-1].state))
        states = np.array([orbit.state for orbit in orbits])
        return states, np.array([orbit.monodromy for orbit in orbits])

    return _measured(branch, follow)


def with_heyoka(branch: Branch, points: int) -> Found:
    """Newton's method with heyoka, each orbit from so many before it."""
    maps = [heyoka_map.Stroboscope(orbit.problem) for orbit in branch.orbits]
    first = branch.orbits[0].state
    return _measured(branch, lambda: following.one_by_one(maps, branch.values, first, points))


def with_heyoka_in_batches(branch: Branch) -> Found:
    """Newton's method with heyoka on many orbits at once, between orbits that are known."""
    problems = [orbit.problem for orbit in branch.orbits]
    maps = [heyoka_map.Stroboscope(problem) for problem in problems]
    lanes, first = heyoka_lanes.Stroboscopes(problems), branch.orbits[0].state
    return _measured(
        branch, lambda: following.from_coarse_to_fine(maps, lanes, branch.values, first)
    )


def with_scipy(branch: Branch) -> Found:
    """Newton's method with SciPy on a part of the orbits, each from the known ones before."""
    size = following.POINTS
    chosen = np.linspace(size, len(branch.orbits) - 1, N_SCIPY).astype(int)
    maps = {i: scipy_map.Stroboscope(branch.orbits[i].problem) for i in chosen}
    before = {i: np.array([one.state for one in branch.orbits[i - size : i]]) for i in chosen}

    def follow() -> following.Orbits:
        found = [
            newton(maps[i], following.extrapolated(branch.values[i - size : i + 1], before[i]))
            for i in chosen
        ]
        states, jacobians = zip(*found, strict=True)
        return np.array(states), np.array(jacobians)

    return _measured(branch, follow, chosen)


def by_brute_force(branch: Branch) -> Found:
    """Follow runs from rest with heyoka in batches until they repeat; there are no multipliers."""
    chosen = np.linspace(0, len(branch.orbits) - 1, N_BRUTE).astype(int)
    problems = [branch.orbits[i].problem for i in chosen]
    known = np.array([branch.orbits[i].state for i in chosen])
    start = time.process_time()
    states = np.array([initial_state(problem) for problem in problems])
    ends = settling.in_batches(problems, states, heyoka_map.TOLERANCE, settling.repeats)
    spent = time.process_time() - start
    return Found(spent / N_BRUTE, float(np.abs(ends - known).max()), None, N_BRUTE)


def _measured(
    branch: Branch, follow: Callable[[], following.Orbits], chosen: np.ndarray | None = None
) -> Found:
    """Time a method that finds all orbits of the branch, or the chosen ones."""
    start = time.process_time()
    states, jacobians = follow()
    multipliers = sorted_multipliers(np.linalg.eigvals(jacobians))
    spent = time.process_time() - start
    at = np.arange(len(branch.orbits)) if chosen is None else chosen
    known = np.array([branch.orbits[i].state for i in at])
    apart = np.abs(multipliers - branch.multipliers[at])
    error = float(np.abs(states - known).max())
    return Found(spent / len(at), error, float(apart.max()), len(at))


METHODS = {
    "gearmesh, find_orbit from the one before": with_find_orbit,
    "heyoka, Newton from the one before": partial(with_heyoka, points=1),
    "heyoka, Newton from those before": partial(with_heyoka, points=following.POINTS),
    "heyoka in batches, Newton from coarse to fine": with_heyoka_in_batches,
    "heyoka in batches, brute force": by_brute_force,
    "SciPy DOP853, Newton with differences": with_scipy,
}
