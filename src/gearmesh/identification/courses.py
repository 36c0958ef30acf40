"""Responses of one sample against nu_s: separate runs, or sweeps up or down.

The ledger's own searches (`gearmesh.paper.thresholds`) run on these courses. They look less
closely at first than for the study itself, and narrow what they find to ± 0.001; where a coarse
look is enough depends on the variant. All first looks of many samples are run in one go, sweeps
step by step, so that the solver's lanes are never empty.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from gearmesh.identification.design import Sample, parameters_of
from gearmesh.model.motion import state_at
from gearmesh.model.problem import Problem, State
from gearmesh.paper.thresholds import FIRST, LAST, LOOPS_FROM, Courses
from gearmesh.solvers.response import Response
from gearmesh.solvers.simulation import simulate
from gearmesh.study.parameters import Parameters

ACCURACY = 1e-3
"""Thresholds in nu_s are located to this."""

# A ninth of the first decides between jump and slope (`gearmesh.paper.thresholds.JUMP_WIDTH`),
# ninths of the others locate to `ACCURACY`: one refinement, eight runs, is enough.
_FINE, _MEDIUM, _COARSE, _COARSEST = 0.004, 0.01, 0.015, 0.02
_JUMPS_UP_TO = 0.92


def first_look(name: str) -> np.ndarray:
    """Return the tunings at which a variant is looked at first, ascending.

    Damping in the lubricant alone leaves jumps and long transients: they need a close look. With
    linear damping in the material there are jumps too, but wide apart. All other courses are
    smooth; the loops of c-material are followed down to `LOOPS_FROM`.
    """
    if name.endswith("lubricant"):
        return np.concatenate(
            [_places(FIRST, _JUMPS_UP_TO, _FINE), _places(_JUMPS_UP_TO, LAST, _MEDIUM)[1:]]
        )
    if name.startswith("b-"):
        return _places(FIRST, LAST, _MEDIUM)
    smooth = _places(FIRST, LAST, _COARSE)
    if not name.startswith("c-material"):
        return smooth
    return np.concatenate([_places(LOOPS_FROM, FIRST, _COARSEST)[:-1], smooth])


def _places(low: float, high: float, spacing: float) -> np.ndarray:
    return np.round(np.linspace(low, high, round((high - low) / spacing) + 1), 10)


class SampledCourses(Courses):
    """The courses of one variant of a sample.

    Parameters
    ----------
    sample : Sample
        Values of the open parameters.
    study : Parameters
        All others.
    name : str
        Name of the variant.
    """

    width = 2.0 * ACCURACY
    steepest = 1

    def __init__(self, sample: Sample, study: Parameters, name: str) -> None:
        super().__init__(parameters_of(sample, study), name)
        # All but the tuning and the start; to state a run anew each time would cost as much as it.
        self._stated = self._parameters.problem(self._variant, FIRST)
        self._kind = sample["kind"]
        velocity = float(sample["initial_velocity"])
        self._start = state_at(self._stated, v=velocity) if velocity else None
        self.grid = first_look(name)
        if self._kind == "down":
            self.grid = self.grid[::-1]

    @property
    def swept(self) -> bool:
        """Whether each tuning starts from the end of its neighbour's run."""
        return self._kind != "separate"

    def scan(self, low: float, high: float) -> np.ndarray:
        """Return the two ends and the places of the first look between them."""
        if high < low:
            return np.empty(0)
        inside = self.grid[(self.grid > low) & (self.grid < high)]
        return np.unique(np.concatenate([[low], inside, [high]]))

    def at(self, nu: Iterable[float]) -> list[Response]:
        """Return the responses at tunings nu_s, in their order."""
        wanted = [float(x) for x in nu]
        new = [x for x in dict.fromkeys(wanted) if x not in self._known]
        problems = [self.problem(x) for x in new]
        self.learn(new, simulate(problems, self.tolerance, estimate_errors=False))
        return [self._known[x] for x in wanted]

    def learn(self, nu: Iterable[float], responses: Iterable[Response]) -> None:
        """Take responses in."""
        self._known.update(zip(map(float, nu), responses, strict=True))

    @property
    def tolerance(self) -> float:
        """Tolerance of the runs."""
        return self._parameters.solver.tolerance

    def problem(self, nu: float) -> Problem:
        """State the run at one tuning, which in a sweep starts where its neighbour has ended."""
        start = self._neighbours_end(nu) if self.swept else None
        return replace(self._stated, nu=nu, initial_state=start or self._start)

    def _neighbours_end(self, nu: float) -> State | None:
        """Return the state at the end of the run before `nu` in the sweep, if there is one."""
        passed = self.grid < nu if self._kind == "up" else self.grid > nu
        known = self._known.get(float(self.grid[passed][-1])) if passed.any() else None
        if known is None or known.final_state is None:
            return None
        end = known.final_state
        # Rounded as in the runs from which config/identified.yaml was found.
        return replace(
            end, y=(end.y - end.b) + end.b, v=(end.v - end.b_rate) + end.b_rate, periods=0
        )

    def time_course(self, nu: float) -> Response:
        """Return the response at a tuning with its samples."""
        per_period = self._parameters.run.samples_per_period
        return simulate([self.problem(nu)], self.tolerance, per_period, estimate_errors=False)[0]


def look(courses: Sequence[SampledCourses]) -> None:
    """Run the first look of all `courses`: separate runs at once, sweeps side by side."""
    separate = [(c, float(nu)) for c in courses if not c.swept for nu in c.grid]
    _run(separate)
    sweeps = [c for c in courses if c.swept]
    for step in range(max((c.grid.size for c in sweeps), default=0)):
        _run([(c, float(c.grid[step])) for c in sweeps if step < c.grid.size])


def _run(wanted: Sequence[tuple[SampledCourses, float]]) -> None:
    if not wanted:
        return
    problems = [courses.problem(nu) for courses, nu in wanted]
    found = simulate(problems, wanted[0][0].tolerance, estimate_errors=False)
    for (courses, nu), response in zip(wanted, found, strict=True):
        courses.learn([nu], [response])
