"""Runs of the reduced system: what the compiled sweep takes of a problem, and what it returns."""

import math
from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from itertools import accumulate, pairwise
from typing import NamedTuple

import numpy as np
from numba import njit

from gearmesh.model import motion
from gearmesh.model.friction import mesh_gamma
from gearmesh.model.motion import Problem
from gearmesh.model.stiffness import in_double_contact, switch_phases
from gearmesh.solvers import lanes, response
from gearmesh.solvers.compilation import persistent
from gearmesh.solvers.reduced import events, stops, sweep, taylor, workspace
from gearmesh.solvers.response import LOOSENING, Response, assemble

_EXTREMA_PER_PERIOD = 64
# Equal wheels: the pitch point halves the single contact.
_PITCH_PHASE = 0.5
# Samples that are closer to a switch than rounding can tell are on it.
_ON_EDGE = 1e-9


def _build_vector_sweep(sources: str, cache: bool):
    @njit(cache=cache, nogil=True)
    def compiled(work, runs, summaries, strobes, extrema, samples, samples_per_period):
        sources  # noqa: B018 (see persistent)
        sweep.sweep(
            lanes.zeros8(),
            lanes.pointer_to(work),
            runs,
            summaries,
            strobes,
            extrema,
            samples,
            samples_per_period,
        )

    return compiled


def _build_scalar_sweep(sources: str, cache: bool):
    @njit(cache=cache, nogil=True)
    def compiled(work, runs, summaries, strobes, extrema, samples, samples_per_period):
        sources  # noqa: B018 (see persistent)
        sweep.sweep(
            lanes.zeros1(),
            lanes.pointer_to(work),
            runs,
            summaries,
            strobes,
            extrema,
            samples,
            samples_per_period,
        )

    return compiled


_MODULES = (lanes, workspace, taylor, events, stops, motion, response, sweep)
_vector_sweep = persistent(_build_vector_sweep, *_MODULES)
# A run alone keeps one lane busy; there scalar instructions are faster, and as exact.
_scalar_sweep = persistent(_build_scalar_sweep, *_MODULES)


def is_reducible(problem: Problem) -> bool:
    """Tell whether a problem has no run-out, profile deviation or Fourier stiffness."""
    run_out = problem.eccentricity_3 != 0.0 or problem.eccentricity_2 != 0.0
    return not (run_out or problem.deviation or problem.stiffness_harmonics)


class Stretch(NamedTuple):
    """A stretch of the mesh period in which stiffness and friction do not change.

    Attributes
    ----------
    length : float
        In mesh periods.
    double : bool
        Whether two pairs of teeth are in contact.
    gamma : float
        Of eq. (6), over all pairs in contact.
    """

    length: float
    double: bool
    gamma: float


def _pattern(problem: Problem) -> tuple[float, float, bool]:
    """Return what the stretches of a mesh period depend on."""
    return problem.contact_ratio, problem.initial_phase, problem.friction_coefficient != 0.0


@lru_cache
def _stretches(contact_ratio: float, initial_phase: float, friction: bool) -> list[Stretch]:
    """Cut a mesh period at every switch, and at the pitch point where friction turns."""
    places = [*switch_phases(contact_ratio), *([_PITCH_PHASE] if friction else [])]
    edges = [0.0, *sorted((place - initial_phase) % 1.0 for place in places), 1.0]
    stretches = []
    for start, end in pairwise(edges):
        if end > start:
            middle = (0.5 * (start + end) + initial_phase) % 1.0
            double = bool(in_double_contact(middle, contact_ratio))
            stretches.append(Stretch(end - start, double, mesh_gamma(middle, contact_ratio)))
    return stretches


@lru_cache
def _sample_ends(pattern: tuple[float, float, bool], per_period: int) -> list[int]:
    """Return the number of the first sample behind each stretch; one at its end is behind it."""
    edges = accumulate(stretch.length for stretch in _stretches(*pattern))
    return [math.ceil(edge * per_period - _ON_EDGE) for edge in edges]


def _run(problem: Problem, tolerance: float, samples_per_period: int) -> list[float]:
    """Return `problem` in the form that the compiled sweep takes, a row of `sweep.RUN`."""
    period = problem.period
    pattern = _pattern(problem)
    stretches = _stretches(*pattern)
    friction = problem.friction_coefficient * math.tan(problem.pressure_angle)
    rest = [0.0] * (workspace.MAX_SEGMENTS - len(stretches))
    high, low = problem.stiffness_max, problem.stiffness_min
    periods = problem.revolutions * problem.teeth
    frequency = math.sqrt(problem.bearing_stiffness / problem.body_mass)
    bearing = -2.0 / problem.bearing_stiffness
    return [
        len(stretches),
        *[stretch.length * period for stretch in stretches],
        *rest,
        *[high if stretch.double else low for stretch in stretches],
        *rest,
        *[friction * stretch.gamma for stretch in stretches],
        *rest,
        *_sample_ends(pattern, samples_per_period),
        *rest,
        period,
        periods,
        periods - problem.kept_revolutions * problem.teeth,
        *problem.material,
        *problem.lubricant,
        problem.backlash,
        2.0 / problem.body_mass,
        frequency**2,
        2.0 * problem.bearing_damping_ratio * frequency,
        *(problem.initial_state or (1.0 - bearing, 0.0, bearing, 0.0)),
        math.log2(tolerance),
        _EXTREMA_PER_PERIOD * problem.kept_revolutions * problem.teeth,
    ]


