"""Runs of the reduced system: what the compiled sweep takes of a problem, and what it returns."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numba import njit

from gearmesh.errors import InputError
from gearmesh.model.contact import (
    CONTACT_LOSS,
    INVERSE_MESH,
    dynamic_force,
    elastic_force,
    regime_of,
)
from gearmesh.model.damping import damping_force
from gearmesh.model.problem import Branches, GeneralTerms, Problem, State
from gearmesh.model.segments import Segment, segments
from gearmesh.solvers import limits
from gearmesh.solvers.compilation import persistent
from gearmesh.solvers.lanes.operations import WIDEST, zeros1, zeros8
from gearmesh.solvers.lanes.rows import pointer_to
from gearmesh.solvers.reduced.measures import SAMPLED
from gearmesh.solvers.reduced.records import RUN, SUMMARY
from gearmesh.solvers.reduced.sweep import ENDED, PROGRESS, sweep
from gearmesh.solvers.reduced.workspace import MAX_SEGMENTS, N_ROWS
from gearmesh.solvers.response import EXTREMUM, LOOSENING, Companion, Response, assemble

_EXTREMA_PER_PERIOD = 64
# Samples that are as close to a switch as this, which is rounding, are on it.
_ON_EDGE = 1e-9
# Steps between two returns to Python, where an interruption is noticed: some 0.1 s.
_MOST_TURNS = 100_000


def _build_vector_sweep(key: str, cache: bool) -> Callable[..., bool]:
    @njit(cache=cache, nogil=True)
    def compiled(work, *arguments):  # type: ignore[no-untyped-def]
        key  # noqa: B018 (see persistent)
        return sweep(zeros8(), pointer_to(work), *arguments)  # type: ignore[call-arg]

    return compiled


def _build_scalar_sweep(key: str, cache: bool) -> Callable[..., bool]:
    @njit(cache=cache, nogil=True)
    def compiled(work, *arguments):  # type: ignore[no-untyped-def]
        key  # noqa: B018 (see persistent)
        return sweep(zeros1(), pointer_to(work), *arguments)  # type: ignore[call-arg]

    return compiled


_vector_sweep = persistent(_build_vector_sweep)
# A single run fills one lane only; scalar instructions are then faster, and as exact.
_scalar_sweep = persistent(_build_scalar_sweep)


def is_reducible(problem: Problem) -> bool:
    """Return whether a problem has equal wheels without run-out and no term beyond the paper's.

    Profile deviation, a truncated series of the stiffness and a speed that changes are such terms.
    """
    if problem.wheels is not None or problem.terms != GeneralTerms():
        return False
    if problem.final_nu is not None:
        return False
    return not (problem.has_run_out or problem.deviation or problem.stiffness_harmonics)


def check_reducible(problem: Problem) -> None:
    """Raise `InputError` if only the general solver serves a problem.

    The equations of this package would leave out its terms without a word.
    """
    if not is_reducible(problem):
        raise InputError(
            "pair: found terms that only the general solver knows; allowed are those of the "
            "reduced system"
        )


def integrate(
    problems: Sequence[Problem],
    tolerance: float,
    samples_per_period: int,
    estimate_errors: bool,
    extrema_per_period: int = _EXTREMA_PER_PERIOD,
) -> list[Response]:
    """Integrate reducible problems; see `gearmesh.solvers.simulation.simulate`.

    The runs of which a kept period has more than `extrema_per_period` extrema on average are
    integrated again with room for all of them.
    """
    n = len(problems)
    runs = _runs(problems, tolerance, samples_per_period, estimate_errors)
    kept = max(problem.kept_periods for problem in problems)
    summaries = np.zeros(len(runs), SUMMARY)
    summaries["y_max"], summaries["y_min"] = -np.inf, np.inf
    strobes = np.empty((len(runs), int(runs["periods"].max()) + 1, 2))
    extrema = np.empty((n, extrema_per_period * kept), EXTREMUM)
    sampled = n if samples_per_period else 0
    samples = np.empty((sampled, SAMPLED, kept * samples_per_period + WIDEST))
    width = 1 if len(runs) == 1 else WIDEST
    sweep_all(width, runs, summaries, strobes, extrema, samples, samples_per_period)
    measured = [
        dict(zip(SUMMARY.names or (), values, strict=True)) for values in summaries.tolist()
    ]
    responses = []
    for i, problem in enumerate(problems):
        found, boundaries = measured[i], problem.periods + 1
        companion = None
        if estimate_errors:
            companion = Companion(measured[n + i], strobes[n + i, :boundaries])
        if found["extrema"] > extrema.shape[1]:
            room = math.ceil(found["extrema"] / problem.kept_periods)
            responses += integrate([problem], tolerance, samples_per_period, estimate_errors, room)
            continue
        responses.append(
            assemble(
                problem,
                found,
                strobes[i, :boundaries],
                extrema[i, : found["extrema"]],
                _final_state(problem, found),
                companion,
                tolerance,
                _Samples(problem, samples[i], samples_per_period) if sampled else None,
            )
        )
    return responses


def _runs(
    problems: Sequence[Problem], tolerance: float, samples_per_period: int, estimate_errors: bool
) -> np.ndarray:
    """Return the runs in the form that the sweep takes, followed by their companions."""
    n = len(problems)
    rows = [run_row(problem, tolerance, samples_per_period) for problem in problems]
    runs = np.array(rows + rows if estimate_errors else rows).view(RUN)[:, 0]
    companions = runs[n:]
    companions["log_tolerance"] = math.log2(tolerance * LOOSENING)
    # The displacement of the rotation reveals a sensitive orbit even if events decide the steps.
    start = companions["start"]
    start[:, 0] = ((start[:, 0] - start[:, 2]) + tolerance) + start[:, 2]
    companions["regime"] = regime_of(start[:, 0], companions["backlash"])
    companions["direction"] = 0.0
    return runs


def run_row(problem: Problem, tolerance: float, samples_per_period: int) -> list[float]:
    """Return a reducible problem in the form that the compiled sweep takes, a row of `RUN`."""
    check_reducible(problem)
    period, parts = problem.period, segments(problem)
    friction = problem.friction_coefficient * math.tan(problem.pressure_angle)
    rest = [0.0] * (MAX_SEGMENTS - len(parts))
    high, low = problem.stiffness_max, problem.stiffness_min
    frequency = math.sqrt(problem.bearing_stiffness / problem.body_mass)
    start, regime, direction = _start(problem)
    return [
        len(parts),
        *[part.length * period for part in parts],
        *rest,
        *[high if part.double else low for part in parts],
        *rest,
        *[friction * part.gamma for part in parts],
        *rest,
        *_sample_ends(parts, samples_per_period),
        *rest,
        period,
        problem.periods,
        problem.periods - problem.kept_periods,
        *problem.material,
        *problem.lubricant,
        problem.backlash,
        2.0 / problem.body_mass,
        frequency**2,
        2.0 * problem.bearing_damping_ratio * frequency,
        *start,
        regime,
        direction,
        limits.longest_step(problem),
        limits.farthest(problem),
        limits.most_steps(problem),
        math.log2(tolerance),
    ]


def _start(problem: Problem) -> tuple[tuple[float, float, float, float], float, float]:
    """Return (y, y', b, b'), the regime and the direction of motion at the start."""
    state = problem.initial_state
    if state is None:
        b = -2.0 / problem.bearing_stiffness
        y = (1.0 - b) + b
        return (y, 0.0, b, 0.0), regime_of(y, problem.backlash), 0.0
    start = state.y, state.v, state.b, state.b_rate
    branches = state.branches_for(problem)
    if branches is None:
        return start, regime_of(state.y, problem.backlash), 0.0
    # Where measuring begins, directions were not followed before.
    follows = branches.measured or problem.kept_revolutions < problem.revolutions
    return start, branches.regime, branches.direction if follows else 0.0


def _sample_ends(parts: tuple[Segment, ...], per_period: int) -> list[int]:
    """Return the number of the first sample after each segment; one at its end is after it."""
    return [math.ceil(part.end * per_period - _ON_EDGE) for part in parts]


def sweep_all(width: int, *arguments: object) -> None:
    """Call the compiled sweep of one lane or of `WIDEST` lanes until all runs are over."""
    progress = np.full(PROGRESS, -1, np.int64)
    compiled = _scalar_sweep if width == 1 else _vector_sweep
    progress[WIDEST:] = 0
    progress[ENDED] = (1 << width) - 1
    work = workspace(N_ROWS)
    while not compiled(work, *arguments, progress, _MOST_TURNS):
        pass


def workspace(rows: int) -> np.ndarray:
    """Return room for rows of lanes; a row that straddles two cache lines costs two loads."""
    raw = np.zeros((rows + 1) * WIDEST)
    first = -raw.ctypes.data % (8 * WIDEST) // 8
    return raw[first : first + rows * WIDEST]


def _final_state(problem: Problem, summary: Mapping[str, Any]) -> State:
    y, v, b, b_rate = summary["final"].tolist()
    branches = Branches(
        problem=problem if problem.initial_state is None else replace(problem, initial_state=None),
        regime=int(summary["regime"]),
        direction=summary["direction"],
        measured=problem.kept_revolutions > 0,
    )
    periods = problem.start_period + problem.periods
    return State(y, v, b, b_rate, periods=periods, branches=branches)


class _Samples:
    """A time course like `response.Samples`; what follows from it is computed on demand."""

    force_bearing_3_z = force_bearing_2_z = extremes = None

    def __init__(self, problem: Problem, rows: np.ndarray, per_period: int) -> None:
        self._problem = problem
        self._per_period = per_period
        self.y, self.v, self.a, self._b, self._b_rate = rows[:, : problem.kept_periods * per_period]

    @cached_property
    def time(self) -> np.ndarray:
        first = self._problem.periods - self._problem.kept_periods
        spacing = self._problem.period / self._per_period
        return first * self._problem.period + np.arange(self.y.size) * spacing

    @cached_property
    def regime(self) -> np.ndarray:
        return regime_of(self.y, self._problem.backlash).astype(np.int8)

    @cached_property
    def stiffness(self) -> np.ndarray:
        problem = self._problem
        return self._of_segments(
            lambda part: problem.stiffness_max if part.double else problem.stiffness_min
        )

    @cached_property
    def modified_stiffness(self) -> np.ndarray:
        return self.stiffness * (self.regime != CONTACT_LOSS)

    @cached_property
    def force_dynamic(self) -> np.ndarray:
        return dynamic_force(self.y, self.stiffness)

    @cached_property
    def force_normal(self) -> np.ndarray:
        problem = self._problem
        elastic = elastic_force(self.y, self.stiffness, self.regime, problem.backlash)
        damping = np.where(
            self.regime == CONTACT_LOSS,
            damping_force(self.v, problem.lubricant),
            damping_force(self.v, problem.material),
        )
        return elastic + damping

    @cached_property
    def transmission_error(self) -> np.ndarray:
        return self.y - self._b

    @cached_property
    def force_bearing_3(self) -> np.ndarray:
        # The bodies move alike, in opposite directions.
        damping, _ = self._problem.both_wheels[0].bearing_damping
        return 0.5 * (self._problem.bearing_stiffness * self._b + damping * self._b_rate)

    @cached_property
    def force_bearing_2(self) -> np.ndarray:
        return -self.force_bearing_3

    @cached_property
    def force_friction(self) -> np.ndarray:
        problem = self._problem
        depth = self.y + problem.backlash * (self.regime == INVERSE_MESH)
        gamma = self._of_segments(lambda part: part.gamma)
        return -problem.friction_coefficient * gamma * self.modified_stiffness * depth

    def _of_segments(self, value: Callable[[Segment], float]) -> np.ndarray:
        """Return what belongs to the segments of a mesh period, for every sample."""
        parts = segments(self._problem)
        counts = np.diff(_sample_ends(parts, self._per_period), prepend=0)
        return np.tile(
            np.repeat([value(part) for part in parts], counts), self._problem.kept_periods
        )
