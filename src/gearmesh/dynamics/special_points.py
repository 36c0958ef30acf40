"""Special points of a branch, located as the zeros of test functions.

Every test function is known, with its slope, at neighbouring points of a branch. If its sign
changes between two of them, a root is located on the branch itself. If its tangents at both ends
allow two roots in between, the piece of the branch is halved until they do not.
"""

import operator
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from scipy.optimize import brentq

from gearmesh.dynamics.continuation import Curve, Point
from gearmesh.dynamics.shots import Shot
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.period_map import Passage, segments_of
from gearmesh.solvers.reduced.variational import (
    AFTER,
    BEFORE,
    CROSSING,
    HEIGHT,
    KIND,
    SEGMENT,
    SWITCH,
    TURN,
    VELOCITY,
)

KINDS = ("fold", "flip", "torus", "branch_point", "grazing_front", "grazing_back", "switching")
"""All kinds of special points."""

Test = tuple[str, Callable[[Point], float]]
"""A kind, and a function of the points of a branch that passes 0 at a special point."""

Extrema = Callable[[Shot], np.ndarray]
"""Extrema of an orbit, shape (n, 3): time, height, kind (1 or -1)."""

FRONT: Extrema = operator.attrgetter("extrema")
BACK: Extrema = operator.attrgetter("gap_extrema")
"""The extrema whose height is 0 where flanks graze, on the front and on the back."""

Inner = tuple[Point, Point, float]
"""Points just inside the two ends of a piece of a branch, and their distance from the ends."""

_MARGIN = 0.25
_OFFSET = 1e-5
_NARROWEST = 1e-6  # piece of a branch; roots of one test closer than this are not separated
_NARROWEST_PIECE = 1e-11  # between two grazings, in which multipliers are tested
_ROOT_WIDTH = 1e-13
_LARGEST_VALUE = 1e-7  # of a test function at its root: more is a jump
_LEAST_SLOPE = 1e-6  # of the parameter along a branch at both sides of a fold
_SAME_SWITCHING = 1e-9  # distance in the parameter
_SAME_PHASE = 0.2  # mesh periods between an extremum and the same one further on


