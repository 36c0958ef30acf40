"""Periodic orbits of the general solver: unequal wheels, run-out, profile deviation, ...

The numbers in which an orbit is sought are those of `charts`, which states what an orbit is if the
mean rotation drifts. The map over the period is smooth in them as long as the orbit does not graze,
so differences of sixth order between runs give its Jacobian: with steps of 1e-3 y_st both their
truncation error and the rounding error of the runs stay below 1e-8. Close to a grazing, or where
friction begins to stick, steps are smaller and the rounding error is larger.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import chain, pairwise

import numpy as np

from gearmesh.dynamics.periodic.charts import (
    HELD,
    Chart,
    chart_of,
    state_at_place,
    with_moments,
)
from gearmesh.dynamics.periodic.differences import LARGEST_STEP, jacobian
from gearmesh.dynamics.periodic.general_events import gap_extrema, stiffness_jumps
from gearmesh.dynamics.periodic.orbits import TimeCourse, judged, sorted_multipliers
from gearmesh.errors import NoOrbit
from gearmesh.model.contact import regime_of
from gearmesh.model.problem import Problem, State
from gearmesh.solvers.full.measures import Step
from gearmesh.solvers.full.runs import Runs, integrate, steps_of
from gearmesh.solvers.response import Response

_TOLERANCE = 1e-14
SAME = 1e-8
"""Distance between states that count as the same, and between numbers that count as whole."""

_RESOLVED = 1e-4  # least multiplier that differences over the whole period resolve to 1e-4


@dataclass(frozen=True)
class GeneralOrbit:
    """A periodic orbit of the general solver, with the names of `orbits.Orbit`.

    Attributes
    ----------
    problem : Problem
        The gear pair as stated, without the moments that hold its mean rotation.
    periods : int
        The least period n, in mesh periods.
    state : ndarray, shape (k,)
        The unknowns of `charts.Chart` at the initial phase.
    angle : float
        The mean rotation at the initial phase, in y_st on the base circles.
    end : ndarray, shape (2 n,)
        Coordinates and rates after the period.
    """

    problem: Problem
    periods: int
    state: np.ndarray
    angle: float
    end: np.ndarray = field(repr=False)

    @cached_property
    def chart(self) -> Chart:
        """The coordinates."""
        return chart_of(self.problem)

    @property
    def start(self) -> np.ndarray:
        """Coordinates and rates at the initial phase, shape (2 n,)."""
        return self.chart.place(self.state, self.angle)

    @property
    def holding_moments(self) -> tuple[float, float]:
        """Constant moments on wheels 3 and 2 over R_bi, in F_st, that hold the mean rotation."""
        return self.chart.moments(self.problem, self.state, self.periods)

    @property
    def held(self) -> Problem:
        """The gear pair under the holding moments, whose runs from `initial_state` repeat."""
        return with_moments(self.problem, self.holding_moments)

    @property
    def initial_state(self) -> State:
        """The state as a run starts from it, with the shafts at their angles of t = 0."""
        return state_at_place(self.problem, self.start)

    @property
    def repeats_after(self) -> int:
        """Mesh periods after which the excitation repeats."""
        return common_period(self.problem)

    @cached_property
    def response(self) -> Response:
        """The motion over the period."""
        return self._response(1)

    def _response(self, samples_per_period: int) -> Response:
        return run_of(self.held, self.initial_state, self.periods, samples_per_period)

    @property
    def period(self) -> float:
        """Mesh period T in tau_s."""
        return self.problem.period

    @property
    def backlash(self) -> float:
        """Constant part of the backlash, s / y_st."""
        return self.problem.backlash

    @property
    def y(self) -> float:
        """Relative motion y at the initial phase."""
        return float(self.response.strobe_y[0])

    @property
    def v(self) -> float:
        """Velocity y' at the initial phase."""
        return float(self.response.strobe_v[0])

    @property
    def strobes(self) -> np.ndarray:
        """Stroboscopic points: y and y' at the start of each mesh period, shape (periods, 2)."""
        return np.column_stack([self.response.strobe_y, self.response.strobe_v])[:-1]

    @property
    def y_max(self) -> float:
        """Greatest y."""
        return self.response.y_max

    @property
    def y_min(self) -> float:
        """Least y."""
        return self.response.y_min

    @property
    def extrema(self) -> np.ndarray:
        """Extrema of y over the orbit's own period, shape (n, 3): time, y, kind (1 or -1)."""
        found = self.response
        return np.column_stack([found.extremum_time, found.extremum_y, found.extremum_kind])

    @cached_property
    def gap_extrema(self) -> np.ndarray:
        """Extrema of y + s(t) over the orbit's own period, shape (n, 3) as of `extrema`."""
        if self.problem.terms.backlash_varies:
            return gap_extrema(self._steps)
        return self.extrema + np.array([0.0, self.problem.backlash, 0.0])

    @cached_property
    def stiffness_jumps(self) -> np.ndarray:
        """The events at which C(t) jumps."""
        return stiffness_jumps(self._run, self._steps)

    @property
    def _run(self) -> Problem:
        return self.held.over_periods(self.periods, 0, self.initial_state)

    @cached_property
    def _steps(self) -> list[Step]:
        return list(steps_of(self._run, _TOLERANCE))

    @property
    def defect(self) -> np.ndarray:
        """By how much the motion fails to close, shape (k,)."""
        return self.chart.closing(self.start, self.end)

    @property
    def residual(self) -> float:
        """|P^n(x) - x|."""
        return float(np.abs(self.defect).max())

    @cached_property
    def jacobian(self) -> np.ndarray:
        """Jacobian of the coordinates and rates over the period, shape (2 n, 2 n)."""
        return self._jacobian(LARGEST_STEP)

    @cached_property
    def gradient(self) -> np.ndarray:
        """Jacobian of the defect in the state, shape (k, k)."""
        if self.chart.rotation == HELD:
            # Newton's method and tangents need the effect of the moments to a few digits only.
            away = LARGEST_STEP * np.eye(self.state.size)[0]
            ahead, behind = (
                self.shot(self.problem, self.state + one, self.periods).end for one in (away, -away)
            )
            pushed = (ahead - behind) / (2.0 * LARGEST_STEP)
            others = self.jacobian[:, 1:] - np.eye(self.end.size)[:, 1:]
            return np.column_stack([pushed, others])
        return self.monodromy - np.eye(self.state.size)

    @property
    def stretched(self) -> None:
        """Not known: differences replace it."""
        return None

    @property
    def monodromy(self) -> np.ndarray:
        """Jacobian over the period with the mean rotation left out."""
        return self.chart.monodromy(self.jacobian)

    @cached_property
    def multipliers(self) -> np.ndarray:
        """Floquet multipliers, a complex array, the largest modulus first."""
        return sorted_multipliers(np.linalg.eigvals(self.monodromy))

    @property
    def multiplier_error(self) -> float:
        """Change of the multipliers with differences of a quarter of the largest step."""
        finer = self.chart.monodromy(self._jacobian(0.25 * LARGEST_STEP))
        others = np.linalg.eigvals(finer)
        return max(float(np.abs(others - one).min()) for one in self.multipliers)

    @cached_property
    def growth(self) -> float:
        """Logarithm of the greatest growth of a deviation in a mesh period.

        Small multipliers of long periods come from the factors, each of which has its own error.
        """
        largest, lost = float(abs(self.multipliers[0])), 0.0
        if largest < _RESOLVED:
            whole = np.eye(len(self.monodromy))
            for factor in self.factors:
                whole = factor @ whole
                size = float(np.abs(whole).max())
                whole, lost = whole / size, lost + math.log(size)
            largest = float(np.abs(np.linalg.eigvals(whole)).max())
        return (math.log(largest) + lost) / self.periods

    @property
    def factors(self) -> list[np.ndarray]:
        """Jacobians of the mesh periods; `monodromy` is the product of them, the last one first.

        The first one leaves out the mean rotation at the start, and the last one that at the end.
        """
        found, place, motions = [], self.start, ends(self.held, self.periods)
        for n in range(self.periods):
            end = partial(motions, first=n, last=n + 1)
            found.append(jacobian(end, place))
            place = end(place[None])[0]
        kept = self.chart.kept
        found[0] = found[0][:, kept]
        found[-1] = found[-1][kept]
        return found

    def _jacobian(self, step: float) -> np.ndarray:
        return jacobian(ends(self.held, self.periods), self.start, step)

    @property
    def undamped(self) -> bool:
        """Whether no damping of the mesh or of the rotations acts along the orbit."""
        if any(self.problem.terms.torsional_damping):
            return False
        lost = self.response.contact_loss_fraction
        return not (
            (lost > 0.0 and any(self.problem.lubricant))
            or (lost < 1.0 and any(self.problem.material))
        )

    @property
    def neutral(self) -> bool:
        """Whether no damping of the mesh acts along the orbit and nothing grows."""
        return bool(judged(self.multipliers, self.undamped)[1])

    @property
    def stable(self) -> bool:
        """Whether all multipliers are inside the unit circle and the orbit is not neutral."""
        return bool(judged(self.multipliers, self.undamped)[0])

    @cached_property
    def signature(self) -> tuple[int, ...]:
        """Regimes in their order over the orbit's own period, as of `Orbit.signature`.

        Between two extrema y is monotone, so the extrema tell all regimes. Where the backlash
        varies, the regimes are those of the samples.
        """
        if self.problem.terms.backlash_varies:
            ends = self.time_course().regime.astype(int).tolist()
        else:
            ends = regime_of(self.response.extremum_y, self.problem.backlash).astype(int).tolist()
        if not ends:
            return (int(regime_of(self.y, self.problem.backlash)),)
        passed = [
            range(one, other, 1 if other > one else -1) for one, other in pairwise([*ends, ends[0]])
        ]
        sequence = tuple(chain.from_iterable(passed)) or (ends[0],)
        return max(sequence[i:] + sequence[:i] for i in range(len(sequence)))

    def time_course(self, samples_per_period: int = 256) -> TimeCourse:
        """Return the time course, with `samples_per_period` samples in a mesh period."""
        found = self._response(samples_per_period).samples
        if found is None:
            raise NoOrbit("the motion of the orbit cannot be integrated")
        return TimeCourse(found.time, found.y, found.v, found.a, found.regime)

    def shot(self, problem: Problem, state: np.ndarray, periods: int) -> "GeneralOrbit":
        """Return another motion, from `state` over mesh periods.

        Raises
        ------
        NoOrbit
            If the motion cannot be integrated.
        """
        if chart_of(problem).columns.shape != self.chart.columns.shape:
            raise NoOrbit("other coordinates are needed there: a term appears or vanishes")
        return shot_from(problem, state, periods, self.angle)

    def at_phase(self, phase: float) -> "GeneralOrbit":
        """Return the orbit with its state taken at another mesh phase."""
        if phase == self.problem.initial_phase:
            return self
        place = moved_to_phase(self.held, self.start, phase)
        state = self.chart.unknowns(place, float(self.state[0]))
        problem = replace(self.problem, initial_phase=phase)
        return shot_from(problem, state, self.periods, float(place[0]))


