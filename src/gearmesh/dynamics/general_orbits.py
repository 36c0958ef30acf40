"""Periodic orbits of the general solver: unequal wheels, profile deviation, Fourier stiffness, ...

The state of an orbit holds the coordinates that the general solver integrates, and their rates. The
stroboscopic map is smooth in this state as long as the orbit does not graze, so differences of
sixth order between runs give its Jacobian: with steps of 1e-3 y_st both their truncation error and
the rounding error of the runs stay below 1e-8.
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain, pairwise

import numpy as np

from gearmesh.dynamics.orbits import LARGEST_RESIDUAL, TimeCourse, sorted_multipliers
from gearmesh.errors import NoOrbit
from gearmesh.model.contact import regime_of
from gearmesh.model.motion import Y_2, Y_3, relative_motion, start
from gearmesh.model.problem import Problem, State
from gearmesh.solvers.full.coordinates import embedding, projected
from gearmesh.solvers.full.runs import integrate
from gearmesh.solvers.response import Response

_TOLERANCE = 1e-14
_DIFFERENCE = 1e-3
_WEIGHTS = {1: 45.0 / 60.0, 2: -9.0 / 60.0, 3: 1.0 / 60.0}
_MOST_CORRECTIONS = 30
_SHORTEST_CORRECTION = 1.0 / 64.0
_TRANSIENT = 1000  # mesh periods after which the end of a run serves as an initial state
_SAME = 1e-8
_LEAST_GROWTH = 1e-7


@dataclass(frozen=True)
class GeneralOrbit:
    """A periodic orbit of the general solver, with the names of `gearmesh.dynamics.orbits.Orbit`.

    Attributes
    ----------
    problem : Problem
    periods : int
        The least period n, in mesh periods.
    state : ndarray, shape (m,)
        Coordinates of `gearmesh.solvers.full.coordinates` and their rates at the initial phase.
    jacobian : ndarray, shape (m, m)
        Of the map over the period.
    response : Response
        The motion over the period.
    end : ndarray, shape (m,)
    """

    problem: Problem
    periods: int
    state: np.ndarray
    jacobian: np.ndarray = field(repr=False)
    response: Response = field(repr=False)
    end: np.ndarray = field(repr=False)

    @property
    def y(self) -> float:
        """Relative motion y at the initial phase."""
        return float(self.response.strobe_y[0])

    @property
    def v(self) -> float:
        """Velocity y' at the initial phase."""
        return float(self.response.strobe_v[0])

    @property
    def y_max(self) -> float:
        """Greatest y."""
        return self.response.y_max

    @property
    def y_min(self) -> float:
        """Least y."""
        return self.response.y_min

    @property
    def residual(self) -> float:
        """|P^n(x) - x|."""
        return float(np.abs(self.end - self.state).max())

    @cached_property
    def multipliers(self) -> np.ndarray:
        """Floquet multipliers, complex array of shape (m,), the largest modulus first."""
        return sorted_multipliers(np.linalg.eigvals(self.jacobian))

    @property
    def multiplier_error(self) -> float:
        """Change of the multipliers with differences of a quarter of the step."""
        finer = _jacobian(self.problem, self.state, self.periods, 0.25 * _DIFFERENCE)
        others = np.linalg.eigvals(finer)
        return max(float(np.abs(others - one).min()) for one in self.multipliers)

    @property
    def neutral(self) -> bool:
        """Whether no damping of the mesh acts along the orbit and nothing grows."""
        lost = self.response.contact_loss_fraction
        damped = (lost > 0.0 and any(self.problem.lubricant)) or (
            lost < 1.0 and any(self.problem.material)
        )
        return not damped and abs(self.multipliers[0]) < 1.0 + _LEAST_GROWTH

    @property
    def stable(self) -> bool:
        """Whether all multipliers are inside the unit circle and the orbit is not neutral."""
        return not self.neutral and bool(abs(self.multipliers[0]) < 1.0)

    @cached_property
    def signature(self) -> tuple[int, ...]:
        """Regimes in their order over the orbit's own period, as of `Orbit.signature`.

        Between two extrema y is monotone, so the extrema tell all regimes.
        """
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
        found = _run(self.problem, self.state, self.periods, samples_per_period).samples
        if found is None:
            raise NoOrbit("the motion of the orbit cannot be integrated")
        return TimeCourse(found.time, found.y, found.v, found.a, found.regime)


def repeats_after(problem: Problem) -> int | None:
    """Return after how many mesh periods the excitation repeats; None if it need not.

    It need not with run-out, which follows the angles of the shafts that nothing holds, nor with
    damping of the rotations to the frame.
    """
    terms = problem.terms
    if problem.has_run_out or any(terms.torsional_damping):
        return None
    harmonics = (*terms.torque_harmonics_3, *terms.torque_harmonics_2, *terms.backlash_harmonics)
    of_teeth = terms.tooth_factors or terms.pitch_errors_3 or terms.pitch_errors_2
    if not of_teeth and all(float(one.order).is_integer() for one in harmonics):
        return 1
    wheel_3, wheel_2 = problem.both_wheels
    common = math.lcm(wheel_3.teeth, wheel_2.teeth)
    whole = all(abs(one.order * common - round(one.order * common)) < _SAME for one in harmonics)
    return common if whole else None


