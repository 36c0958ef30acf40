"""Integration of one run in the six coordinates: the solver for every problem.

Taylor series of high order (`series`) in steps that end exactly at every jump of the laws
(`kernel`). It serves the problems that the reduced system leaves out (run-out, profile deviation,
truncated Fourier stiffness), and checks the others.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numba import njit

from gearmesh.errors import NoOrbit
from gearmesh.model.contact import CONTACT_LOSS, dynamic_force
from gearmesh.model.motion import ROTATION_2, ROTATION_3, Y_2, Y_3, start
from gearmesh.model.problem import Branches, Problem, State
from gearmesh.model.segments import segments
from gearmesh.model.speeds import time_of
from gearmesh.solvers import limits
from gearmesh.solvers.compilation import persistent
from gearmesh.solvers.full import kernel
from gearmesh.solvers.full.coordinates import embedding, kinds_of_period, projected, signs_act
from gearmesh.solvers.full.measures import SAMPLE, SUMMARY, Step
from gearmesh.solvers.full.recurrences import raise_failures, recurrences
from gearmesh.solvers.full.roots import MAX_DEGREE, TABLE_ROWS, WIDTH
from gearmesh.solvers.full.series import CASE, CONTINUED, MODE, SEGMENT
from gearmesh.solvers.full.tape import GAP, Y
from gearmesh.solvers.response import (
    EXTREMUM,
    LOOSENING,
    OK,
    STATUSES,
    Companion,
    Response,
    Samples,
    assemble,
)

_EXTREMA_PER_PERIOD = 64
# Steps between two returns to Python, where an interruption is noticed: some 0.1 s.
_MOST_TURNS = 10_000


def _build_runs(key: str, cache: bool) -> Callable[..., int]:
    """Return the compiled function that integrates several runs, one after the other.

    It begins with run number `first` and returns the number of the first run that is not finished.
    Its other arguments are those of `kernel.run`: those that all runs share, and arrays with a row
    for each run.
    """

    @njit(cache=cache, nogil=True)
    def compiled(stated, runs, first, per_period, most_turns, workspace):  # type: ignore[no-untyped-def]
        key  # noqa: B018 (see persistent)
        states, modes, strobes, extrema, samples, summaries = runs
        turns = 0
        for i in range(first, len(states)):
            begun = summaries[i].steps
            over = kernel.run(
                *stated,
                states[i],
                modes[i : i + 1],
                strobes[i],
                extrema[i],
                samples[i],
                per_period,
                summaries[i : i + 1],
                most_turns - turns,
                workspace,
            )
            if not over:
                return i
            turns += summaries[i].steps - begun
        return len(states)

    return compiled


_compiled_runs = persistent(_build_runs)


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
        Degree of the Taylor polynomials, 4 to 28; by default the one that suits the tolerance.
    estimate_errors : bool
        Whether the run has a companion, `LOOSENING` times less accurate and displaced by the
        tolerance at the start, whose difference gives `Response.y_max_error`, `y_min_error` and
        `sensitive`.

    Returns
    -------
    Response
        A run that fails has a status other than ``"ok"``.
    """
    runs = Runs(problem, samples_per_period > 0)
    companion = None
    if estimate_errors:
        runs.integrate(tolerance * LOOSENING, order, displacement=tolerance)
        companion = Companion(runs.summaries[0], runs.strobes[0])
    room = _EXTREMA_PER_PERIOD * problem.kept_periods
    runs.integrate(tolerance, order, samples_per_period, room)
    found = runs.summaries[0]["extrema"]
    if found > room:
        runs.integrate(tolerance, order, samples_per_period, found)
    summary = runs.summaries[0]
    return assemble(
        problem,
        summary,
        runs.strobes[0],
        runs.extrema[0, :found],
        runs.final_state(),
        companion,
        tolerance,
        _samples(runs.samples[0], summary["extremes"]) if samples_per_period else None,
        runs.rotation_drift(),
        float(summary["least_contact_force"]),
    )


def steps_of(problem: Problem, tolerance: float) -> Iterator[Step]:
    """Yield the steps of a run; they end early if it cannot be integrated."""
    return Runs(problem, False).steps(tolerance)