def integrate(
    problems: Sequence[Problem], tolerance: float, samples_per_period: int, estimate_errors: bool
) -> list[Response]:
    """Integrate reducible problems; see `gearmesh.solvers.simulation.simulate`."""
    n = len(problems)
    rows = [_run(problem, tolerance, samples_per_period) for problem in problems]
    # Companions follow the runs and leave nothing but their summaries.
    runs = np.array(rows + rows if estimate_errors else rows).view(sweep.RUN)[:, 0]
    runs["log_tolerance"][n:] = math.log2(tolerance * LOOSENING)
    # Displaced, they tell of a sensitive orbit even where stops decide the steps, not tolerances.
    runs["start"][n:, 0] += tolerance
    kept = max(problem.kept_revolutions * problem.teeth for problem in problems)
    summaries = np.zeros(len(runs), sweep.SUMMARY)
    summaries["y_max"] = -np.inf
    summaries["y_min"] = np.inf
    strobes = np.empty((n, int(runs["periods"].max()) + 1, 2))
    extrema = np.empty((n, int(runs["most_extrema"].max())), response.EXTREMUM)
    sampled = n if samples_per_period else 0
    row = kept * samples_per_period + lanes.WIDEST
    samples = np.empty((sampled, sweep.SAMPLED, row))
    sweep_runs = _scalar_sweep if len(runs) == 1 else _vector_sweep
    sweep_runs(_workspace(), runs, summaries, strobes, extrema, samples, samples_per_period)
    measured = [
        dict(zip(sweep.SUMMARY.names, values, strict=True)) for values in summaries.tolist()
    ]
    return [
        assemble(
            measured[i],
            measured[n + i] if estimate_errors else None,
            strobes[i, : problem.revolutions * problem.teeth + 1],
            extrema[i, : measured[i]["extrema"]],
            problem.period,
            problem.kept_revolutions * problem.teeth,
            tuple(measured[i]["final"]),
            tolerance,
            _Samples(problem, samples[i], samples_per_period) if sampled else None,
        )
        for i, problem in enumerate(problems)
    ]


def _workspace() -> np.ndarray:
    """Return the workspace of the sweep; a row that straddles two cache lines costs two loads."""
    row = 8 * lanes.WIDEST
    raw = np.zeros((workspace.N_ROWS + 1) * lanes.WIDEST)
    first = -raw.ctypes.data % row // 8
    return raw[first : first + workspace.N_ROWS * lanes.WIDEST]


class _Samples:
    """A time course like `response.Samples`; all but y, v and a is computed when asked for."""

    def __init__(self, problem: Problem, rows: np.ndarray, per_period: int):
        self._problem = problem
        self._per_period = per_period
        self._kept = problem.kept_revolutions * problem.teeth
        self.y, self.v, self.a = rows[:, : self._kept * per_period]

    @cached_property
    def time(self) -> np.ndarray:
        first = (self._problem.revolutions - self._problem.kept_revolutions) * self._problem.teeth
        spacing = self._problem.period / self._per_period
        return first * self._problem.period + np.arange(self.y.size) * spacing

    @cached_property
    def regime(self) -> np.ndarray:
        problem = self._problem
        flank = np.where(self.y <= -problem.backlash, motion.INVERSE_MESH, motion.CONTACT_LOSS)
        return np.where(self.y >= 0.0, motion.NORMAL_MESH, flank).astype(np.int8)

    @cached_property
    def stiffness(self) -> np.ndarray:
        problem = self._problem
        return self._of_stretches(
            lambda stretch: problem.stiffness_max if stretch.double else problem.stiffness_min
        )

    @cached_property
    def modified_stiffness(self) -> np.ndarray:
        return self.stiffness * (self.regime != motion.CONTACT_LOSS)

    @cached_property
    def force_dynamic(self) -> np.ndarray:
        return motion.dynamic_force(self.y, self.stiffness)

    @cached_property
    def force_friction(self) -> np.ndarray:
        problem = self._problem
        depth = self.y + problem.backlash * (self.regime == motion.INVERSE_MESH)
        gamma = self._of_stretches(lambda stretch: stretch.gamma)
        return -problem.friction_coefficient * gamma * self.modified_stiffness * depth

    def _of_stretches(self, value: Callable[[Stretch], float]) -> np.ndarray:
        """Return what belongs to the stretches of a mesh period, for every sample."""
        pattern = _pattern(self._problem)
        values = [value(stretch) for stretch in _stretches(*pattern)]
        counts = np.diff(_sample_ends(pattern, self._per_period), prepend=0)
        return np.tile(np.repeat(values, counts), self._kept)
