"""Special points of a branch, located as the zeros of test functions."""

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations, pairwise

import numpy as np

from gearmesh.dynamics.continuation.curves import Curve
from gearmesh.dynamics.continuation.kinds import BIFURCATIONS, GRAZINGS
from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.test_functions import (
    Test,
    bifurcation_test,
    bifurcation_values,
)
from gearmesh.dynamics.continuation.zeros import Beside, length_between, zeros
from gearmesh.dynamics.periodic.shots import Motion, Shot
from gearmesh.solvers.reduced.derivatives.variational import AFTER, BEFORE, VELOCITY

_NARROWEST_PIECE = 1e-11  # between two grazings, in which multipliers are tested
_FAR = 2.0  # times its changes between points nearby: more than a function falls between two
_LARGEST_VALUE = 1e-7  # of a test function at its root: more is a jump
_LEAST_SLOPE = 1e-8  # of the parameter along a branch; less may be rounding
_ASIDE = 1e-4  # distance along a branch
_SAME_SWITCHING = 1e-9  # distance in the parameter


@dataclass(frozen=True)
class SpecialPoint:
    """A point of a branch where something changes.

    Attributes
    ----------
    kind : str
        One of `gearmesh.dynamics.continuation.kinds.KINDS`.
    nu : float
        Mesh frequency nu_s.
    parameters : dict
        The parameter that the branch follows, by name.
    orbit : Shot
    """

    kind: str
    nu: float
    parameters: dict[str, float]
    orbit: Shot


def search(
    curve: Curve, left: Point, right: Point, tests: list[Test], beside: Beside | None = None
) -> list[tuple[str, Point]]:
    """Return where tests pass 0 between two neighbouring points of a curve, in their order."""
    beside = beside or cache(curve.beside)
    found = [
        (test.kind, point)
        for test in tests
        for start, point, end in zeros(curve, left, right, test, beside)
        if _confirmed(test, start, point, end, beside)
    ]
    return _in_order(left, found)


def special_points(
    curve: Curve, points: Sequence[Point], i: int, tests: list[Test], bifurcating: np.ndarray
) -> list[tuple[str, Point]]:
    """Return the special points that tests show between points i and i + 1, in their order.

    Multipliers have a root singularity where the orbit grazes, so they are tested in the pieces
    between the grazings and not across them. Wherever an orbit grazes, all of them are tested.

    Parameters
    ----------
    curve : Curve
    points : sequence of Point, length n
    i : int
    tests : list of Test
    bifurcating : ndarray, shape (4, n)
        The values of `bifurcation_values` at the points.
    """
    left, right, beside = points[i], points[i + 1], cache(curve.beside)
    bifurcations = [test for test in tests if test.kind in BIFURCATIONS]
    others = [test for test in tests if test.kind not in BIFURCATIONS]
    found = _once(search(curve, left, right, others, beside))
    grazings = [point for kind, point in found if kind in GRAZINGS]
    if not grazings:
        return _in_order(left, found + search(curve, left, right, bifurcations, beside))
    # Nothing changes beyond the ends of the branch.
    known = bifurcating[:, [max(i - 1, 0), i, i + 1, min(i + 2, len(points) - 1)]]
    far = _far_from_zero(np.hstack([known[:, :2], bifurcation_values(grazings), known[:, 2:]]))
    for ends, keeps in zip(pairwise([left, *grazings, right]), far.T, strict=True):
        if length_between(*ends) > _NARROWEST_PIECE:
            tests = [
                Test(kind, bifurcation_test(kind))
                for kind, keeps_its_sign in zip(BIFURCATIONS, keeps.tolist(), strict=True)
                if not keeps_its_sign
            ]
            found = found + search(curve, *ends, tests, beside)
    return _in_order(left, found)


