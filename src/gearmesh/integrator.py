"""Integration of runs, one or thousands, to a tolerance.

`simulate` is the one door to both solvers: the compiled sweep over SIMD lanes
(`gearmesh.solver.sweep`) for the reduced system, and the general solver in the six coordinates
(`gearmesh.solver.general`) for what the reduction leaves out: run-out, profile deviation and the
truncated Fourier series of the stiffness.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numba import njit

from gearmesh import motion, response
from gearmesh.friction import mesh_gamma
from gearmesh.motion import Problem
from gearmesh.response import LOOSENING, Response, Samples, assemble
from gearmesh.solver import events, lanes, sweep, taylor
from gearmesh.solver.compilation import persistent
from gearmesh.stiffness import in_double_contact, switch_phases

_EXTREMA_PER_PERIOD = 64
# Equal wheels: the pitch point halves the single contact.
_PITCH_PHASE = 0.5
_CHUNK = 256


def _build_sweep(sources: str, cache: bool):
    @njit(cache=cache, nogil=True)
    def compiled(work, runs, summaries, strobes, extrema, samples, samples_per_period):
        sources  # noqa: B018 (see persistent)
        sweep.sweep(
            lanes.zeros8(), work, runs, summaries, strobes, extrema, samples, samples_per_period
        )

    return compiled


_sweep = persistent(_build_sweep, lanes, taylor, events, motion, response, sweep)


def simulate(
    problems: Sequence[Problem],
    tolerance: float = 1e-10,
    samples_per_period: int = 0,
    estimate_errors: bool = True,
) -> list[Response]:
    """Integrate `problems` and measure their responses.

    Parameters
    ----------
    problems : sequence of Problem
        The runs; each is independent of the others, to the last bit.
    tolerance : float
        Bound of the local error of a step, in y_st and y_st Omega_s.
    samples_per_period : int
        Samples of the time course in each kept mesh period; 0 for none.
    estimate_errors : bool
        Whether every run has a companion, `LOOSENING` times less accurate, for the estimates
        `Response.y_max_error`, `y_min_error` and `sensitive`. Costs as much as the run.

    Returns
    -------
    list of Response
        In the order of `problems`. A run that fails has a status other than ``"ok"``.
    """
    responses: list[Response | None] = [None] * len(problems)
    reduced = [i for i, problem in enumerate(problems) if _is_reducible(problem)]
    for first in range(0, len(reduced), _CHUNK):
        chunk = reduced[first : first + _CHUNK]
        found = _simulate_reduced(
            [problems[i] for i in chunk], tolerance, samples_per_period, estimate_errors
        )
        for i, measured in zip(chunk, found, strict=True):
            responses[i] = measured
    if len(reduced) < len(problems):
        from gearmesh.solver.general import integrate

        for i, measured in enumerate(responses):
            if measured is None:
                responses[i] = integrate(
                    problems[i], tolerance, samples_per_period, estimate_errors=estimate_errors
                )
    return responses


def _is_reducible(problem: Problem) -> bool:
    run_out = problem.eccentricity_3 != 0.0 or problem.eccentricity_2 != 0.0
    return not (run_out or problem.deviation or problem.stiffness_harmonics)


@lru_cache
def _stretches(contact_ratio: float, initial_phase: float, friction: bool):
    """Return (length, double contact, gamma) of each stretch of a mesh period, from its start.

    Lengths are in mesh periods; a period ends at every switch, and at the pitch point where
    friction turns.
    """
    places = [*switch_phases(contact_ratio), *([_PITCH_PHASE] if friction else [])]
    edges = [0.0, *sorted((place - initial_phase) % 1.0 for place in places), 1.0]
    stretches = []
    for start, end in pairwise(edges):
        if end > start:
            middle = (0.5 * (start + end) + initial_phase) % 1.0
            double = bool(in_double_contact(middle, contact_ratio))
            stretches.append((end - start, double, mesh_gamma(middle, contact_ratio)))
    return stretches


def _run(problem: Problem, tolerance: float) -> tuple:
    """Return `problem` in the form that the compiled sweep takes, a row of `sweep.RUN`."""
    friction = problem.friction_coefficient * math.tan(problem.pressure_angle)
    period = 2.0 * math.pi / problem.nu
    stretches = _stretches(problem.contact_ratio, problem.initial_phase, friction != 0.0)
    levels = {True: problem.stiffness_max, False: problem.stiffness_min}
    rest = (0.0,) * (sweep.MAX_SEGMENTS - len(stretches))
    periods = problem.revolutions * problem.teeth
    frequency = math.sqrt(problem.bearing_stiffness / problem.body_mass)
    bearing = -2.0 / problem.bearing_stiffness
    start = problem.initial_state or (1.0 - bearing, 0.0, bearing, 0.0)
    return (
        len(stretches),
        tuple(length * period for length, _, _ in stretches) + rest,
        tuple(levels[double] for _, double, _ in stretches) + rest,
        tuple(friction * gamma for _, _, gamma in stretches) + rest,
        tuple(-problem.friction_coefficient * gamma for _, _, gamma in stretches) + rest,
        period,
        periods,
        periods - problem.kept_revolutions * problem.teeth,
        problem.material,
        problem.lubricant,
        problem.backlash,
        2.0 / problem.body_mass,
        frequency**2,
        2.0 * problem.bearing_damping_ratio * frequency,
        start,
        math.log2(tolerance),
    )


def _simulate_reduced(problems, tolerance, samples_per_period, estimate_errors) -> list[Response]:
    n = len(problems)
    rows = [_run(problem, tolerance) for problem in problems]
    # Companions follow the runs and leave nothing but their summaries.
    runs = np.array(rows + rows if estimate_errors else rows, sweep.RUN)
    runs["log_tolerance"][n:] = math.log2(tolerance * LOOSENING)
    kept = int((runs["periods"] - runs["first_kept"]).max())
    summaries = np.zeros(len(runs), sweep.SUMMARY)
    summaries["y_max"] = -np.inf
    summaries["y_min"] = np.inf
    strobes = np.empty((n, int(runs["periods"].max()) + 1, 2))
    extrema = np.empty((n, _EXTREMA_PER_PERIOD * kept), response.EXTREMUM)
    sampled = n if samples_per_period else 0
    row = kept * samples_per_period + lanes.WIDEST
    samples = np.empty((sampled, sweep.N_SAMPLE_ROWS * row))
    _sweep(_workspace(), runs, summaries, strobes, extrema, samples, samples_per_period)
    return [
        assemble(
            summaries[i],
            summaries[n + i] if estimate_errors else None,
            strobes[i, : runs[i]["periods"] + 1],
            extrema[i, : summaries[i]["extrema"]],
            float(runs[i]["period"]),
            problem.kept_revolutions * problem.teeth,
            tuple(summaries[i]["final"].tolist()),
            tolerance,
            _samples(problem, samples[i], samples_per_period) if sampled else None,
        )
        for i, problem in enumerate(problems)
    ]


def _workspace() -> np.ndarray:
    """Return the workspace of the sweep; a row that straddles two cache lines costs two loads."""
    row = 8 * lanes.WIDEST
    raw = np.zeros((taylor.N_ROWS + 1) * lanes.WIDEST)
    first = -raw.ctypes.data % row // 8
    return raw[first : first + taylor.N_ROWS * lanes.WIDEST]


def _samples(problem, rows, per_period) -> Samples:
    n = problem.kept_revolutions * problem.teeth * per_period
    courses = rows.reshape(sweep.N_SAMPLE_ROWS, -1)[:, :n]
    first = (problem.revolutions - problem.kept_revolutions) * problem.teeth
    period = 2.0 * math.pi / problem.nu
    time = first * period + np.arange(n) * (period / per_period)
    return Samples(time, *courses[:-1], regime=courses[-1].astype(np.int8))
