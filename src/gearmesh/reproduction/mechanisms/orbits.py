"""The branches of orbits of one variant over ν_s, and their special points."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from gearmesh.errors import NoOrbit
from gearmesh.interface.branches import Branch, follow
from gearmesh.interface.orbits import Orbit, find_orbit
from gearmesh.study.pair import Pair

Range = tuple[float, float]
"""Lowest and highest ν_s."""

WITHOUT_SUPPORTS: dict[str, Any] = {
    "friction_coefficient": 0,
    "body_mass": "1e9 kg",
    "bearing_stiffness": "1e12 N/mm",
}
"""Parameters of the second set: no friction, wheels that cannot move sideways. The mesh alone
acts then, and several special points are known in closed form."""

_SAME = 1e-6  # distance in ν_s or in the state between two that are the same


def branches(pair: Pair, variant: str, limits: Range) -> list[Branch]:
    """Follow the orbits of the mesh period.

    Orbits are searched for in the middle and at the ends of the range, because a branch may leave
    the range and come back as another one.

    Parameters
    ----------
    pair : Pair
        The gear pair.
    variant : str
        Name of the variant, such as ``c-lubricant``.
    limits : tuple of float
        Range of ν_s.

    Returns
    -------
    list of Branch
        It is empty if no orbit is found.
    """
    single: list[Branch] = []
    for nu in (0.5 * sum(limits), *limits):
        try:
            orbit = find_orbit(pair, variant, nu)
            if not any(_ends_at(branch, orbit) for branch in single):
                single.append(follow(orbit, "nu", limits))
        except NoOrbit:
            continue
    return single


def _ends_at(branch: Branch, orbit: Orbit) -> bool:
    """Return whether an orbit at an end of the range is an end of a branch."""
    ends = branch.at(0), branch.at(-1)
    return any(
        max(abs(end.nu - orbit.nu), *np.abs(end.found.state - orbit.found.state)) < _SAME
        for end in ends
    )


def doubled(single: Sequence[Branch], limits: Range) -> Iterator[Branch]:
    """Follow the orbits of twice the period that branch off at the flips of some branches.

    A branch on which there are several of these flips is followed once.
    """
    passed: list[float] = []
    for point in (point for branch in single for point in branch.special):
        if point.kind != "flip" or any(abs(point.nu - nu) < _SAME for nu in passed):
            continue
        try:
            branch = follow(point.double_period(), "nu", limits)
        except NoOrbit:
            continue
        passed += [other.nu for other in branch.special if other.kind == "flip"]
        yield branch
