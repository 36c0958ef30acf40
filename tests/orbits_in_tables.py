"""Where an orbit lies relative to the branches of `branches.nc`."""

import numpy as np


def distance(table, orbit) -> float:
    """Return how far the extremes of an orbit are from lines through the points of branches."""
    own = table.isel(point=np.flatnonzero(table["periods"] == orbit.periods))
    nu, number = own["nu"].values, own["branch"].values
    ends = np.column_stack([own["y_max_rel"], own["y_min_rel"]])
    within = (nu[:-1] - orbit.problem.nu) * (nu[1:] - orbit.problem.nu) <= 0.0
    within &= (number[:-1] == number[1:]) & (nu[:-1] != nu[1:])
    i = np.flatnonzero(within)
    share = ((orbit.problem.nu - nu[i]) / (nu[i + 1] - nu[i]))[:, None]
    lines = ends[i] + share * (ends[i + 1] - ends[i])
    return np.abs(lines - [orbit.y_max, orbit.y_min]).max(axis=1).min(initial=np.inf)