class Runs:
    """Runs of a problem that can be integrated several times, with any tolerance.

    There is one run from the problem's own initial state, or one from each of `starts`, of shape
    (m, 12). Each mesh period is cut off after a `share` of it. `part` says between which mesh
    periods the runs are integrated: by default over all.
    """

    def __init__(self, problem: Problem, sampled: bool, share: float = 1.0) -> None:
        self.problem = problem
        self.embedding = embedding(problem, sampled)
        kinds, variants = kinds_of_period(problem)
        found = recurrences(problem, kinds, sampled)
        self._case = _case(problem, self.embedding.shape[1])
        self._stated = (
            self._case,
            _segments(problem, share),
            variants,
            (found.numbers, found.branches),
        )
        self._series = np.zeros((found.height + TABLE_ROWS + 1, WIDTH))
        self._mode = _mode(problem)
        self.starts = np.concatenate(start(problem))[None]
        self.part = 0, problem.periods

    def integrate(
        self,
        tolerance: float,
        order: int | None = None,
        samples_per_period: int = 0,
        room: int = 0,
        displacement: float = 0.0,
    ) -> None:
        """Integrate the runs from start to end.

        There is `room` for that many extrema of each; further ones are only counted.
        `displacement` displaces wheel 3 at the start.
        """
        self._begin(tolerance, order, samples_per_period, room, displacement)
        over = 0
        while over < len(self.starts):
            over = self._go_on(over, samples_per_period, _MOST_TURNS)

    def ends(
        self, starts: np.ndarray, tolerance: float, first: int = 0, last: int | None = None
    ) -> np.ndarray:
        """Return the coordinates and rates at the ends of runs, shape (m, 12).

        Parameters
        ----------
        starts : ndarray, shape (m, 12)
            The six coordinates at the start of each run, then their rates.
        tolerance : float
        first, last : int
            The runs start after `first` of the mesh periods and end after `last`; by default after
            all.

        Raises
        ------
        NoOrbit
            If one cannot be integrated.
        """
        self.starts = starts
        self.part = first, self.problem.periods if last is None else last
        self.integrate(tolerance)
        for status in self.summaries["status"]:
            if status != OK:
                reason = STATUSES[status]
                raise NoOrbit(f"the motion cannot be integrated over the period: {reason}")
        return self.all_six()

    def steps(self, tolerance: float) -> Iterator[Step]:
        """Integrate the first run, and yield its steps."""
        self._begin(tolerance, None, 0, 0, 0.0)
        mode, size = self.modes[0], int(self._case["order"][0]) + 1
        taken, reached = 0, 0.0
        while self._go_on(0, 0, 1) == 0:
            if self.summaries[0]["steps"] == taken:
                continue
            taken, start = int(self.summaries[0]["steps"]), reached
            reached = float(mode["period"] * self.problem.period + mode["time"])
            place = int(mode["period"]), int(mode["segment"])
            rows = (self._series[row, :size].copy() for row in (Y, GAP))
            yield Step(start, reached - start, *place, *rows)

    def _begin(
        self,
        tolerance: float,
        order: int | None,
        samples_per_period: int,
        room: int,
        displacement: float,
    ) -> None:
        m = len(self.starts)
        self._case["tolerance"] = tolerance
        self._case["order"] = order or suitable_order(tolerance)
        self.summaries = np.zeros(m, SUMMARY)
        self.summaries["y_max"], self.summaries["y_min"] = -np.inf, np.inf
        self.summaries["least_contact_force"] = np.inf
        self.summaries["extremes"] = np.inf, -np.inf
        starts = self.starts.copy()
        starts[:, ROTATION_3] += displacement
        self.states = projected(starts, self.embedding)
        self.modes = np.repeat(self._mode, m)
        self.modes["period"], self._case["periods"] = self.part
        self.strobes = np.zeros((m, self.problem.periods + 1, 2))
        self.extrema = np.zeros((m, room), EXTREMUM)
        self.samples = np.zeros((m, samples_per_period * self.problem.kept_periods), SAMPLE)

    def _go_on(self, first: int, samples_per_period: int, most_turns: int) -> int:
        """Continue the runs by some steps, and return how many of them are finished."""
        runs = self.states, self.modes, self.strobes, self.extrema, self.samples, self.summaries
        over = _compiled_runs(
            self._stated, runs, first, samples_per_period, most_turns, self._series
        )
        raise_failures()
        return over

    def final_state(self) -> State:
        """Return the state at the end of the first run."""
        problem, mode = self.problem, self.modes[0]
        six = self.all_six()[0]
        b, b_rate = (six[[Y_3, 6 + Y_3]] - six[[Y_2, 6 + Y_2]]).tolist()
        y, v = self.strobes[0, -1].tolist()
        branches = Branches(
            problem=replace(problem, initial_state=None),
            regime=int(mode["regime"]),
            direction=float(mode["direction"]),
            measured=problem.kept_revolutions > 0,
            signs=(float(mode["run_out_sign"]), float(mode["slip_sign"])),
            level=float(mode["level"]),
            exact=tuple(bool(mode[name]) for name in _EXACT),
            parted=bool(mode["parted"]),
        )
        periods = problem.start_period + problem.periods
        return State(y, v, b, b_rate, tuple(six.tolist()), periods, branches)

    def all_six(self) -> np.ndarray:
        """Return the six coordinates and rates of each run; those not integrated are 0."""
        n = self.embedding.shape[1]
        both = (self.states[:, i : i + n] @ self.embedding.T for i in (0, 6))
        return np.concatenate(list(both), axis=1)

    def rotation_drift(self) -> float:
        """Return how (phi_3 - phi_2)/2 changes over the first run; NaN if it is not integrated."""
        if self.embedding[ROTATION_3, 0] != 1.0:
            return np.nan
        gained = self.all_six()[0] - self.starts[0]
        wheel_3, wheel_2 = self.problem.both_wheels
        turned_3 = gained[ROTATION_3] / wheel_3.base_radius
        return 0.5 * float(turned_3 - gained[ROTATION_2] / wheel_2.base_radius)


