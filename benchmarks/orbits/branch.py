"""A branch of orbits of c-material over nu_s from 0.6 to 1.2, by all methods."""

import time
from dataclasses import dataclass

import numpy as np

import gearmesh as gm
from benchmarks.orbits import heyoka_map, scipy_map, settling
from benchmarks.orbits.newton import newton
from benchmarks.reduced import initial_state
from gearmesh.dynamics.continuation.branches import Branch
from gearmesh.dynamics.periodic.orbits import Orbit, find_orbit

VARIANT, LIMITS, BEGIN = "c-material", (0.6, 1.2), 0.9
EVERY_SCIPY, EVERY_BRUTE = 16, 4
"""Of the orbits, which the slow methods find."""


@dataclass(frozen=True, slots=True)
class Found:
    """What one method found in one round.

    Attributes
    ----------
    seconds : float
        CPU time of an orbit.
    error : float
        Largest distance of a state from that of `gearmesh`, in y_st and y_st Omega_s.
    orbits : int
    """

    seconds: float
    error: float
    orbits: int


def ours() -> tuple[Found, Branch]:
    """Follow the branch; the time counts the special points too."""
    pair = gm.paper()
    start = time.process_time()
    orbit = gm.find_orbit(pair, VARIANT, BEGIN)
    found = gm.follow(orbit, "nu", LIMITS).found
    spent = time.process_time() - start
    residual = max(orbit.residual for orbit in found.orbits)
    return Found(spent / len(found.orbits), residual, len(found.orbits)), found


def with_find_orbit(branch: Branch) -> Found:
    """Find the same orbits without the branch, each from the one before."""
    spent, error, state = 0.0, 0.0, branch.orbits[0].state
    for orbit in branch.orbits[1:]:
        start = time.process_time()
        state = find_orbit(orbit.problem, start=state).state
        spent += time.process_time() - start
        error = max(error, float(np.abs(state - orbit.state).max()))
    n_orbits = len(branch.orbits) - 1
    return Found(spent / n_orbits, error, n_orbits)


def with_heyoka(branch: Branch) -> Found:
    """Newton's method with heyoka, each orbit from the one before."""
    return _continued(branch.orbits, heyoka_map.Stroboscope, 1)


def with_scipy(branch: Branch) -> Found:
    """Newton's method with SciPy on a part of the orbits, each from the one beside it."""
    return _continued(branch.orbits, scipy_map.Stroboscope, EVERY_SCIPY)


def by_brute_force(branch: Branch) -> Found:
    """Follow runs from rest with heyoka in batches until they repeat."""
    problems = [orbit.problem for orbit in branch.orbits[::EVERY_BRUTE]]
    start = time.process_time()
    states = np.array([initial_state(problem) for problem in problems])
    ends = settling.in_batches(problems, states, heyoka_map.TOLERANCE, settling.repeats)
    spent = time.process_time() - start
    known = np.array([orbit.state for orbit in branch.orbits[::EVERY_BRUTE]])
    return Found(spent / len(problems), float(np.abs(ends - known).max()), len(problems))


def _continued(orbits: list[Orbit], stroboscope, every: int) -> Found:
    spent, error, chosen = 0.0, 0.0, range(1, len(orbits), every)
    state = orbits[0].state
    for i in chosen:
        if every > 1:
            state = orbits[i - 1].state
        start = time.process_time()
        state = newton(stroboscope(orbits[i].problem), state)
        spent += time.process_time() - start
        error = max(error, float(np.abs(state - orbits[i].state).max()))
    return Found(spent / len(chosen), error, len(chosen))


METHODS = {
    "gearmesh, find_orbit from the one before": with_find_orbit,
    "heyoka, Newton with variational equations": with_heyoka,
    "heyoka in batches, brute force": by_brute_force,
    "SciPy DOP853, Newton with differences": with_scipy,
}
