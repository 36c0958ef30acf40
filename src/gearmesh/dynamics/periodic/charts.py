"""Unknowns of the orbits of the general solver, and the treatment of the mean rotation.

The mean rotation (phi_3 - phi_2) / 2 is measured relative to the stated speeds. It turns both
wheels together and leaves the mesh unchanged. There are three cases.

- `ABSENT`: without run-out and without damping to the frame, no force on the mesh depends on it.
- `FREE`: torsional damping acts on its rate, but nothing depends on its angle. It drifts at a rate
  that repeats in every period. An orbit closes in everything but this angle.
- `HELD`: run-out depends on its angle, and friction and damping change its rate, because the
  static moments balance each other and nothing else acts on it. So the stated equations have no
  orbit: the wheels leave the stated speed. A drive that holds the speed exerts constant moments on
  both wheels which balance friction and damping. They accelerate the mean rotation alone and do not
  load the mesh, so an orbit tends to that without run-out as the run-out vanishes. They are
  unknowns of an orbit, and the angle at the initial phase is given in their place.
"""

from dataclasses import dataclass, replace

import numpy as np

from gearmesh.model.functions import Harmonic
from gearmesh.model.motion import ROTATION_2, ROTATION_3, Y_2, Y_3, relative_motion
from gearmesh.model.problem import Problem, State
from gearmesh.solvers.full.coordinates import embedding, projected

ABSENT, FREE, HELD = "absent", "free", "held"


@dataclass(frozen=True)
class Chart:
    """The coordinates of a problem whose orbits are sought.

    A motion is at a place, of shape (2 n,): n coordinates and their rates. If the mean rotation is
    not absent, it is the first coordinate, in y_st on the base circles. The unknowns of an orbit
    are the numbers of this place, without the angle of the mean rotation where it is free. Where it
    is held, the first unknown is the acceleration of this coordinate by the holding moments, times
    the square of the period.

    Attributes
    ----------
    columns : ndarray, shape (6, n)
        The six coordinates of the model as sums of the coordinates.
    rotation : str
        `ABSENT`, `FREE` or `HELD`.
    """

    columns: np.ndarray
    rotation: str

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return self.columns.shape[1]

    @property
    def kept(self) -> np.ndarray:
        """Indices of those numbers of a place that multipliers describe."""
        left_out = {ABSENT: [], FREE: [0], HELD: [0, self.n]}[self.rotation]
        return np.delete(np.arange(2 * self.n), left_out)

    def place_of_six(self, six: np.ndarray) -> np.ndarray:
        """Return the place of a motion in the six coordinates and their rates.

        Places and coordinates may have further axes in front.
        """
        found = projected(six, self.columns)
        return np.concatenate([found[..., : self.n], found[..., 6 : 6 + self.n]], axis=-1)

    def six(self, place: np.ndarray) -> np.ndarray:
        """Return the six coordinates and their rates at a place."""
        both = place[..., : self.n], place[..., self.n :]
        return np.concatenate([part @ self.columns.T for part in both], axis=-1)

    def place(self, unknowns: np.ndarray, angle: float) -> np.ndarray:
        """Return the place that unknowns of an orbit state; `angle` is that of mean rotation."""
        if self.rotation == ABSENT:
            return unknowns
        return np.append(angle, unknowns if self.rotation == FREE else unknowns[1:])

    def unknowns(self, place: np.ndarray, held: float = 0.0) -> np.ndarray:
        """Return the unknowns of an orbit at a place; `held` is the first one where it is held."""
        if self.rotation == HELD:
            return np.append(held, place[1:])
        return place[1:] if self.rotation == FREE else place

    def rescaled(self, unknowns: np.ndarray, periods: int, others: int) -> np.ndarray:
        """Return the unknowns of a motion over `others` instead of `periods` mesh periods."""
        if self.rotation != HELD:
            return unknowns
        return np.append(unknowns[0] * (others / periods) ** 2, unknowns[1:])

    def closing(self, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Return by how much a motion between two places fails to close."""
        return (end - start)[1:] if self.rotation == FREE else end - start

    def carried_on(
        self, start: np.ndarray, end: np.ndarray, held: float, duration: float
    ) -> np.ndarray:
        """Return the unknowns with which a motion goes on after the time `duration`.

        If the mean rotation is held, a drive corrects its angle, its rate and the holding moments.
        """
        if self.rotation != HELD:
            return self.unknowns(end)
        gained, sped = (end - start)[[0, self.n]].tolist()
        place = end.copy()
        place[self.n] = start[self.n] - gained / duration + 0.5 * sped
        return self.unknowns(place, held - sped * duration)

    def monodromy(self, jacobian: np.ndarray) -> np.ndarray:
        """Return the Jacobian of places without the rows and columns of the mean rotation."""
        return jacobian[np.ix_(self.kept, self.kept)]

    def moments(self, problem: Problem, unknowns: np.ndarray, periods: int) -> tuple[float, float]:
        """Return the holding moments on wheels 3 and 2 over R_bi, in F_st."""
        if self.rotation != HELD:
            return 0.0, 0.0
        # (phi_3 - phi_2) R_b / 2 counts half in each rotation.
        acceleration = 0.5 * float(unknowns[0]) / (periods * problem.period) ** 2
        wheel_3, wheel_2 = problem.both_wheels
        return wheel_3.inertia * acceleration, -wheel_2.inertia * acceleration


def chart_of(problem: Problem) -> Chart:
    """Return the chart of a problem."""
    columns = embedding(problem)
    if columns[ROTATION_2, 0] != 0.0:
        return Chart(columns, ABSENT)
    columns[[ROTATION_3, ROTATION_2], :2] = [[0.5, 0.5], [-0.5, 0.5]]
    if problem.has_run_out:
        return Chart(columns, HELD)
    if any(problem.terms.torsional_damping):
        return Chart(columns, FREE)
    return Chart(columns[:, 1:], ABSENT)


def with_moments(problem: Problem, moments: tuple[float, float]) -> Problem:
    """Return the problem with additional constant moments on wheels 3 and 2."""
    if not any(moments):
        return problem
    terms = problem.terms
    terms = replace(
        terms,
        torque_harmonics_3=(*terms.torque_harmonics_3, Harmonic(0.0, moments[0], 0.0)),
        torque_harmonics_2=(*terms.torque_harmonics_2, Harmonic(0.0, moments[1], 0.0)),
    )
    return replace(problem, terms=terms)


def state_at_place(problem: Problem, place: np.ndarray) -> State:
    """Return the state of a run at a place, when t = 0 at mesh phase 0."""
    six = chart_of(problem).six(place)
    q, v = six[:6], six[6:]
    bare = replace(problem, initial_state=None)
    y, rate = relative_motion(bare, bare.start_time, q, v)
    return State(y, rate, q[Y_3] - q[Y_2], v[Y_3] - v[Y_2], coordinates=tuple(six.tolist()))
