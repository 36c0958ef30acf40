"""Search along one axis by batches: where something changes, jumps or peaks.

Every function takes a callable that evaluates a whole batch of points at once, because a batch of
runs costs little more than one run. Each refinement therefore cuts the interval into `PARTS`
pieces, not into two.
"""

from collections.abc import Callable

import numpy as np

PARTS = 9
"""Pieces of an interval: eight new points inside, one for each lane of the solver."""

Batch = Callable[[np.ndarray], np.ndarray]
"""Function from points, shape (n,), to values, shape (n,)."""


def _ends(low: float, high: float) -> np.ndarray:
    points = np.linspace(low, high, PARTS + 1)
    points[0], points[-1] = low, high
    return points


def _cut(low: float, high: float, width: float) -> np.ndarray | None:
    """Return the ends of the pieces; None at `width`, or where floating point cannot tell them."""
    points = _ends(low, high)
    return points if high - low > width and np.all(np.diff(points) > 0) else None


def refine_change(holds: Batch, low: float, high: float, width: float) -> tuple[float, float]:
    """Narrow an interval over which a condition changes.

    Parameters
    ----------
    holds : callable
        Function from points to booleans; the value at `low` differs from that at `high`.
    low, high : float
        Ends of the interval.
    width : float
        Width to come down to, > 0.

    Returns
    -------
    tuple of float
        (low, high), no wider than `width` unless floating point ends first; the condition
        differs between the two. If there are several changes, the one nearest to `low` is followed
        at each refinement.

    Raises
    ------
    ValueError
        If the condition is the same at both ends.
    """
    at_low, at_high = holds(np.array([low, high]))
    if bool(at_low) == bool(at_high):
        raise ValueError(f"nothing changes between {low} and {high}")
    while (points := _cut(low, high, width)) is not None:
        changed = holds(points[1:-1]) != at_low
        first = int(np.argmax(changed)) if changed.any() else PARTS - 1
        low, high = points[first], points[first + 1]
    return float(low), float(high)


def refine_step(values: Batch, low: float, high: float, width: float) -> tuple[float, float, float]:
    """Follow the steepest piece of a curve down to a width.

    Parameters
    ----------
    values : callable
        Function from points to values.
    low, high : float
        Ends of the interval.
    width : float
        Width to come down to, > 0.

    Returns
    -------
    tuple of float
        (low, high, step): the piece, and how much the value changes over it. At a jump the step
        stays the same while the piece shrinks; on a slope, however steep, the step shrinks too.
    """
    at_low, at_high = values(np.array([low, high]))
    while (points := _cut(low, high, width)) is not None:
        curve = np.concatenate([[at_low], values(points[1:-1]), [at_high]])
        sizes = np.abs(np.diff(curve))
        piece = int(np.argmax(sizes))
        low, high = points[piece], points[piece + 1]
        at_low, at_high = curve[piece], curve[piece + 1]
    return float(low), float(high), float(at_high - at_low)


def refine_peak(values: Batch, low: float, high: float, width: float) -> tuple[float, float]:
    """Locate the greatest value of a curve that has one peak in the interval.

    Returns
    -------
    tuple of float
        (point, value) of the greatest value found; the point is accurate to half of `width`.
    """
    while True:
        points = _ends(low, high)
        curve = values(points)
        best = int(np.argmax(curve))
        if _cut(low, high, width) is None:
            return float(points[best]), float(curve[best])
        low, high = points[max(best - 1, 0)], points[min(best + 1, PARTS)]
