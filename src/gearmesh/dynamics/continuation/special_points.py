"""Special points of a branch, located as the zeros of test functions.

Every test function is known, with its slope, at neighbouring points of a branch. If its sign
changes between two of them, a root is located on the branch itself. If its tangents at both ends
allow two roots in between, the piece of the branch is halved until they do not.
"""

import operator
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import combinations, pairwise

import numpy as np

from gearmesh.dynamics.continuation.curves import Curve, Point
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.errors import NoOrbit
from gearmesh.solvers.reduced.derivatives.variational import AFTER, BEFORE, VELOCITY

Test = tuple[str, Callable[[Point], float]]
"""A kind, and a function of the points of a branch that passes 0 at a special point."""

Extrema = Callable[[Shot], np.ndarray]
"""Extrema of an orbit, shape (n, 3): time, height, kind (1 or -1)."""

FRONT: Extrema = operator.attrgetter("extrema")
BACK: Extrema = operator.attrgetter("gap_extrema")
"""The extrema whose height is 0 where flanks graze, on the front and on the back."""

Beside = Callable[[Point, float], Point]
"""`Curve.beside` of a curve, which remembers the points."""

_OFFSET = 1e-5
_NARROWEST = 1e-6  # piece of a branch; roots of one test closer than this are not separated
_NARROWEST_PIECE = 1e-11  # between two grazings, in which multipliers are tested
_ROOT_WIDTH = 1e-13
_NEAREST = 1e-10  # distance from an abrupt grazing that stands for it
_SHARE = 0.99  # of the distance to such a grazing that a step passes
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
    found = _search(curve, left, right, tests, beside or cache(curve.beside))
    return sorted(found, key=lambda item: float(left.tangent @ item[1].place))


