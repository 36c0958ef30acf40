"""Test functions: functions of the points of a branch that pass 0 at special points."""

import operator
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.tracing import Track, monodromies
from gearmesh.dynamics.periodic.shots import Motion
from gearmesh.solvers.reduced.derivatives import curves
from gearmesh.solvers.reduced.derivatives.multipliers import products
from gearmesh.solvers.reduced.derivatives.variational import VELOCITY

Function = Callable[[Point], float]
"""A function of the points of a branch."""

Extrema = Callable[[Motion], np.ndarray]
"""Extrema of an orbit, shape (n, 3): time, height, kind (1 or -1)."""

FRONT: Extrema = operator.attrgetter("extrema")
BACK: Extrema = operator.attrgetter("gap_extrema")
"""The extrema whose height is 0 where flanks graze, on the front and on the back."""

NOTHING = np.empty((0, 0)), np.empty(0)
"""No known values."""

_SAME_PHASE = 0.2  # mesh periods between an extremum and the same one further on


class Test(NamedTuple):
    """A function that passes 0 at special points of a kind.

    Attributes
    ----------
    kind : str
    function : callable
    around : tuple of ndarray, shapes (m, k) and (m,)
        Places nearby, and values there that are known already.
    """

    kind: str
    function: Function
    around: tuple[np.ndarray, np.ndarray] = NOTHING


class _Remembered(dict[Point, float]):
    """The values of a function at points, each computed once."""

    def __init__(self, function: Function) -> None:
        self.function = function

    def __missing__(self, point: Point) -> float:
        value = self[point] = self.function(point)
        return value


def bifurcation_test(kind: str) -> Function:
    """Return the test function of one of the `BIFURCATIONS`."""
    return _Remembered(_BIFURCATION_TESTS[kind]).__getitem__


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


_BIFURCATION_TESTS: dict[str, Function] = {
    "fold": operator.attrgetter("slope"),
    "branch_point": operator.attrgetter("determinant"),
    "flip": lambda point: flip_test(point.motion),
    "torus": lambda point: torus_test(point.motion),
}


def height_near(extrema: Extrema, phase: float, kind: float) -> Function:
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


def velocity_at(number: int) -> Function:
    """Return the test of a switch of C(t): the velocity there."""

    def velocity(point: Point) -> float:
        jumps = point.motion.stiffness_jumps
        return float(jumps[number, VELOCITY]) if number < len(jumps) else float("nan")

    return _Remembered(velocity).__getitem__
