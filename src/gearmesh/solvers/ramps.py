"""What a run shows whose speed changes: the speed, and the response in each mesh period."""

import numpy as np

from gearmesh.model.problem import Problem
from gearmesh.model.speeds import frequency_after, time_of
from gearmesh.solvers.response import Response


def by_speed(problem: Problem, response: Response) -> dict[str, np.ndarray]:
    """Return the mesh frequency over a run with samples, and the extremes of y at each.

    Returns
    -------
    dict of ndarray
        ``nu`` at the samples, ``strobe_nu`` at the boundaries of all mesh periods, ``period_nu`` in
        the middle of each kept mesh period, ``period_y_max`` and ``period_y_min`` over each, in
        y_st.
    """
    assert response.samples is not None
    boundaries = np.arange(problem.periods + 1)
    kept = boundaries[-problem.kept_periods - 1 :]
    samples = response.samples.time.size
    sampled = kept[0] + np.arange(samples) * (problem.kept_periods / samples)
    # y is monotone between extrema and boundaries.
    ends = np.stack([response.strobe_y[kept[:-1]], response.strobe_y[kept[1:]]])
    greatest, least = ends.max(axis=0), ends.min(axis=0)
    begins = time_of(problem, boundaries, before=np.zeros(1))[kept[:-1]]
    places = np.searchsorted(begins[1:], response.extremum_time, side="right")
    np.maximum.at(greatest, places, response.extremum_y)
    np.minimum.at(least, places, response.extremum_y)
    return {
        "nu": frequency_after(problem, sampled),
        "strobe_nu": frequency_after(problem, boundaries),
        "period_nu": frequency_after(problem, kept[:-1] + 0.5),
        "period_y_max": greatest,
        "period_y_min": least,
    }
