"""Extrema of y and jumps of C(t) among the events of a passage.

A passage has few events, so lists are faster here than operations on arrays.
"""

import numpy as np

from gearmesh.solvers.reduced.derivatives.variational import (
    AFTER,
    HEIGHT,
    KIND,
    SEGMENT,
    SWITCH,
    TIME,
    TURN,
)


def extrema_of(events: np.ndarray) -> np.ndarray:
    """Return the extrema among the events of a passage, as of `Orbit.extrema`."""
    found = [
        (event[TIME], event[HEIGHT], (event[AFTER] < 0.0) - (event[AFTER] > 0.0))
        for event in events.tolist()
        if event[KIND] == TURN
    ]
    return np.array(found, float).reshape(-1, 3)


def jumps_of(events: np.ndarray, jumping: np.ndarray) -> np.ndarray:
    """Return the events at which C(t) jumps, given `jumping_segments`."""
    found = [
        event for event in events.tolist() if event[KIND] == SWITCH and jumping[int(event[SEGMENT])]
    ]
    return np.array(found, float).reshape(-1, events.shape[1])


def jumping_segments(segments: np.ndarray) -> np.ndarray:
    """Return, for each segment of a mesh period, whether C(t) jumps where it begins.

    Parameters
    ----------
    segments : ndarray, shape (m, 3)
        As of `gearmesh.solvers.reduced.derivatives.period_map.segments_of`.
    """
    stiffness = segments[:, 1]
    return stiffness != np.roll(stiffness, 1)
