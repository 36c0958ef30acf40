"""Ensembles: many runs of the reduced system that are moved on together, period by period.

A run is a row of numbers here, not a `Problem`: thousands of initial conditions of one gear pair
share the row of its laws.
"""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from gearmesh.model.contact import regime_of
from gearmesh.model.problem import Problem
from gearmesh.solvers.lanes.operations import WIDEST
from gearmesh.solvers.reduced.measures import SAMPLED
from gearmesh.solvers.reduced.records import RUN, SUMMARY
from gearmesh.solvers.reduced.runs import run_row, sweep_all
from gearmesh.solvers.response import EXTREMUM, OK

TOLERANCE = 1e-10
"""Local error tolerance, relative to y_st and y_st Omega_s."""

_CHUNK = 4096  # runs in one call of the compiled code
_NO_EXTREMA = np.empty((0, 0), EXTREMUM)
_NO_SAMPLES = np.empty((0, SAMPLED, WIDEST))


def laws_of(problems: Sequence[Problem], tolerance: float = TOLERANCE) -> np.ndarray:
    """Return the laws of reducible problems as an array of `RUN`, for `advance` and `measure`.

    Raises
    ------
    InputError
        If only the general solver serves one of them.
    """
    return np.array([run_row(problem, tolerance, 0) for problem in problems]).view(RUN)[:, 0]


def advance(laws: np.ndarray, states: np.ndarray, periods: int | np.ndarray) -> np.ndarray:
    """Return the states that runs reach after whole mesh periods.

    Parameters
    ----------
    laws : ndarray of `RUN`, shape (n,) or (1,)
        Of each run, or of all.
    states : ndarray, shape (n, 4)
        y, y', b, b' at the initial phase.
    periods : int or ndarray of int, shape (n,)
        Mesh periods of all runs, or of each, >= 1.

    Returns
    -------
    ndarray, shape (n, 4)
        Not-a-number if a run fails.
    """
    ends: np.ndarray = measure(laws, states, periods)["final"]
    return ends


def trace(
    laws: np.ndarray, states: np.ndarray, periods: int | np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return what `advance` returns, and the stroboscopic points on the way.

    Returns
    -------
    ends : ndarray, shape (n, 4)
    strobes : ndarray, shape (n, periods + 1, 2)
        y and y' at the boundaries of the mesh periods.
    """
    measured, strobes = _sweep(laws, states, periods, 0)
    return measured["final"], strobes


def measure(
    laws: np.ndarray, states: np.ndarray, periods: int | np.ndarray, kept: int = 0
) -> np.ndarray:
    """Return the measurements on the last mesh periods of runs, and the states at their ends.

    Parameters
    ----------
    laws, states, periods
        As for `advance`.
    kept : int
        Mesh periods that are measured, at most `periods`.

    Returns
    -------
    ndarray of `SUMMARY`, shape (n,)
        Times and integrals are those of the whole kept time. If a run fails, its extremes, times
        and end are not-a-number.
    """
    if len(states) <= _CHUNK:
        return _sweep(laws, states, periods, kept)[0]
    chunks = [slice(first, first + _CHUNK) for first in range(0, len(states), _CHUNK)]
    several, lengths = len(laws) > 1, np.broadcast_to(periods, len(states))

    def of(chunk: slice) -> np.ndarray:
        return _sweep(laws[chunk] if several else laws, states[chunk], lengths[chunk], kept)[0]

    with ThreadPoolExecutor(os.cpu_count()) as threads:
        return np.concatenate(list(threads.map(of, chunks)))


def _sweep(
    laws: np.ndarray, states: np.ndarray, periods: int | np.ndarray, kept: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the summaries and the stroboscopic points of runs."""
    runs = np.repeat(laws, len(states)) if len(laws) == 1 else laws.copy()
    runs["most_steps"] *= np.maximum(periods, 1) / runs["periods"]
    runs["periods"], runs["first_kept"] = periods, periods - kept
    runs["start"] = states
    runs["regime"] = regime_of(states[:, 0], runs["backlash"])
    runs["direction"] = 0.0
    summaries = np.zeros(len(runs), SUMMARY)
    summaries["y_max"], summaries["y_min"] = -np.inf, np.inf
    strobes = np.empty((len(runs), int(np.max(periods, initial=0)) + 1, 2))
    sweep_all(WIDEST, runs, summaries, strobes, _NO_EXTREMA, _NO_SAMPLES, 0)
    failed = summaries["status"] != OK
    for name in ("y_max", "y_min", "square_integral", "loss_time", "inverse_time", "final"):
        summaries[name][failed] = np.nan
    return summaries, strobes


def advance_to_phase(problem: Problem, phases: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return the states at the initial phase of `problem` that runs from other phases reach.

    Parameters
    ----------
    problem : Problem
    phases : ndarray, shape (n,)
        Mesh phase of each state.
    states : ndarray, shape (n, 4)
    """
    ends = states.copy()
    for phase in np.unique(phases):
        share = (problem.initial_phase - phase) % 1.0
        if share > 0.0:
            laws = laws_of([replace(problem, initial_phase=float(phase))], TOLERANCE)
            ends[phases == phase] = advance(_cut(laws, share), states[phases == phase], 1)
    return ends


def _cut(laws: np.ndarray, share: float) -> np.ndarray:
    """Return the laws of one run with a mesh period that ends after a share of it."""
    [run] = laws
    behind = np.cumsum(run["length"])
    lengths = np.minimum(behind, share * run["period"]) - (behind - run["length"])
    segments = int((lengths > 0.0).sum())
    laws["length"], laws["segments"] = np.maximum(lengths, 0.0), segments
    return laws