def find_orbit(problem: Problem, periods: int = 1) -> GeneralOrbit:
    """Return an orbit of least period `periods` near the initial state of the problem.

    If the problem has none, the search begins at the end of a long run from rest.

    Raises
    ------
    NoOrbit
        If there is none, or if the excitation does not repeat.
    """
    common = repeats_after(problem)
    if common is None:
        raise NoOrbit(
            "orbits: run-out and torsional damping are not covered: nothing holds the shafts"
        )
    if periods % common:
        raise NoOrbit(
            f"the excitation repeats after {common} mesh periods; periods has to be a multiple"
        )
    return _correct(problem, _start(problem), periods)


def _start(problem: Problem) -> np.ndarray:
    """Return the initial state if it is given, else the end of a long run from rest."""
    state = _reduced(problem, np.concatenate(start(problem)))
    return _ends(problem, state, _TRANSIENT) if problem.initial_state is None else state


def _correct(problem: Problem, state: np.ndarray, periods: int) -> GeneralOrbit:
    """Return the orbit to which Newton's method leads."""
    end = _ends(problem, state, periods)
    for _ in range(_MOST_CORRECTIONS):
        defect = float(np.abs(end - state).max())
        jacobian = _jacobian(problem, state, periods)
        matrix = jacobian - np.eye(len(state))
        correction = np.linalg.lstsq(matrix, state - end, rcond=1e-14)[0]
        share = 1.0
        shortest = 1.0 if defect < LARGEST_RESIDUAL else _SHORTEST_CORRECTION
        while share >= shortest:
            candidate = state + share * correction
            reached = _ends(problem, candidate, periods)
            if np.abs(reached - candidate).max() < (1.0 - 0.1 * share) * defect:
                break
            share *= 0.5
        else:
            break
        state, end = candidate, reached
    if not np.abs(end - state).max() < LARGEST_RESIDUAL:
        raise NoOrbit(f"Newton's method stops at a residual of {np.abs(end - state).max():.1e}")
    for shorter in range(1, periods):
        if periods % shorter == 0 and np.abs(_ends(problem, state, shorter) - state).max() < _SAME:
            raise NoOrbit(f"Newton's method leads to an orbit of period {shorter}")
    response = _run(problem, state, periods, 1)
    return GeneralOrbit(problem, periods, state, jacobian, response, end)


def _jacobian(
    problem: Problem, state: np.ndarray, periods: int, step: float = _DIFFERENCE
) -> np.ndarray:
    """Return the Jacobian of the map over mesh periods by differences of sixth order."""
    columns = []
    for direction in np.eye(len(state)):
        column = np.zeros(len(state))
        for steps, weight in _WEIGHTS.items():
            away = steps * step * direction
            ahead, behind = (_ends(problem, state + one, periods) for one in (away, -away))
            column += weight / step * (ahead - behind)
        columns.append(column)
    return np.array(columns).T


def _ends(problem: Problem, state: np.ndarray, periods: int) -> np.ndarray:
    """Return the state after mesh periods."""
    final = _run(problem, state, periods, 0).final_state
    if final is None or final.coordinates is None:
        raise NoOrbit("the motion cannot be integrated over the period")
    return _reduced(problem, np.array(final.coordinates))


def _reduced(problem: Problem, six: np.ndarray) -> np.ndarray:
    """Return the coordinates and rates that are integrated."""
    columns = embedding(problem)
    n = columns.shape[1]
    found = projected(six, columns)
    return np.concatenate([found[:n], found[6 : 6 + n]])


def state_of(problem: Problem, state: np.ndarray) -> State:
    """Return the state of an orbit as a run starts from it."""
    columns = embedding(problem)
    n = columns.shape[1]
    q, v = columns @ state[:n], columns @ state[n:]
    bare = replace(problem, initial_state=None)
    y, rate = relative_motion(bare, bare.start_time, q, v)
    both = (*q.tolist(), *v.tolist())
    return State(y, rate, q[Y_3] - q[Y_2], v[Y_3] - v[Y_2], coordinates=both)


def _run(problem: Problem, state: np.ndarray, periods: int, samples_per_period: int) -> Response:
    """Integrate whole mesh periods; they are kept if samples are wanted."""
    # A run takes whole revolutions: with a "revolution" of one period it takes any number of
    # mesh periods. The wheels keep their teeth.
    run = replace(
        problem,
        wheels=problem.both_wheels,
        teeth=1,
        revolutions=periods,
        kept_revolutions=periods if samples_per_period else 0,
        initial_state=state_of(problem, state),
    )
    return integrate(run, _TOLERANCE, samples_per_period, estimate_errors=False)