def special_points(
    curve: Curve, left: Point, right: Point, kinds: set[str]
) -> list[tuple[str, Point]]:
    """Return the special points of some kinds between neighbouring points, in their order.

    Multipliers have a root singularity where the orbit grazes, so they are tested in the pieces
    between the grazings and not across them. Wherever an event is found, all of them are tested.
    """
    beside = cache(curve.beside)
    tests = [test for test in _event_tests(left, right) if test[0] in kinds]
    events = _once(search(curve, left, right, tests, beside))
    tests = [test for test in bifurcation_tests() if events or test[0] in kinds]
    ends = [left, *(point for _, point in events), right]
    bifurcations = [
        found
        for start, end in pairwise(ends)
        if _length(start, end) > _NARROWEST_PIECE
        for found in search(curve, start, end, tests, beside)
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


def _search(
    curve: Curve, left: Point, right: Point, tests: list[Test], beside: Beside
) -> Iterator[tuple[str, Point]]:
    offset = min(_OFFSET, 0.1 * _length(left, right))
    for kind, test in tests:
        pieces = [(left, right)]
        while pieces:
            start, end = pieces.pop()
            before, after = test(start), test(end)
            if np.isnan(before) or np.isnan(after):
                continue
            if (before < 0.0) != (after < 0.0):
                abrupt = kind == "grazing_back" and start.orbit.problem.terms.backlash_varies
                point = (_approach if abrupt else _locate)(curve, start, end, test)
                if _confirmed(kind, test, start, point, end):
                    yield kind, point
            elif _may_dip(test, (start, before), (end, after), beside, offset):
                middle = curve.between(start, end, start.tangent, 0.5)
                pieces += [(start, middle), (middle, end)]


def _length(left: Point, right: Point) -> float:
    return float(left.tangent @ (right.place - left.place))


def _may_dip(
    test: Callable[[Point], float],
    left: tuple[Point, float],
    right: tuple[Point, float],
    beside: Beside,
    offset: float,
) -> bool:
    """Return whether a function of one sign at both ends may pass 0 in between.

    Where it approaches 0 at both ends, the tangents there bound a convex function from below. The
    slopes are those between the ends, given with their values, and points beside them.
    """
    (start, before), (end, after) = left, right
    length, sign = _length(start, end), -1.0 if before < 0.0 else 1.0
    if length < _NARROWEST:
        return False
    down = sign * (test(beside(start, offset)) - before) / offset
    if not down < 0.0:
        return False
    up = sign * (after - test(beside(end, -offset))) / offset
    if not up > 0.0:
        return False
    where = (sign * (after - before) - up * length) / (down - up)
    return bool(sign * before + down * where < 0.0)


def _locate(curve: Curve, left: Point, right: Point, test: Callable[[Point], float]) -> Point:
    """Return the point between two others where a test function passes 0.

    Each point is predicted from the two nearest ones that are known.
    """
    from scipy.optimize import brentq  # here, because it takes long to import

    known = {0.0: left, 1.0: right}

    def at(share: float) -> Point:
        if share not in known:
            low = max(other for other in known if other < share)
            high = min(other for other in known if other > share)
            part = (share - low) / (high - low)
            known[share] = curve.between(known[low], known[high], left.tangent, part)
        return known[share]

    return at(brentq(lambda share: test(at(share)), 0.0, 1.0, xtol=_ROOT_WIDTH))


def _approach(curve: Curve, left: Point, right: Point, test: Callable[[Point], float]) -> Point:
    """Return the point between two others where a height falls to 0.

    It is approached from the side where the height is positive.

    Flanks with a moving gap touch at a rate y' that is not 0. If the damping jumps there, the
    motion behind the grazing changes with the square root of the depth, and Newton's method may
    fail. Before the grazing the height is smooth, and three points tell where it passes 0.
    """
    normal, forth = left.tangent, test(left) > 0.0
    free, length = (left, _OFFSET) if forth else (right, -_OFFSET)
    heights, distances = [test(free)], [0.0]
    while abs(length) > _NEAREST:
        place = free.place + length / float(free.tangent @ normal) * free.tangent
        try:
            point = curve.point(place, normal, normal)
            height = test(point)
        except NoOrbit:
            height = 0.0
        if not height > 0.0:
            length *= 0.5
            continue
        free = point
        heights, distances = [*heights[-2:], height], [*distances[-2:], distances[-1] + length]
        # A parabola gives the distance as a function of the height.
        parabola = np.linalg.solve(np.vander(np.array(heights) / height), distances)
        length = _SHARE * float(parabola[-1] - distances[-1])
    return free


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
        sides = left.orbit, right.orbit
        return _has_pair_on_the_unit_circle(point.orbit) and all(map(_is_off_the_circle, sides))
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
    return bool(abs(_nearest_to_the_circle(orbit)[1].imag) > 1e-6)


def _is_off_the_circle(orbit: Shot) -> bool:
    """Return whether every product of two multipliers differs from 1 by more than their error."""
    return _nearest_to_the_circle(orbit)[0] > orbit.multiplier_error


def _nearest_to_the_circle(orbit: Shot) -> tuple[float, complex]:
    """Return the least |mu_i mu_k - 1| of all pairs of multipliers, and mu_i of that pair."""
    products = [(float(abs(a * b - 1.0)), a) for a, b in combinations(orbit.multipliers, 2)]
    return min(products, key=operator.itemgetter(0))


def bifurcation_tests() -> list[Test]:
    """Return the tests of all bifurcations, in the order of `BIFURCATIONS`."""
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
    """Return the tests for events that appear or vanish between two points of a branch."""
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
    return float("nan") if orbit.undamped else float(product_of_pairs(orbit.monodromy))


def product_of_pairs(matrices: np.ndarray) -> np.ndarray:
    """Return, for each matrix, the product of mu_i mu_k - 1 over all pairs of eigenvalues mu.

    The products mu_i mu_k are the eigenvalues of the second compound matrix, of the minors of
    order two.
    """
    i, k = np.triu_indices(matrices.shape[-1], 1)
    rows, others = i[:, None], k[:, None]
    compound = (
        matrices[..., rows, i] * matrices[..., others, k]
        - matrices[..., rows, k] * matrices[..., others, i]
    )
    return np.linalg.det(compound - np.eye(i.size))


def _height(extrema: Extrema, phase: float, kind: float) -> Callable[[Point], float]:
    """Return the test of the extremum of a kind near a phase: its height."""

    def height(point: Point) -> float:
        orbit, best = point.orbit, _SAME_PHASE
        found = float("nan")
        for time, y, kind_there in extrema(orbit).tolist():
            away = time / orbit.problem.period - phase
            away = abs(away - orbit.periods * round(away / orbit.periods))
            if kind_there == kind and away <= best:
                found, best = y, away
        return found

    return height


def _velocity_at(number: int) -> Callable[[Point], float]:
    """Return the test of a switch of C(t): the velocity there."""

    def velocity(point: Point) -> float:
        switches = point.orbit.stiffness_jumps
        return float(switches[number, VELOCITY]) if number < len(switches) else float("nan")

    return velocity
