"""Integration of one run in the six coordinates: the solver for every problem.

Taylor series of high order in steps that end exactly at every jump of the laws
(`general_series`, `general_kernel`). It serves the problems that the reduced system leaves out
(run-out, profile deviation, truncated Fourier stiffness), and checks the others.
"""

import itertools
import math

import numpy as np
from numba import njit

from gearmesh.model import motion, stiffness
from gearmesh.model.friction import follows_run_out, pairs_in_contact
from gearmesh.model.motion import (
    CONTACT_LOSS,
    ROTATION_3,
    Problem,
    bearing_damping,
    dynamic_force,
    start,
    sum_and_difference,
)
from gearmesh.solvers import response
from gearmesh.solvers.compilation import persistent
from gearmesh.solvers.full import kernel as general_kernel
from gearmesh.solvers.full import roots as general_roots
from gearmesh.solvers.full import series as general_series
from gearmesh.solvers.full.kernel import SAMPLE, SUMMARY
from gearmesh.solvers.full.roots import MAX_DEGREE
from gearmesh.solvers.full.series import CASE, MODE, STRETCH
from gearmesh.solvers.response import EXTREMUM, LOOSENING, Response, Samples, assemble

_EXTREMA_PER_PERIOD = 64
_STEPS_PER_PERIOD = 2000

# In radians of the fastest oscillation. The series of an oscillation too small for the error
# control (an unexcited mode) still have to converge, else it grows from rounding.
_LONGEST_STEP = 2.0


def _build_run(sources: str, cache: bool):
    @njit(cache=cache, nogil=True)
    def compiled(*arguments):
        sources  # noqa: B018 (see persistent)
        general_kernel.run(*arguments)

    return compiled


_compiled_run = persistent(
    _build_run, general_roots, general_series, general_kernel, motion, response
)


def integrate(
    problem: Problem,
    tolerance: float = 1e-10,
    samples_per_period: int = 0,
    order: int | None = None,
    estimate_errors: bool = True,
) -> Response:
    """Integrate `problem` and measure its response.

    Parameters
    ----------
    problem : Problem
    tolerance : float
        Bound of the last terms of the series in a step, in y_st and y_st Omega_s.
    samples_per_period : int
        Samples of the time course in each kept mesh period; 0 for none.
    order : int, optional
        Degree of the Taylor polynomials, 4 to 28; by default what suits the tolerance.
    estimate_errors : bool
        Whether the run has a companion, `LOOSENING` times less accurate and displaced by the
        tolerance at the start, whose difference gives `Response.y_max_error` and `y_min_error`.
        Costs as much as the run.

    Returns
    -------
    Response
        A run that fails has a status other than ``"ok"``.
    """
    summary, state, strobes, extrema, samples = _run(
        problem, tolerance, samples_per_period, order or suitable_order(tolerance)
    )
    companion = None
    if estimate_errors:
        loose = tolerance * LOOSENING
        companion, *_ = _run(problem, loose, 0, order or suitable_order(loose), tolerance)
    return assemble(
        summary,
        companion,
        strobes,
        extrema,
        problem.period,
        problem.kept_revolutions * problem.teeth,
        sum_and_difference(state[:6], state[6:]),
        tolerance,
        _samples(samples) if samples_per_period else None,
    )


def _run(
    problem: Problem,
    tolerance: float,
    samples_per_period: int,
    order: int,
    displacement: float = 0.0,
):
    """Return the summary, the final state, strobes, extrema and samples of one run."""
    periods = problem.revolutions * problem.teeth
    kept = problem.kept_revolutions * problem.teeth
    strobes = np.zeros((periods + 1, 2))
    extrema = np.zeros(_EXTREMA_PER_PERIOD * kept, EXTREMUM)
    samples = np.zeros(samples_per_period * kept, SAMPLE)
    summaries = np.zeros(1, SUMMARY)
    summaries["y_max"], summaries["y_min"] = -np.inf, np.inf
    state = np.concatenate(start(problem))
    state[ROTATION_3] += displacement
    _compiled_run(
        _case(problem, tolerance, order),
        _stretches(problem),
        _waves(problem),
        np.array(problem.deviation, float).reshape(-1, 2),
        state,
        np.zeros(1, MODE),
        strobes,
        extrema,
        samples,
        samples_per_period,
        summaries,
    )
    summary = summaries[0]
    return summary, state, strobes, extrema[: summary["extrema"]], samples