def common_period(problem: Problem) -> int:
    """Return after how many mesh periods the excitation repeats.

    Raises
    ------
    NoOrbit
        If it never does.
    """
    terms = problem.terms
    wheel_3, wheel_2 = problem.both_wheels
    both = math.lcm(wheel_3.teeth, wheel_2.teeth)
    harmonics = (*terms.torque_harmonics_3, *terms.torque_harmonics_2, *terms.backlash_harmonics)
    if any(abs(one.order * both - round(one.order * both)) > SAME for one in harmonics):
        raise NoOrbit("the excitation has frequencies of no common period with mesh and shafts")
    of_teeth = terms.tooth_factors or terms.pitch_errors_3 or terms.pitch_errors_2
    if of_teeth or not all(float(one.order).is_integer() for one in harmonics):
        return both
    return math.lcm(
        wheel_3.teeth if problem.eccentricity_3 else 1,
        wheel_2.teeth if problem.eccentricity_2 else 1,
    )


def shot_from(problem: Problem, state: np.ndarray, periods: int, angle: float) -> GeneralOrbit:
    """Return a motion from the unknowns of an orbit."""
    bare = replace(problem, initial_state=None)
    chart = chart_of(bare)
    held = with_moments(bare, chart.moments(bare, state, periods))
    end = end_of(held, periods, chart.place(state, angle))
    return GeneralOrbit(bare, periods, state, angle, end)


