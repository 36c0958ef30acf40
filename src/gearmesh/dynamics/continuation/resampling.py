"""Points of a branch at given values of its parameter."""

from collections.abc import Sequence
from functools import cache

import numpy as np

from gearmesh.dynamics.continuation.curves import ASTRAY, Curve
from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.tracing import chained, first_values, geometry
from gearmesh.dynamics.continuation.walks import Piece
from gearmesh.dynamics.continuation.zeros import STEEP, length_between, passages

_SIDE = 3  # points on each side of an orbit from which it is predicted


def resampled(pieces: list[Piece], values: np.ndarray, closed: bool) -> list[Piece]:
    """Return a branch with points at given values of its parameter instead of its own.

    Parameters
    ----------
    pieces : list of Piece
    values : ndarray, shape (n,)
        In rising order, each once.
    closed : bool
        Whether the last point is the first one again.

    Returns
    -------
    list of Piece
        A point for each passage of the branch through one of the values, in the order of the
        branch. The list is empty if there is none.

    Raises
    ------
    NoOrbit
        If Newton's method does not converge.
    """
    parts = [(piece.curve, _passages(piece, values)) for piece in pieces]
    end = pieces[-1].points[-1:]
    if not closed and end[0].values[0] in values:
        parts.append((pieces[-1].curve, end))
    found: list[Piece] = []
    for curve, points in parts:
        if points:
            before = found[-1].points[-1:] if found else []
            found.append(Piece(curve, chained(before, points)))
    return found


def _passages(piece: Piece, values: np.ndarray) -> Sequence[Point]:
    """Return the points of a piece at the values, without its last point."""
    curve, points = piece.curve, piece.points
    places, tangents = geometry(points)
    steep = np.abs(tangents[:, -1]) > STEEP
    steady = steep[1:] & steep[:-1] & (tangents[1:, -1] * tangents[:-1, -1] > 0.0)
    intervals, wanted = _passed(values, first_values(points), steady)
    landed, strayed = _landed(curve, places, tangents, steady, intervals, wanted)
    steady[strayed] = False
    found, first = landed[:0], 0
    for i in np.flatnonzero(~steady).tolist():
        begin, end = np.searchsorted(intervals, [i, i + 1]).tolist()
        found = chained(found, landed[first:begin])
        found = chained(found, _searched(curve, points[i], points[i + 1], values))
        first = end
    return chained(found, landed[first:])


def _landed(
    curve: Curve,
    places: np.ndarray,
    tangents: np.ndarray,
    steady: np.ndarray,
    intervals: np.ndarray,
    wanted: np.ndarray,
) -> tuple[Sequence[Point], np.ndarray]:
    """Return the points at values of the parameter, and the intervals where they are doubtful.

    An orbit that is far from where it is predicted may belong to another branch.
    """
    up = np.eye(places.shape[1])[-1]
    predicted = _predicted(places, tangents, steady, intervals, wanted / curve.units[0])
    landed = curve.landed(predicted, up, np.sign(tangents[intervals, -1:]) * up)
    if not landed:
        return landed, intervals
    moved = np.linalg.norm(geometry(landed)[0] - predicted, axis=1)
    lengths = np.linalg.norm(np.diff(places, axis=0), axis=1)
    return landed, np.unique(intervals[~(moved <= ASTRAY * lengths[intervals])])


def _passed(
    values: np.ndarray, along: np.ndarray, steady: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the values that steady intervals pass, and the interval of each, in their order.

    Parameters
    ----------
    values : ndarray, shape (m,)
        In rising order.
    along : ndarray, shape (n,)
        The parameter at the ends of the intervals. The last end of an interval is not in it.
    steady : ndarray of bool, shape (n - 1,)

    Returns
    -------
    intervals, wanted : ndarray, shape (k,)
    """
    left, right = (np.searchsorted(values, along, side) for side in ("left", "right"))
    rises = along[1:] > along[:-1]
    begins, ends = np.where(rises, left[:-1], right[1:]), np.where(rises, left[1:], right[:-1])
    counts = np.where(steady, ends - begins, 0)
    intervals = np.repeat(np.arange(len(counts)), counts)
    since = np.arange(len(intervals)) - (np.cumsum(counts) - counts)[intervals]
    places = np.where(rises[intervals], begins[intervals] + since, ends[intervals] - 1 - since)
    return intervals, values[places]


def _predicted(
    places: np.ndarray,
    tangents: np.ndarray,
    steady: np.ndarray,
    intervals: np.ndarray,
    wanted: np.ndarray,
) -> np.ndarray:
    """Return places at values of the parameter, on polynomials through known points and tangents.

    Parameters
    ----------
    places, tangents : ndarray, shape (n, k + 1)
        Of the known points.
    steady : ndarray of bool, shape (n - 1,)
        Whether the parameter is a coordinate of the curve between two points.
    intervals : ndarray of int, shape (m,)
        Where the wanted places are.
    wanted : ndarray, shape (m,)
        The parameter there, in units of the curve.

    Returns
    -------
    ndarray, shape (m, k + 1)
    """
    rates = tangents / tangents[:, -1:]
    found = np.empty((len(wanted), places.shape[1]))
    surrounded = steady.copy()
    for k in range(1, _SIDE):
        surrounded[k:] &= steady[:-k]
        surrounded[:-k] &= steady[k:]
        surrounded[:k] = surrounded[-k:] = False
    many = surrounded[intervals]
    for side, which in ((1, ~many), (_SIDE, many)):
        used, each = np.unique(intervals[which], return_inverse=True)
        nodes = used + np.arange(1 - side, side + 1)[:, None]
        found[which] = _interpolated(places[nodes], rates[nodes], each, wanted[which])
    return found


def _interpolated(
    places: np.ndarray, rates: np.ndarray, each: np.ndarray, at: np.ndarray
) -> np.ndarray:
    """Return values of polynomials through places, with their rates.

    Parameters
    ----------
    places, rates : ndarray, shape (n, p, k)
        n places for each polynomial, and their derivatives with respect to the last coordinate.
    each : ndarray of int, shape (m,)
        The polynomial of each value.
    at : ndarray, shape (m,)
        The last coordinate there.

    Returns
    -------
    ndarray, shape (m, k)
    """
    nodes = np.repeat(places[..., -1], 2, axis=0)
    factors = np.repeat(places, 2, axis=0)
    changes = np.diff(places, axis=0) / np.diff(places[..., -1:], axis=0)
    factors[2::2], factors[1::2] = changes, rates
    for order in range(2, len(nodes)):
        apart = nodes[order:] - nodes[:-order]
        factors[order:] = np.diff(factors[order - 1 :], axis=0) / apart[..., None]
    # Of NumPy's ways to pick rows, `take` is the fastest by far.
    found = factors[-1].take(each, axis=0)
    for i in range(len(nodes) - 2, -1, -1):
        found *= (at - nodes[i].take(each))[:, None]
        found += factors[i].take(each, axis=0)
    found[:, -1] = at
    return found


def _searched(curve: Curve, left: Point, right: Point, values: np.ndarray) -> list[Point]:
    """Return the points at the values between two others, where the parameter may turn."""
    reach = length_between(left, right) * curve.units[0]
    ends, beside = (left.values[0], right.values[0]), cache(curve.beside)
    found = [left] if left.values[0] in values else []
    for value in values[(values > min(ends) - reach) & (values < max(ends) + reach)].tolist():
        if value not in ends:
            found += passages(curve, left, right, value, beside)
    return sorted(found, key=lambda point: float(left.tangent @ point.place))
