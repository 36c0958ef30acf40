"""Many points of curves over the mesh frequency, corrected side by side in the lanes."""

from collections.abc import Callable

import numpy as np
from numba import njit

from gearmesh.model.contact import regime_of
from gearmesh.model.problem import Problem
from gearmesh.solvers.compilation import inner, persistent
from gearmesh.solvers.lanes.operations import zeros8
from gearmesh.solvers.lanes.rows import pointer_to, unowned
from gearmesh.solvers.reduced.derivatives import curves
from gearmesh.solvers.reduced.derivatives.bundles import ALL_ROWS, bundle
from gearmesh.solvers.reduced.derivatives.deviations import DEVIATIONS, SIZE
from gearmesh.solvers.reduced.derivatives.variational import COMPLETE, DIVERGED, TOO_MANY_STEPS
from gearmesh.solvers.reduced.records import RUN, SUMMARY
from gearmesh.solvers.reduced.runs import run_row, workspace
from gearmesh.solvers.response import EXTREMUM, OK, STEP_LIMIT

TOLERANCE = 1e-15
"""Local error tolerance, relative to y_st and y_st Omega_s: rounding decides the accuracy."""

_CONTRACTION = 0.9  # largest share of the residual that a correction may leave
_CHUNK = 1024  # points in one call of the compiled code, which bounds the memory that it takes
_NO_EXTREMA = np.empty((0, 0), EXTREMUM)

_regime_of = inner(regime_of)


@inner
def _begin(law, stretched, point, run):
    """Write the run from the place of a point, whose mesh period is `stretched` times as long."""
    run.period = law.period * stretched
    for i in range(int(law.segments)):
        run.length[i] = law.length[i] * stretched
    for i in range(SIZE):
        run.start[i] = point[i]
    run.regime = _regime_of(point[0], law.backlash)


@inner
def _end(summary, jacobian, damping, point):
    """Write what a run gives to the point at which it begins."""
    status = summary.status
    point[curves.OUTCOME] = COMPLETE
    if status != OK:
        point[curves.OUTCOME] = TOO_MANY_STEPS if status == STEP_LIMIT else DIVERGED
    for i in range(SIZE):
        point[curves.END + i] = summary.final[i]
    for i in range(SIZE * DEVIATIONS):
        point[curves.JACOBIAN + i] = jacobian[i]
    point[curves.N_EVENTS], point[curves.DAMPING] = 0, damping
    point[curves.LEAST_FORCE] = np.nan
    point[curves.Y_MAX], point[curves.Y_MIN] = summary.y_max, summary.y_min


@inner
def _correct(point, normal, origin, matrix, trial):
    """Write the place to which Newton's method leads; return whether there is one."""
    ahead = 0.0
    for j in range(curves.DIMENSIONS):
        ahead += normal[j] * (point[j] - origin[j])
    curves.border(point, normal, ahead, matrix)
    if not abs(curves.solve(matrix)) > 0.0:
        return False
    for j in range(curves.DIMENSIONS):
        trial[j] = point[j] - matrix[j, curves.DIMENSIONS]
    return trial[SIZE] > 0.0


@inner
def _land(like, work, runs, stated, corrections, normal, points, summaries, strobes, extrema):
    """Correct all points; see `land`."""
    law, unit, nu = stated
    points, runs, law = unowned(points), unowned(runs), unowned(law)
    summaries, strobes, extrema = unowned(summaries), unowned(strobes), unowned(extrema)
    n = len(points)
    trials, origins = points.copy(), points[:, : curves.DIMENSIONS].copy()
    residuals, chosen = np.full(n, np.inf), np.arange(n)
    jacobians, dampings = np.empty((n, SIZE * DEVIATIONS)), np.empty(n)
    matrix = np.empty((curves.DIMENSIONS, curves.DIMENSIONS + 2))
    count = n
    while count > 0:
        for k in range(count):
            trial, summary = trials[chosen[k]], summaries[k]
            summary.y_max, summary.y_min = -np.inf, np.inf
            _begin(law[0], nu / (trial[SIZE] * unit), trial, runs[k])
        bundle(like, work, runs, count, summaries, strobes, extrema, jacobians, dampings)
        left = 0
        for k in range(count):
            row = chosen[k]
            point, trial = points[row], trials[row]
            _end(summaries[k], jacobians[k], dampings[k], trial)
            residual = curves.residual_of(trial)
            first = residuals[row] == np.inf
            if not (first or residual < _CONTRACTION * residuals[row]):
                continue
            residuals[row] = residual
            curves.copy(trial, point)
            if corrections == 0 or residual < curves.ROUNDED or residual == np.inf:
                continue
            if _correct(point, normal, origins[row], matrix, trial):
                chosen[left] = row
                left += 1
        count = left
        corrections -= 1
    for point in points:
        curves.write_tangent(point, normal, matrix)


def _build_land(key: str, cache: bool) -> Callable[..., None]:
    @njit(cache=cache, nogil=True)
    def compiled(work, *arguments):  # type: ignore[no-untyped-def]
        key  # noqa: B018 (see persistent)
        _land(zeros8(), pointer_to(work), *arguments)  # type: ignore[call-arg]

    return compiled


_land_all = persistent(_build_land)


def land(
    problem: Problem,
    periods: int,
    unit: float,
    places: np.ndarray,
    normal: np.ndarray,
    corrections: int,
) -> np.ndarray:
    """Return the points of a curve near several places, each in its plane.

    Newton's method takes whole corrections, so a place has to be close to its point.

    Parameters
    ----------
    problem : Problem
        At any nu.
    periods : int
        Mesh periods of the orbits.
    unit : float
        Change of nu that counts like a change of 1 in the state.
    places : ndarray, shape (n, 5)
    normal : ndarray, shape (5,)
        Normal of all planes.
    corrections : int
        Most corrections of a point.

    Returns
    -------
    ndarray, shape (n, POINT_SIZE)
        With the columns of `curves`. Events are not counted, and the least force is not-a-number.
    """
    law = np.array([run_row(problem, TOLERANCE, 0)]).view(RUN)[:, 0]
    law["most_steps"] *= periods / law["periods"]
    law["periods"], law["first_kept"], law["direction"] = periods, 0.0, 0.0
    stated = law, unit, problem.nu
    most = min(len(places), _CHUNK)
    runs, summaries = np.repeat(law, most), np.zeros(most, SUMMARY)
    strobes, work = np.empty((most, periods + 1, 2)), workspace(ALL_ROWS)
    points = np.empty((len(places), curves.POINT_SIZE))
    points[:, : curves.DIMENSIONS] = places
    for first in range(0, len(points), _CHUNK):
        chunk = points[first : first + _CHUNK]
        _land_all(work, runs, stated, corrections, normal, chunk, summaries, strobes, _NO_EXTREMA)
    return points
