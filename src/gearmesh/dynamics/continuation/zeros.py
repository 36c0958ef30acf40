"""Zeros of test functions between neighbouring points of a branch.

Where a test function changes sign between two points, its root is located on the branch itself.
Where it has the same sign at both points, its tangents there show whether it may pass 0 twice in
between. If so, the piece of the branch is halved, and each half is searched.
"""

import contextlib
from collections.abc import Callable, Iterator
from math import isnan
from typing import NamedTuple

import numpy as np

from gearmesh.dynamics.continuation.curves import Curve
from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.test_functions import Function, Test
from gearmesh.errors import NoOrbit

Beside = Callable[[Point, float], Point]
"""`Curve.beside` of a curve, which remembers the points."""

STEEP = 0.02
"""Least slope of a parameter at both ends of a piece between which it does not turn."""

_OFFSET = 1e-5
_NARROWEST = 1e-6  # piece of a branch; roots of one test closer than this are not separated
_ROOT_WIDTH = 1e-13  # distance along a branch
_RESOLUTION = 1e-6  # share of a piece; in less of it, rounding errors may hide a change
_MOVED = 1e-5  # share of a piece by which a point may miss a value of the parameter
_KNOWN = 6  # values from which a root is predicted
_MOST_PREDICTIONS = 6  # after these every second point halves the interval
_MOST_CORRECTIONS = 50  # of the root of a polynomial
_NEAREST = 1e-10  # distance from an abrupt root that stands for it
_SHARE = 0.99  # of the distance to such a root that a step passes


def zeros(
    curve: Curve,
    left: Point,
    right: Point,
    test: Test,
    beside: Beside,
) -> Iterator[tuple[Point, Point, Point]]:
    """Yield the points between two others where a function changes sign, and their neighbours.

    Parameters
    ----------
    curve : Curve
    left, right : Point
    test : Test
    beside : callable
        As `Beside`.
    """
    # Where the gap moves, what follows a grazing of the back flanks may not be found.
    abrupt = test.kind == "grazing_back" and curve.gap_moves
    offset = min(_OFFSET, 0.1 * length_between(left, right))
    pieces = [(left, right)]
    while pieces:
        start, end = pieces.pop()
        values = test.function(start), test.function(end)
        if any(map(isnan, values)):
            continue
        if (values[0] < 0.0) != (values[1] < 0.0):
            found = (
                _approach(curve, start, end, test.function)
                if abrupt
                else _locate(curve, start, end, test)
            )
            yield start, found, end
        elif _may_dip(test.function, (start, values[0]), (end, values[1]), beside, offset):
            middle = _inside(curve, start, end, start.tangent, 0.5)
            pieces += [(start, middle), (middle, end)]


def passages(
    curve: Curve, left: Point, right: Point, value: float, beside: Beside, i: int = 0
) -> Iterator[Point]:
    """Yield the points between two others at a value of parameter `i`, which may turn there."""
    k = len(left.place) - len(curve.units) + i
    slopes = left.tangent[k], right.tangent[k]
    low, high = sorted((left.values[i], right.values[i]))
    if low < value < high and min(map(abs, slopes)) > STEEP and slopes[0] * slopes[1] > 0.0:
        with contextlib.suppress(NoOrbit):
            yield curve.crossing(left, right, value, i)
            return

    def away(point: Point) -> float:
        return point.values[i] - value

    least = _MOVED * max(abs(away(left)), abs(away(right)))
    for _, point, _ in zeros(curve, left, right, Test("passage", away), beside):
        if abs(away(point)) <= least:
            yield _moved(curve, point, value, k)


def _moved(curve: Curve, point: Point, value: float, k: int) -> Point:
    """Return a point of a curve, moved by a rounding error to a value of the parameter at `k`."""
    place, normal = point.place.copy(), np.eye(len(point.place))[k]
    place[k] = value / curve.units[k - len(place)]
    try:
        return curve.point(place, normal, point.tangent)
    except NoOrbit:  # at a fold itself
        return point


