"""Test functions: functions of the points of a branch that pass 0 at special points."""

import operator
from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from gearmesh.dynamics.continuation.kinds import BIFURCATIONS, GRAZINGS
from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.tracing import Track, monodromies
from gearmesh.dynamics.periodic.shots import Motion
from gearmesh.solvers.reduced.derivatives import curves
from gearmesh.solvers.reduced.derivatives.multipliers import products
from gearmesh.solvers.reduced.derivatives.variational import AFTER, BEFORE, VELOCITY

Function = Callable[[Point], float]
"""A function of the points of a branch, which remembers its values."""

Test = tuple[str, Function]
"""A kind, and a function that passes 0 at special points of this kind."""

Extrema = Callable[[Motion], np.ndarray]
"""Extrema of an orbit, shape (n, 3): time, height, kind (1 or -1)."""

FRONT: Extrema = operator.attrgetter("extrema")
BACK: Extrema = operator.attrgetter("gap_extrema")
"""The extrema whose height is 0 where flanks graze, on the front and on the back."""

_SAME_PHASE = 0.2  # mesh periods between an extremum and the same one further on


def bifurcation_tests() -> list[Test]:
    """Return the tests of all bifurcations, in the order of `BIFURCATIONS`."""
    tests: tuple[Function, ...] = (
        operator.attrgetter("slope"),
        operator.attrgetter("determinant"),
        cache(lambda point: flip_test(point.motion)),
        cache(lambda point: torus_test(point.motion)),
    )
    return list(zip(BIFURCATIONS, tests, strict=True))


def bifurcation_values(points: Sequence[Point]) -> np.ndarray:
    """Return the values of `bifurcation_tests` at points in a few operations, shape (4, n)."""
    if isinstance(points, Track):
        rows = points.rows
        slopes, determinants = rows[:, curves.DETERMINANT - 1], rows[:, curves.DETERMINANT]
        matrices, undamped = monodromies(rows), rows[:, curves.DAMPING] == 0.0
    else:
        slopes = np.array([point.slope for point in points])
        determinants = np.array([point.determinant for point in points])
        matrices = np.array([point.motion.monodromy for point in points])
        undamped = np.array([point.motion.undamped for point in points])
    flips, pairs = products(matrices)
    return np.array([slopes, determinants, flips, np.where(undamped, np.nan, pairs)])


def flip_test(orbit: Motion) -> float:
    """Return the product of all mu_i + 1."""
    return float(products(orbit.monodromy[None])[0, 0])


def torus_test(orbit: Motion) -> float:
    """Return the product of all mu_i mu_k - 1, which is 0 where a pair is on the unit circle.

    Without damping in the mesh a pair may be there all along the branch; the result is then
    not-a-number.
    """
    return float("nan") if orbit.undamped else float(products(orbit.monodromy[None])[1, 0])


def event_tests(left: Point, right: Point, kinds: set[str]) -> list[Test]:
    """Return the tests of some kinds for events that appear or vanish between two points."""
    tests: list[Test] = []
    for name, extrema in zip(GRAZINGS, (FRONT, BACK), strict=True):
        if name in kinds:
            period = left.motion.period
            for time, _, kind in extrema(left.motion).tolist():
                tests.append((name, _height(extrema, time / period, kind)))
    if "switching" in kinds:
        turning = set()
        for point in (left, right):
            jumps = point.motion.stiffness_jumps
            turning |= set(np.flatnonzero(jumps[:, BEFORE] * jumps[:, AFTER] < 0.0).tolist())
        tests += [("switching", _velocity_at(number)) for number in sorted(turning)]
    return tests


def _height(extrema: Extrema, phase: float, kind: float) -> Function:
    """Return the test of the extremum of a kind near a phase: its height."""

    def height(point: Point) -> float:
        motion, best = point.motion, _SAME_PHASE
        period, periods, found = motion.period, motion.periods, float("nan")
        for time, y, kind_there in extrema(motion).tolist():
            away = time / period - phase
            away = abs(away - periods * round(away / periods))
            if kind_there == kind and away <= best:
                found, best = y, away
        return found

    return cache(height)


def _velocity_at(number: int) -> Function:
    """Return the test of a switch of C(t): the velocity there."""

    def velocity(point: Point) -> float:
        jumps = point.motion.stiffness_jumps
        return float(jumps[number, VELOCITY]) if number < len(jumps) else float("nan")

    return cache(velocity)
