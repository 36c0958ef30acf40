"""Special points of a branch, located as the zeros of test functions."""

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations

from gearmesh.dynamics.continuation.curves import Curve
from gearmesh.dynamics.continuation.kinds import BIFURCATIONS, GRAZINGS
from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.test_functions import (
    Function,
    Test,
    bifurcation_tests,
    bifurcation_values,
    event_tests,
)
from gearmesh.dynamics.continuation.zeros import (
    Beside,
    keeps_its_sign,
    length_between,
    zeros,
)
from gearmesh.dynamics.periodic.shots import Motion, Shot
from gearmesh.solvers.reduced.derivatives.variational import AFTER, BEFORE, VELOCITY

_AROUND = 2  # points on each side of a piece that help to locate roots in it
_NARROWEST_PIECE = 1e-11  # between two grazings, in which multipliers are tested
_LARGEST_VALUE = 1e-7  # of a test function at its root: more is a jump
_LEAST_SLOPE = 1e-6  # of the parameter along a branch at both sides of a fold
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
    curve: Curve,
    left: Point,
    right: Point,
    tests: list[Test],
    beside: Beside | None = None,
    around: Sequence[Point] = (),
) -> list[tuple[str, Point]]:
    """Return where tests pass 0 between two neighbouring points of a curve, in their order."""
    if not tests:
        return []
    beside = beside or cache(curve.beside)
    found = [
        (kind, point)
        for kind, test in tests
        for start, point, end in zeros(
            curve, left, right, test, beside, around, kind == "grazing_back" and curve.gap_moves
        )
        if _confirmed(kind, test, start, point, end)
    ]
    return _in_order(left, found)


def special_points(
    curve: Curve, points: Sequence[Point], i: int, kinds: set[str]
) -> list[tuple[str, Point]]:
    """Return the special points of some kinds between points i and i + 1, in their order.

    Multipliers have a root singularity where the orbit grazes, so they are tested in the pieces
    between the grazings and not across them. Wherever an orbit grazes, all of them are tested.
    """
    left, right, beside = points[i], points[i + 1], cache(curve.beside)
    before, after = (
        [points[k] for k in range(max(first, 0), min(first + _AROUND, len(points)))]
        for first in (i - _AROUND, i + 2)
    )
    around = [*before, *after]
    nearby = [*before[-1:], left, right, *after[:1]]
    tests = [
        (kind, test)
        for kind, test in event_tests(left, right, kinds)
        if not keeps_its_sign([test(point) for point in nearby])
    ]
    events = _once(search(curve, left, right, tests, beside, around))
    grazings = [point for kind, point in events if kind in GRAZINGS]
    if not grazings:
        found = search(curve, left, right, bifurcation_tests(kinds), beside, around)
        return _in_order(left, events + found)
    before, after = before[-1:], after[:1]
    ends = [*before, left, *grazings, right, *after]
    found, values = events, bifurcation_values(ends)
    for k in range(len(before), len(ends) - 1 - len(after)):
        start, end = ends[k : k + 2]
        if length_between(start, end) > _NARROWEST_PIECE:
            fours = values[:, max(k - 1, 0) : k + 3].tolist()
            sought = [
                kind
                for kind, four in zip(BIFURCATIONS, fours, strict=True)
                if not keeps_its_sign(four, smooth=False)
            ]
            found = found + search(curve, start, end, bifurcation_tests(sought), beside)
    return _in_order(left, found)


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


def _confirmed(kind: str, test: Function, left: Point, point: Point, right: Point) -> bool:
    """Return whether the root of a test function is a special point and not a jump."""
    scale = max(1.0, abs(test(left)), abs(test(right)))
    if not abs(test(point)) < _LARGEST_VALUE * scale:
        return False
    if kind == "fold":
        return min(abs(left.slope), abs(right.slope)) > _LEAST_SLOPE
    if kind == "torus":
        sides = left.orbit, right.orbit
        return _has_pair_on_the_unit_circle(point.orbit) and all(map(_is_off_the_circle, sides))
    if kind == "switching":
        return _turns_at_a_switch(point.motion)
    if kind == "branch_point":
        return left.slope * right.slope > 0.0
    return True


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
