"""Branches of the periodic motions on which runs end, of any period.

Many of these motions lie on the branches of `orbits`, which hold the orbits of the mesh period and
those of twice the period that branch off at flips. Others have longer periods, and many branches
are closed (isolas): nothing leads to them from another branch. Each stable orbit on which a run
ends and that lies on no branch so far therefore begins a branch of its own.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from gearmesh.dynamics.attraction.attractors import SAME
from gearmesh.dynamics.attraction.basins import grid
from gearmesh.dynamics.attraction.classification import LongRun, classify
from gearmesh.dynamics.periodic import orbits
from gearmesh.errors import NoOrbit
from gearmesh.interface.branches import Branch, follow
from gearmesh.interface.orbits import Orbit
from gearmesh.model.problem import Problem, State
from gearmesh.model.variants import variant as read_variant
from gearmesh.reproduction.mechanisms.orbits import Range, branches, doubled
from gearmesh.study.pair import Pair

EVERY = 16
"""Runs from other initial states begin at every sixteenth ν_s of a study."""

MOST_PERIODS = 2
"""Longest period of the orbits that are carried over to another pair."""

_SPACING = 8  # points of a branch from one orbit that is carried over to the next
_DECIMALS = 5  # of extremes, in y_st


def all_branches(pair: Pair, variant: str, limits: Range, ends: Iterable[Orbit]) -> list[Branch]:
    """Return the branches of one variant: those of `orbits`, then those of further orbits.

    Parameters
    ----------
    pair : Pair
        The gear pair.
    variant : str
        Name of the variant, such as ``c-lubricant``.
    limits : tuple of float
        Range of ν_s.
    ends : iterable of Orbit
        The further orbits, such as those that are `reached`.
    """
    single = branches(pair, variant, limits)
    known = [*single, *doubled(single, limits)]
    return [*known, *further(known, ends, limits)]


def reached(pair: Pair, variant: str, nus: np.ndarray) -> tuple[list[LongRun], list[Orbit]]:
    """Return how the cases end, and the stable orbits on which runs end, or which they approach.

    A run starts at each ν_s as the case of the study does. At every sixteenth ν_s, 36 more start
    from a grid of y and y'. Orbits of more than 12 mesh periods are not searched for, and neither
    are motions from which the runs are still far after 60 revolutions
    (`gearmesh.dynamics.attraction.classification`). Without damping there are no such orbits,
    because no motion attracts another.

    Parameters
    ----------
    pair : Pair
        The gear pair.
    variant : str
        Name of the variant, such as ``c-lubricant``.
    nus : ndarray, shape (n,)
        The mesh frequencies ν_s of the study, ascending.

    Returns
    -------
    list of LongRun
        The long-run motion of the case at each ν_s.
    list of Orbit
        The orbits of all runs, in the order of ν_s.
    """
    chosen = read_variant(variant)
    cases = [pair.problem(chosen, float(nu)) for nu in nus]
    if not any(cases[0].material + cases[0].lubricant):
        return classify(cases), []
    others = [run for case in cases[::EVERY] for run in _from_grid(case)]
    runs = classify([*cases, *others])
    ends = {_name(run.orbit): run.orbit for run in runs if run.orbit}
    found = [Orbit(pair, chosen, ends[name].problem.nu, ends[name]) for name in sorted(ends)]
    return runs[: len(cases)], found


def carried_over(found: Iterable[Branch], pair: Pair) -> list[Orbit]:
    """Return stable orbits of another pair that are close to orbits on the branches of this one.

    Newton's method begins at every eighth point of each branch of at most `MOST_PERIODS` periods.
    """
    ends = []
    for branch in found:
        if branch.orbit.periods > MOST_PERIODS:
            continue
        for near in branch.found.orbits[::_SPACING]:
            problem = pair.problem(branch.orbit.variant, near.problem.nu)
            try:
                orbit = orbits.correct(problem, near.state, near.periods)
            except NoOrbit:
                continue
            if orbit.stable:
                ends.append(Orbit(pair, branch.orbit.variant, problem.nu, orbit))
    return ends


def _name(orbit: orbits.Orbit) -> tuple[float, ...]:
    """Return the numbers by which runs that end on the same orbit are told."""
    extremes = (round(value, _DECIMALS) for value in (orbit.y_max, orbit.y_min))
    return orbit.problem.nu, orbit.periods, *extremes


def _from_grid(case: Problem) -> list[Problem]:
    return [replace(case, initial_state=State(*state)) for state in grid(case).tolist()]


def further(known: Iterable[Branch], ends: Iterable[Orbit], limits: Range) -> Iterator[Branch]:
    """Follow the orbits that lie on no branch so far, each in both directions.

    Where such a branch ends at a flip of an orbit of half the period, that orbit is followed too.
    """
    found, waiting = list(known), list(ends)
    while waiting:
        orbit = waiting.pop(0)
        if any(holds(branch, orbit) for branch in found):
            continue
        try:
            branch = follow(orbit, "nu", limits)
        except NoOrbit:  # one branch that cannot be followed must not cost the others
            continue
        found.append(branch)
        waiting[:0] = [
            point.orbit for point in branch.special if point.orbit.periods < orbit.periods
        ]
        yield branch


def holds(branch: Branch, orbit: Orbit) -> bool:
    """Return whether an orbit lies on a branch in ν_s.

    Extremes are compared, because they do not depend on the mesh period in which an orbit of
    several periods begins.
    """
    if branch.orbit.periods != orbit.periods:
        return False
    try:
        there = branch.found.resampled(np.array([orbit.nu]))
    except NoOrbit:
        return False
    wanted = orbit.reduced
    away = np.maximum(np.abs(there.y_max - wanted.y_max), np.abs(there.y_min - wanted.y_min))
    return bool((away < SAME).any())