def _far_from_zero(values: np.ndarray) -> np.ndarray:
    """Return whether functions are so far from 0 that they keep their sign between two points.

    Parameters
    ----------
    values : ndarray, shape (m, n)
        At successive points.

    Returns
    -------
    ndarray of bool, shape (m, n - 3)
        For the pieces between two points which have another point on each side.
    """
    size, change = np.abs(values), np.abs(np.diff(values))
    least = np.minimum(size[:, 1:-2], size[:, 2:-1])
    most = np.maximum(np.maximum(change[:, :-2], change[:, 2:]), change[:, 1:-1])
    return ((values[:, 1:-2] < 0.0) == (values[:, 2:-1] < 0.0)) & (least > _FAR * most)


def _in_order(left: Point, found: list[tuple[str, Point]]) -> list[tuple[str, Point]]:
    return sorted(found, key=lambda item: float(left.tangent @ item[1].place))


def _once(events: list[tuple[str, Point]]) -> list[tuple[str, Point]]:
    """Leave out a second `switching` at a place: an even orbit turns at both switches at once."""
    kept: list[tuple[str, Point]] = []
    for kind, point in events:
        again = kind == "switching" and any(
            kind == other and abs(point.place[-1] - known.place[-1]) < _SAME_SWITCHING
            for other, known in kept
        )
        kept += [] if again else [(kind, point)]
    return kept


def _confirmed(test: Test, left: Point, point: Point, right: Point, beside: Beside) -> bool:
    """Return whether the root of a test function is a special point and not a jump."""
    kind, value = test.kind, test.function
    scale = max(1.0, abs(value(left)), abs(value(right)))
    if not abs(value(point)) < _LARGEST_VALUE * scale:
        return False
    if kind == "fold":
        return _slope_outside(left, -_ASIDE, beside) * _slope_outside(right, _ASIDE, beside) < 0.0
    if kind == "torus":
        sides = left.orbit, right.orbit
        return _has_pair_on_the_unit_circle(point.orbit) and all(map(_is_off_the_circle, sides))
    if kind == "switching":
        return _turns_at_a_switch(point.motion)
    if kind == "branch_point":
        return left.slope * right.slope > 0.0
    return True


def _slope_outside(end: Point, away: float, beside: Beside) -> float:
    """Return the slope of the parameter at an end of a piece, or 0 if it is only rounding.

    An end may be the fold itself, where the slope is 0. It is then not so a little farther away.
    """
    slopes = end.slope, beside(end, away).slope if abs(end.slope) <= _LEAST_SLOPE else 0.0
    return next((slope for slope in slopes if abs(slope) > _LEAST_SLOPE), 0.0)


def _turns_at_a_switch(motion: Motion) -> bool:
    """Return whether turning points appear or vanish where the velocity at a switch is 0.

    They do if y'' has different signs before and after the switch. Where nothing is damped, y'' may
    be 0 on one side. If the signs are equal, a turning point only passes the switch.
    """
    still = [s for s in motion.stiffness_jumps if abs(s[VELOCITY]) < _LARGEST_VALUE]
    return any(s[BEFORE] * s[AFTER] < _LARGEST_VALUE for s in still)


def _has_pair_on_the_unit_circle(orbit: Shot) -> bool:
    """Return whether the multipliers with the product 1 are a complex pair, not two real ones."""
    return bool(abs(_nearest_to_the_circle(orbit)[1].imag) > 1e-6)


def _is_off_the_circle(orbit: Shot) -> bool:
    """Return whether every product of two multipliers differs from 1 by more than their error."""
    return _nearest_to_the_circle(orbit)[0] > orbit.multiplier_error


def _nearest_to_the_circle(orbit: Shot) -> tuple[float, complex]:
    """Return the least |mu_i mu_k - 1| of all pairs of multipliers, and mu_i of that pair."""
    products = [(float(abs(a * b - 1.0)), a) for a, b in combinations(orbit.multipliers, 2)]
    return min(products, key=operator.itemgetter(0))
