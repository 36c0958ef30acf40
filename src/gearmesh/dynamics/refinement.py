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


def _cut(low: float, high: float) -> np.ndarray:
    places = np.linspace(low, high, PARTS + 1)
    places[0], places[-1] = low, high
    return places


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
    while high - low > width:
        places = _cut(low, high)
        if not np.all(np.diff(places) > 0):
            break
        changed = holds(places[1:-1]) != at_low
        first = int(np.argmax(changed)) if changed.any() else PARTS - 1
        low, high = places[first], places[first + 1]
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
    while high - low > width:
        places = _cut(low, high)
        if not np.all(np.diff(places) > 0):
            break
        course = np.concatenate([[at_low], values(places[1:-1]), [at_high]])
        sizes = np.abs(np.diff(course))
        if np.all(np.isnan(sizes)):
            return float(low), float(high), float("nan")
        piece = int(np.nanargmax(sizes))
        low, high = places[piece], places[piece + 1]
        at_low, at_high = course[piece], course[piece + 1]
    return float(low), float(high), float(at_high - at_low)


def refine_peak(values: Batch, low: float, high: float, width: float) -> tuple[float, float]:
    """Locate the greatest value of a curve that has one peak in the interval.

    Returns
    -------
    tuple of float
        (point, value) of the greatest value found; the point is accurate to half of `width`.
    """
    while True:
        places = _cut(low, high)
        course = np.nan_to_num(values(places), nan=-np.inf)
        best = int(np.argmax(course))
        if high - low <= width or not np.all(np.diff(places) > 0):
            return float(places[best]), float(course[best])
        low, high = places[max(best - 1, 0)], places[min(best + 1, PARTS)]