def ends(problem: Problem, periods: int, share: float = 1.0) -> Callable[..., np.ndarray]:
    """Return a function that maps places where motions start, shape (m, 2 n), to where they end.

    Its further arguments are `first` and `last` of `Runs.ends`.
    """
    chart = chart_of(problem)
    runs = Runs(problem.over_periods(periods, 0, None), False, share)
    return lambda places, **part: chart.place_of_six(
        runs.ends(chart.six(places), _TOLERANCE, **part)
    )


def end_of(problem: Problem, periods: int, place: np.ndarray) -> np.ndarray:
    """Return the place where the motion from one place ends."""
    found: np.ndarray = ends(problem, periods)(place[None])[0]
    return found


def moved_to_phase(problem: Problem, place: np.ndarray, phase: float) -> np.ndarray:
    """Return the place where a motion is at another mesh phase, with the shafts as at t = 0."""
    share = (phase - problem.initial_phase) % 1.0
    if share > 0.0:
        place = ends(problem, 1, share)(place[None])[0]
    common = common_period(problem)
    if phase < problem.initial_phase and common > 1:
        place = ends(replace(problem, initial_phase=phase), common)(place[None], first=1)[0]
    return place


def run_of(problem: Problem, begun: State, periods: int, samples_per_period: int) -> Response:
    """Integrate whole mesh periods; they are kept if samples are wanted."""
    run = problem.over_periods(periods, periods if samples_per_period else 0, begun)
    return integrate(run, _TOLERANCE, samples_per_period, estimate_errors=False)