def suitable_order(tolerance: float) -> int:
    """Return the degree of the series at which a unit of time costs least at `tolerance`.

    Jorba and Zou's optimum, -ln(tolerance) / 2 + 1, and two more for the events that cut steps.
    """
    return min(MAX_DEGREE, max(8, math.ceil(3.0 - 0.5 * math.log(tolerance))))


def _case(problem: Problem, tolerance: float, order: int) -> np.ndarray:
    case = np.zeros(1, CASE)
    # Numbers that have the same name and meaning in both.
    for name in (
        *("nu", "period", "initial_phase", "rotation_speed", "teeth", "material", "lubricant"),
        *("backlash", "body_mass", "bearing_stiffness", "base_radius"),
        *("eccentricity_3", "eccentricity_2", "eccentricity_angle"),
    ):
        case[name] = getattr(problem, name)
    case["stiffness_mean"] = stiffness.mean(
        problem.contact_ratio, problem.stiffness_max, problem.stiffness_min
    )
    case["bearing_damping"] = bearing_damping(problem)
    case["friction"] = problem.friction_coefficient
    case["middle_arm"] = math.tan(problem.pressure_angle)
    case["base_pitch"] = 2.0 * math.pi / problem.teeth
    case["has_run_out"] = problem.eccentricity_3 != 0.0 or problem.eccentricity_2 != 0.0
    case["follows_run_out"] = problem.friction_coefficient != 0.0 and follows_run_out(
        problem.eccentricity_3, problem.eccentricity_2
    )
    case["periods"] = problem.revolutions * problem.teeth
    case["first_kept"] = case["periods"] - problem.kept_revolutions * problem.teeth
    case["tolerance"] = tolerance
    case["longest_step"] = _LONGEST_STEP / _highest_frequency(problem)
    case["order"] = order
    per_period = _STEPS_PER_PERIOD + 20 * (problem.stiffness_harmonics + len(problem.deviation))
    case["most_steps"] = per_period * case["periods"]
    return case


def _highest_frequency(problem: Problem) -> float:
    """Return a bound of the natural frequencies in contact: the trace of the coupled stiffness."""
    mesh = problem.stiffness_max * (1.0 + 2.0 / problem.body_mass)
    return math.sqrt(mesh + problem.bearing_stiffness / problem.body_mass)


def _stretches(problem: Problem) -> np.ndarray:
    """Return the parts of a mesh period, from its boundary at the initial phase."""
    places: set[float] = set()
    if not problem.stiffness_harmonics or problem.friction_coefficient:
        places.update(stiffness.switch_phases(problem.contact_ratio))
    if problem.friction_coefficient:
        places.add(0.5)
    phase = problem.initial_phase
    edges = [0.0, *sorted((place - phase) % 1.0 for place in places), 1.0]
    parts = []
    for low, high in itertools.pairwise(edges):
        if low == high:
            continue
        middle = 0.5 * (low + high) + phase
        pairs = pairs_in_contact(middle, problem.contact_ratio)
        level = stiffness.rectangular(
            middle, problem.contact_ratio, problem.stiffness_max, problem.stiffness_min
        )
        gamma = sum(gamma for gamma, _ in pairs)
        sigma = pairs[0][1] - 0.5 * (low + high)
        parts.append((high * problem.period, level, gamma, sigma))
    return np.array(parts, STRETCH)


def _waves(problem: Problem) -> np.ndarray:
    """Return the amplitudes (cosine, sine) of the truncated series of C(t), shape (n, 2)."""
    waves = np.zeros((problem.stiffness_harmonics, 2))
    waves[:, 0] = stiffness.fourier_amplitudes(
        problem.contact_ratio,
        problem.stiffness_max,
        problem.stiffness_min,
        problem.stiffness_harmonics,
    )
    return waves


def _samples(rows: np.ndarray) -> Samples:
    columns = {name: rows[name].copy() for name in rows.dtype.names}
    regime = columns["regime"].astype(np.int8)
    return Samples(
        time=columns["time"],
        y=columns["y"],
        v=columns["v"],
        a=columns["a"],
        stiffness=columns["stiffness"],
        modified_stiffness=columns["stiffness"] * (regime != CONTACT_LOSS),
        force_dynamic=dynamic_force(columns["y"], columns["stiffness"]),
        force_friction=columns["friction"],
        regime=regime,
    )