def length_between(left: Point, right: Point) -> float:
    """Return the length of a piece of a branch."""
    return float(left.tangent @ (right.place - left.place))


def _may_dip(
    test: Function,
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
    length, sign = length_between(start, end), -1.0 if before < 0.0 else 1.0
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


def _locate(curve: Curve, left: Point, right: Point, test: Test) -> Point:
    """Return the point between two others where a test function passes 0.

    A polynomial predicts the root from the values that are known nearby. The value at the predicted
    root improves the polynomial, and so on. If the curve cannot be followed up to the root, the
    known point nearest to it is returned.
    """
    normal, length = left.tangent, length_between(left, right)
    low = _Known(0.0, test.function(left), left)
    high = _Known(1.0, test.function(right), right)
    places, values = test.around
    shares = (places - left.place) @ normal / length if values.size else values
    others = list(zip(shares.tolist(), values.tolist(), strict=True))
    least, count = _RESOLUTION * max(abs(low.value), abs(high.value)), 0
    while (high.share - low.share) * length > _ROOT_WIDTH:
        others = sorted(others, key=lambda other: abs(other[1]))[: _KNOWN - 2]
        share = _root([low[:2], high[:2], *others])
        nearest = min((low, high), key=lambda known: abs(known.share - share))
        here = abs(nearest.share - share) * length < _ROOT_WIDTH
        if here and abs(nearest.value) <= least:
            return nearest.point
        if here or (count > _MOST_PREDICTIONS and count % 2):
            share = 0.5 * (low.share + high.share)
        part = (share - low.share) / (high.share - low.share)
        try:
            point = _inside(curve, low.point, high.point, normal, part)
        except NoOrbit:
            break
        share = float((point.place - left.place) @ normal) / length
        new = _Known(share, test.function(point), point)
        if not abs(new.value) > 0.0:
            return point
        near = abs(share - nearest.share) < _RESOLUTION
        if near and 0.5 * abs(nearest.value) < abs(new.value) <= least:
            return min(nearest, new, key=_size).point  # the change is a rounding error
        if (new.value < 0.0) == (low.value < 0.0):
            others, low = [*others, low[:2]], new
        else:
            others, high = [*others, high[:2]], new
        count += 1
    return min(low, high, key=_size).point


def _inside(curve: Curve, left: Point, right: Point, normal: np.ndarray, share: float) -> Point:
    """Return a point between two others: at a share of the way, as `Curve.between`, if possible.

    At a grazing the curve may have a kink, across which polynomials predict badly. The point is
    then reached by a step from the left one.
    """
    try:
        return curve.between(left, right, normal, share)
    except NoOrbit:
        return curve.towards(left, right)


class _Known(NamedTuple):
    """A point of a piece, how far along it is, and the value of a function there."""

    share: float
    value: float
    point: Point


def _size(known: _Known) -> float:
    return abs(known.value)


def _root(known: list[tuple[float, float]]) -> float:
    """Return the root between the first two places of the polynomial through all of them."""
    shares = [share for share, _ in known]
    factors = [value for _, value in known]
    for order in range(1, len(known)):
        for i in range(len(known) - 1, order - 1, -1):
            factors[i] = (factors[i] - factors[i - 1]) / (shares[i] - shares[i - order])
    low, high = shares[:2]
    falls = known[0][1] > known[1][1]
    share = low - known[0][1] / factors[1]
    for _ in range(_MOST_CORRECTIONS):
        value, slope = factors[-1], 0.0
        for factor, other in zip(factors[-2::-1], shares[-2::-1], strict=True):
            value, slope = value * (share - other) + factor, slope * (share - other) + value
        if abs(value) <= _ROOT_WIDTH * abs(slope):
            break
        low, high = (share, high) if (value > 0.0) == falls else (low, share)
        share -= value / slope if slope != 0.0 else np.inf
        if not low < share < high:
            share = 0.5 * (low + high)
    return share


def _approach(curve: Curve, left: Point, right: Point, test: Function) -> Point:
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
