"""Test functions: functions of the points of a branch that pass 0 at special points."""

import operator
from collections.abc import Callable, Collection, Sequence

import numpy as np

from gearmesh.dynamics.continuation.kinds import BIFURCATIONS, GRAZINGS
from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.tracing import Track, monodromies
from gearmesh.dynamics.periodic.shots import Motion
from gearmesh.solvers.reduced.derivatives import curves
from gearmesh.solvers.reduced.derivatives.multipliers import products
from gearmesh.solvers.reduced.derivatives.variational import AFTER, BEFORE, VELOCITY

Function = Callable[[Point], float]
"""A function of the points of a branch."""

Test = tuple[str, Function]
"""A kind, and a function that passes 0 at special points of this kind."""

Extrema = Callable[[Motion], np.ndarray]
"""Extrema of an orbit, shape (n, 3): time, height, kind (1 or -1)."""

FRONT: Extrema = operator.attrgetter("extrema")
BACK: Extrema = operator.attrgetter("gap_extrema")
"""The extrema whose height is 0 where flanks graze, on the front and on the back."""

_SAME_PHASE = 0.2  # mesh periods between an extremum and the same one further on


class _Remembered(dict[Point, float]):
    """The values of a function at points, each computed once."""

    def __init__(self, function: Function) -> None:
        self.function = function

    def __missing__(self, point: Point) -> float:
        value = self[point] = self.function(point)
        return value


def bifurcation_tests(kinds: Collection[str]) -> list[Test]:
    """Return the tests of some kinds of bifurcations."""
    return [
        (kind, _Remembered(function).__getitem__)
        for kind, function in zip(BIFURCATIONS, _BIFURCATION_TESTS, strict=True)
        if kind in kinds
    ]


def bifurcation_values(points: Sequence[Point]) -> np.ndarray:
    """Return the tests of all `BIFURCATIONS` at points in a few operations, shape (4, n)."""
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


_BIFURCATION_TESTS: tuple[Function, ...] = (
    operator.attrgetter("slope"),
    operator.attrgetter("determinant"),
    lambda point: flip_test(point.motion),
    lambda point: torus_test(point.motion),
)


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

    return _Remembered(height).__getitem__


def _velocity_at(number: int) -> Function:
    """Return the test of a switch of C(t): the velocity there."""

    def velocity(point: Point) -> float:
        jumps = point.motion.stiffness_jumps
        return float(jumps[number, VELOCITY]) if number < len(jumps) else float("nan")

    return _Remembered(velocity).__getitem__