@dataclass(frozen=True)
class SpecialPoint:
    """A point of a branch where something changes.

    Attributes
    ----------
    kind : str
        One of `KINDS`.
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
    curve: Curve, left: Point, right: Point, tests: list[Test], inner: Inner | None = None
) -> list[tuple[str, Point]]:
    """Return where tests pass 0 between two neighbouring points of a curve, in their order.

    `inner` is what `_inner_points` returns for them, if it is known.
    """
    found = _search(curve, left, right, tests, inner or _inner_points(curve, left, right))
    return sorted(found, key=lambda item: float(left.tangent @ item[1].place))


def suspects(points: list[Point]) -> list[int]:
    """Return every i for which a special point may lie between point i and the next one.

    A piece of the branch is suspect if a test function changes sign in it. It is also suspect if a
    test function may cross 0 twice in it, that is, if its value at an end is less than `_MARGIN`
    times its change nearby. All test functions are computed for all points at once, so only the
    suspect pieces need a closer look.
    """
    every = list(range(len(points) - 1))
    moved = [point.passage for point in points if point.passage and len(point.passage.events)]
    if len(moved) < len(points):
        return every
    heights, crossings = _event_functions(points[0].orbit.problem, moved)
    functions = np.column_stack([*_bifurcation_functions(points, moved), *heights])
    with np.errstate(invalid="ignore"):
        change = np.abs(np.diff(functions, axis=0))
        nearby = change.copy()
        nearby[1:] = np.fmax(nearby[1:], change[:-1])
        nearby[:-1] = np.fmax(nearby[:-1], change[1:])
        least = np.fmin(np.abs(functions[1:]), np.abs(functions[:-1]))
        near = (functions[1:] * functions[:-1] <= 0.0) | (least < _MARGIN * nearby)
    found = near.any(axis=1) | (np.diff(crossings) != 0)
    return [i for i in every if found[i]]


def _bifurcation_functions(points: list[Point], moved: list[Passage]) -> list[np.ndarray]:
    """Return the functions of `_bifurcation_tests`, each at all points."""
    jacobians = np.array([one.jacobian for one in moved])
    damped = np.array([one.damping != 0.0 for one in moved])
    return [
        np.array([point.slope for point in points]),
        np.array([point.determinant for point in points]),
        np.linalg.det(jacobians + np.eye(4)),
        np.where(damped, _pair_products(jacobians), np.nan),
    ]


def _pair_products(jacobians: np.ndarray) -> np.ndarray:
    """Return the products of all mu_i mu_k - 1, from the characteristic polynomials.

    The sums mu_1 mu_2 + mu_3 mu_4, ... are the roots of the resolvent cubic of the polynomial.
    """
    powers = [jacobians, *(np.linalg.matrix_power(jacobians, k) for k in (2, 3))]
    one, two, three = (np.trace(power, axis1=1, axis2=2) for power in powers)
    e_2 = (one**2 - two) / 2.0
    e_3 = (one**3 - 3.0 * one * two + 2.0 * three) / 6.0
    e_4 = np.linalg.det(jacobians)
    s = 1.0 + e_4
    cubic = s**3 - e_2 * s**2 + (one * e_3 - 4.0 * e_4) * s
    return cubic - (one**2 * e_4 + e_3**2 - 4.0 * e_2 * e_4)


def _event_functions(problem: Problem, moved: list[Passage]) -> tuple[list[np.ndarray], np.ndarray]:
    """Return functions that pass 0 where events appear or vanish, each at all points.

    The first functions are the least distances between extrema of y and the ends of regimes. The
    others are the velocities where C(t) jumps. Such a velocity counts only if y'' changes sign at
    the jump, at this point or a neighbouring one. The second result is the number of changes of
    regime.
    """
    stiffness = segments_of(problem)[:, 1]
    events = np.concatenate([one.events for one in moved])
    first = np.cumsum([0, *(len(one.events) for one in moved[:-1])])
    kind, height = events[:, KIND], events[:, HEIGHT]
    jumps = (kind == SWITCH) & (stiffness != np.roll(stiffness, 1))[events[:, SEGMENT].astype(int)]
    margins = [
        np.minimum.reduceat(np.where(kind == TURN, np.abs(height - level), np.inf), first)
        for level in (0.0, -problem.backlash)
    ]
    velocities = events[jumps, VELOCITY].reshape(len(moved), -1)
    turning = (events[jumps, BEFORE] * events[jumps, AFTER] < 0.0).reshape(velocities.shape)
    beside = turning.copy()
    beside[1:] |= turning[:-1]
    beside[:-1] |= turning[1:]
    velocities[~beside] = np.nan
    return [*margins, *velocities.T], np.add.reduceat(kind == CROSSING, first, dtype=int)


def special_points(curve: Curve, left: Point, right: Point) -> list[tuple[str, Point]]:
    """Return the special points between two neighbouring points of a branch, in their order.

    Multipliers have a root singularity where the orbit grazes, so they are tested in the pieces
    between the grazings and not across them.
    """
    inner = _inner_points(curve, left, right)
    events = _once(search(curve, left, right, _event_tests(left, right), inner))
    ends = [left, *(point for _, point in events), right]
    bifurcations = [
        found
        for start, end in pairwise(ends)
        if _length(start, end) > _NARROWEST_PIECE
        for found in search(curve, start, end, _bifurcation_tests(), None if events else inner)
    ]
    order = [*events, *bifurcations]
    return sorted(order, key=lambda item: float(left.tangent @ item[1].place))


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


def _inner_points(curve: Curve, left: Point, right: Point) -> Inner:
    """Return an offset, and the points that far inside the two ends: they give the slopes there."""
    offset = min(_OFFSET, 0.1 * _length(left, right))
    return curve.beside(left, offset), curve.beside(right, -offset), offset


def _search(
    curve: Curve, left: Point, right: Point, tests: list[Test], inner: Inner
) -> Iterator[tuple[str, Point]]:
    ahead, behind, offset = inner
    for kind, test in tests:
        pieces = [(left, ahead, behind, right, offset)]
        while pieces:
            start, near, far, end, offset = pieces.pop()
            before, after = test(start), test(end)
            if np.isnan(before) or np.isnan(after):
                continue
            length = _length(start, end)
            if (before < 0.0) != (after < 0.0):
                try:
                    point = _locate(curve, start, end, test)
                except NoOrbit:
                    if kind == "grazing_back" and start.orbit.problem.terms.backlash_varies:
                        continue  # see `_event_tests`
                    raise
                if _confirmed(kind, test, start, point, end):
                    yield kind, point
            elif _may_dip(before, test(near), test(far), after, length, offset):
                middle = curve.step(start, 0.5 * length)
                below, above = curve.beside(middle, -offset), curve.beside(middle, offset)
                pieces += [
                    (start, near, below, middle, offset),
                    (middle, above, far, end, offset),
                ]


def _length(left: Point, right: Point) -> float:
    return float(left.tangent @ (right.place - left.place))


def _may_dip(
    before: float, ahead: float, behind: float, after: float, length: float, offset: float
) -> bool:
    """Return whether a function of one sign at both ends may pass 0 in between.

    Where it approaches 0 at both ends, the tangents there bound a convex function from below.
    """
    sign = -1.0 if before < 0.0 else 1.0
    down, up = sign * (ahead - before) / offset, sign * (after - behind) / offset
    if length < _NARROWEST or not (down < 0.0 < up):
        return False
    where = (sign * (after - before) - up * length) / (down - up)
    return bool(sign * before + down * where < 0.0)


def _locate(curve: Curve, left: Point, right: Point, test: Callable[[Point], float]) -> Point:
    """Return the point between two others where a test function passes 0."""

    def at(share: float) -> Point:
        if share in (0.0, 1.0):
            return right if share else left
        place = left.place + share * (right.place - left.place)
        return curve.point(place, left.tangent, left.tangent)

    return at(brentq(lambda share: test(at(share)), 0.0, 1.0, xtol=_ROOT_WIDTH))


def _confirmed(
    kind: str, test: Callable[[Point], float], left: Point, point: Point, right: Point
) -> bool:
    """Return whether the root of a test function is a special point and not a jump."""
    scale = max(1.0, abs(test(left)), abs(test(right)))
    if not abs(test(point)) < _LARGEST_VALUE * scale:
        return False
    if kind == "fold":
        return min(abs(left.slope), abs(right.slope)) > _LEAST_SLOPE
    if kind == "torus":
        return _has_pair_on_the_unit_circle(point.orbit)
    if kind == "switching":
        return _turns_at_a_switch(point.orbit)
    if kind == "branch_point":
        return left.slope * right.slope > 0.0
    return True


def _turns_at_a_switch(orbit: Shot) -> bool:
    """Return whether turning points appear or vanish where the velocity at a switch is 0.

    They do if y'' has different signs before and after the switch. Where nothing is damped, y'' may
    be 0 on one side. If the signs are equal, a turning point only passes the switch.
    """
    still = [s for s in orbit.stiffness_jumps if abs(s[VELOCITY]) < _LARGEST_VALUE]
    return any(s[BEFORE] * s[AFTER] < _LARGEST_VALUE for s in still)


def _has_pair_on_the_unit_circle(orbit: Shot) -> bool:
    """Return whether the multipliers with the product 1 are a complex pair, not two real ones."""
    products = [(abs(a * b - 1.0), a) for a, b in combinations(orbit.multipliers, 2)]
    return bool(abs(min(products, key=lambda item: item[0])[1].imag) > 1e-6)


def _bifurcation_tests() -> list[Test]:
    return [
        ("fold", lambda point: point.slope),
        ("branch_point", lambda point: point.determinant),
        ("flip", lambda point: flip_test(point.orbit)),
        ("torus", lambda point: torus_test(point.orbit)),
    ]


def flip_test(orbit: Shot) -> float:
    """Return the product of all mu_i + 1."""
    return float(np.linalg.det(orbit.monodromy + np.eye(len(orbit.monodromy))))


def _event_tests(left: Point, right: Point) -> list[Test]:
    """Return the tests for events that appear or vanish between two points of a branch.

    Flanks with a moving gap touch at a rate y' that is not 0. If the damping jumps there, the
    motion behind the grazing changes with the square root of the depth, and Newton's method may
    fail beside it. Such a grazing of the back flanks is left out.
    """
    tests: list[Test] = []
    for name, extrema in (("grazing_front", FRONT), ("grazing_back", BACK)):
        for time, _, kind in extrema(left.orbit):
            tests.append((name, _height(extrema, time / left.orbit.problem.period, kind)))
    turning = {
        number
        for point in (left, right)
        for number, switch in enumerate(point.orbit.stiffness_jumps)
        if switch[BEFORE] * switch[AFTER] < 0.0
    }
    tests += [("switching", _velocity_at(number)) for number in sorted(turning)]
    return tests


def torus_test(orbit: Shot) -> float:
    """Return the product of all mu_i mu_k - 1, which is 0 where a pair is on the unit circle.

    Without damping in the mesh a pair may be there all along the branch; the result is then
    not-a-number.
    """
    if orbit.undamped:
        return float("nan")
    return float(np.prod([a * b - 1.0 for a, b in combinations(orbit.multipliers, 2)]).real)


def _height(extrema: Extrema, phase: float, kind: float) -> Callable[[Point], float]:
    """Return the test of the extremum of a kind near a phase: its height."""

    def height(point: Point) -> float:
        orbit = point.orbit
        found = extrema(orbit)
        same = found[found[:, 2] == kind]
        away = same[:, 0] / orbit.problem.period - phase
        away = np.abs(away - orbit.periods * np.round(away / orbit.periods))
        if not away.size or away.min() > _SAME_PHASE:
            return float("nan")
        return float(same[np.argmin(away), 1])

    return height


def _velocity_at(number: int) -> Callable[[Point], float]:
    """Return the test of a switch of C(t): the velocity there."""

    def velocity(point: Point) -> float:
        switches = point.orbit.stiffness_jumps
        return float(switches[number, VELOCITY]) if number < len(switches) else float("nan")

    return velocity