_EXACT = ("turns", "on_level", "on_bracket", "released", "on_gap", "on_force")


def _mode(problem: Problem) -> np.ndarray:
    """Return the initial mode of a run, with the branches of the run that it continues."""
    mode = np.zeros(1, MODE)
    state = problem.initial_state
    branches = state.branches_for(problem) if state and state.coordinates else None
    if branches is not None:
        mode["stage"] = CONTINUED
        mode["regime"], mode["direction"] = branches.regime, branches.direction
        mode["run_out_sign"], mode["slip_sign"] = branches.signs
        mode["level"] = branches.level
        mode["parted"] = branches.parted
        for name, exact in zip(_EXACT, branches.exact, strict=True):
            mode[name] = exact
    return mode


def suitable_order(tolerance: float) -> int:
    """Return the degree of the series at which integration is cheapest for `tolerance`.

    Jorba and Zou's optimum is -ln(tolerance) / 2 + 1. Four more degrees cost little.
    """
    return min(MAX_DEGREE, max(8, math.ceil(5.0 - 0.5 * math.log(tolerance))))


def _case(problem: Problem, coordinates: int) -> np.ndarray:
    case = np.zeros(1, CASE)
    # Numbers that have the same name and meaning in both.
    for name in ("nu", "acceleration", "period", "initial_phase", "backlash"):
        case[name] = getattr(problem, name)
    for name in ("start_period", "periods"):
        case[name] = getattr(problem, name)
    case["varying_backlash"] = problem.terms.backlash_varies
    case["non_adhesive"] = problem.terms.non_adhesive
    case["single_pairs"] = problem.terms.pairs_touch_singly
    case["friction"] = problem.friction_coefficient
    case["follows_run_out"] = signs_act(problem)
    case["masses"] = [wheel.body_mass for wheel in problem.both_wheels]
    case["pulls"] = [
        (wheel.bearing_stiffness[1], wheel.bearing_damping[1]) for wheel in problem.both_wheels
    ]
    case["coordinates"] = coordinates
    case["acting"] = embedding(problem).shape[1]
    case["segments"] = len(segments(problem))
    case["first_kept"] = problem.periods - problem.kept_periods
    case["longest_step"] = limits.longest_step(problem)
    case["farthest"] = limits.farthest(problem)
    case["most_steps"] = limits.most_steps(problem)
    return case


def _segments(problem: Problem, share: float = 1.0) -> np.ndarray:
    """Return the segments in the first `share` of a mesh period, in the form the kernel takes.

    They have one row, or one for each mesh period if the speed changes.
    """
    parts = [part for part in segments(problem) if part.start < share]
    found = np.zeros((1 if problem.final_nu is None else problem.periods, len(parts)), SEGMENT)
    ends = np.array([min(part.end, share) for part in parts])
    found["gamma"] = [part.gamma for part in parts]
    found["pairs"] = [len(part.pairs) for part in parts]
    if problem.final_nu is None:
        found["end"] = ends * problem.period
        return found
    begins = np.arange(problem.periods)[:, None]
    found["end"] = time_of(problem, ends, before=begins)
    return found


def _samples(rows: np.ndarray, extremes: np.ndarray) -> Samples:
    columns = {name: rows[name].copy() for name in SAMPLE.fields or ()}
    regime = columns["regime"].astype(np.int8)
    return Samples(
        time=columns["time"],
        y=columns["y"],
        v=columns["v"],
        a=columns["a"],
        stiffness=columns["stiffness"],
        modified_stiffness=columns["stiffness"] * (regime != CONTACT_LOSS),
        force_dynamic=dynamic_force(columns["y"], columns["stiffness"]),
        force_normal=columns["normal"],
        force_friction=columns["friction"],
        force_bearing_3=columns["bearing_3"],
        force_bearing_2=columns["bearing_2"],
        force_bearing_3_z=columns["bearing_3_z"],
        force_bearing_2_z=columns["bearing_2_z"],
        transmission_error=columns["transmission_error"],
        regime=regime,
        extremes=extremes,
    )
