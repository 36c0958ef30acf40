"""Curves of orbits in state and parameter: corrector, tangent and steps by pseudo-arclength.

A family of problems depends on one parameter. Its period-n orbits are curves in the space of the
state and the parameter, smooth through grazings and folds, so a curve is followed by its
arclength and not by the parameter.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gearmesh.dynamics.orbits import LARGEST_RESIDUAL, Orbit
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.period_map import advance, passage

Family = Callable[[float], Problem]
"""The problem at a value of the parameter."""

_MOST_CORRECTIONS = 12
_DIFFERENCE = 1e-5
_SHORTEST_STEP = 1e-7
_PLACES = 64
_LEAST_ALIGNMENT = 0.97  # cosine of the angle between neighbouring tangents
_LARGEST_CORRECTION = 0.3  # of a step


@dataclass(frozen=True)
class Point:
    """A point of a curve of orbits.

    Attributes
    ----------
    place : ndarray, shape (5,)
        The state, and the parameter in units of the curve.
    value : float
        The parameter.
    tangent : ndarray, shape (5,)
        Unit tangent of the curve.
    determinant : float
        Determinant of the Jacobian of P^n(x) - x in state and parameter, bordered by the tangent.
    orbit : Orbit
    """

    place: np.ndarray
    value: float
    tangent: np.ndarray
    determinant: float
    orbit: Orbit

    def reversed(self) -> "Point":
        """Return the same point, seen in the other direction along the curve."""
        return replace(self, tangent=-self.tangent, determinant=-self.determinant)


@dataclass(frozen=True)
class Curve:
    """The curves of period-n orbits of a family.

    Attributes
    ----------
    family : callable
        The problem at a value of the parameter.
    periods : int
        n.
    unit : float
        Change of the parameter that counts like a change of 1 in the state.
    phase : float
        Mesh phase at which the state is taken. The state has a kink along the curve where it
        passes an end of a regime at this very phase, because damping jumps there.
    """

    family: Family
    periods: int
    unit: float
    phase: float

    def point(self, place: np.ndarray, normal: np.ndarray, along: np.ndarray) -> Point:
        """Return the point of the curve in the plane through `place` with the given normal.

        Parameters
        ----------
        place, normal : ndarray, shape (5,)
        along : ndarray, shape (5,)
            Direction that the tangent follows.

        Raises
        ------
        NoOrbit
            If Newton's method does not converge.
        """
        origin, best = place, np.inf
        orbit = self._orbit(place)
        sensitivity = self._sensitivity(place)
        for _ in range(_MOST_CORRECTIONS):
            if not orbit.residual < best:
                break
            best = orbit.residual
            found, found_orbit = place, orbit
            defect = np.append(orbit.passage.end - orbit.state, normal @ (place - origin))
            matrix = _bordered(orbit, sensitivity, normal)
            try:
                place = place - np.linalg.solve(matrix, defect)
            except np.linalg.LinAlgError as error:
                raise NoOrbit("the curve is singular here") from error
            orbit = self._orbit(place)
        if not best < LARGEST_RESIDUAL:
            raise NoOrbit(f"the corrector stops at a residual of {best:.1e}")
        sensitivity = self._sensitivity(found)
        tangent = np.linalg.svd(_bordered(found_orbit, sensitivity, normal)[:4])[2][-1]
        if tangent @ along < 0.0:
            tangent = -tangent
        determinant = float(np.linalg.det(_bordered(found_orbit, sensitivity, tangent)))
        return Point(found, self.unit * float(found[4]), tangent, determinant, found_orbit)

    def at(self, orbit: Orbit, value: float) -> Point:
        """Return the point near `orbit` at a value of the parameter, the tangent towards more."""
        up = np.append(np.zeros(4), 1.0)
        return self.point(np.append(orbit.state, value / self.unit), up, up)

    def moved_to(self, phase: float, point: Point) -> tuple["Curve", Point]:
        """Return the curve with its state taken at another phase, and a point on it."""
        other = replace(self, phase=phase)
        near = self.step(point, _DIFFERENCE)
        here, there = (at_phase(one.orbit, phase).state for one in (point, near))
        along = np.append((there - here) / _DIFFERENCE, point.tangent[4])
        along /= np.linalg.norm(along)
        return other, other.point(np.append(here, point.place[4]), along, along)

    def step(self, point: Point, length: float) -> Point:
        """Return the point one step ahead along the tangent."""
        return self.point(point.place + length * point.tangent, point.tangent, point.tangent)

    def step_on(self, point: Point, length: float) -> tuple[Point, float]:
        """Return the next point after `point` and the length of the step that reaches it.

        The step is at most `length`, and shorter where the curve bends.

        Raises
        ------
        NoOrbit
            If the curve cannot be followed further.
        """
        reason = "it bends too sharply"
        while length > _SHORTEST_STEP:
            try:
                following = self.step(point, length)
                moved = following.place - point.place - length * point.tangent
                straight = following.tangent @ point.tangent > _LEAST_ALIGNMENT
                if straight and np.linalg.norm(moved) < _LARGEST_CORRECTION * length:
                    return following, length
            except NoOrbit as error:
                reason = str(error)
            length *= 0.5
        raise NoOrbit(reason)

    def _orbit(self, place: np.ndarray) -> Orbit:
        problem = self._problem(place[4])
        moved = passage(problem, place[:4], self.periods)
        if moved.status != "complete":
            raise NoOrbit(f"the motion ends with {moved.status}")
        return Orbit(problem, self.periods, place[:4], moved)

    def _problem(self, coordinate: float) -> Problem:
        problem = self.family(self.unit * float(coordinate))
        return replace(problem, initial_phase=self.phase, initial_state=None)

    def _sensitivity(self, place: np.ndarray) -> np.ndarray:
        """Return the derivative of P^n with respect to the parameter, by differences.

        It decides the direction of Newton's steps and not where they end.
        """
        ends = []
        for side in (_DIFFERENCE, -_DIFFERENCE):
            problem = self._problem(place[4] + side)
            ends.append(passage(problem, place[:4], self.periods).end)
        return (ends[0] - ends[1]) / (2.0 * _DIFFERENCE)


def _bordered(orbit: Orbit, sensitivity: np.ndarray, border: np.ndarray) -> np.ndarray:
    rows = np.column_stack([orbit.passage.jacobian - np.eye(4), sensitivity])
    return np.vstack([rows, border])


def at_phase(orbit: Orbit, phase: float) -> Orbit:
    """Return an orbit with its state taken at another mesh phase."""
    share = (phase - orbit.problem.initial_phase) % 1.0
    state = advance(orbit.problem, orbit.state, share)
    problem = replace(orbit.problem, initial_phase=phase)
    return Orbit(problem, orbit.periods, state, passage(problem, state, orbit.periods))


def clear_phase(orbit: Orbit) -> float:
    """Return a mesh phase at which the orbit is far from the ends of its regimes.

    It is the phase of the orbit's state as long as this is half as far from them as it can be.
    """
    course = orbit.time_course(_PLACES)
    away = np.minimum(np.abs(course.y), np.abs(course.y + orbit.problem.backlash))
    phase = orbit.problem.initial_phase
    if away[0] < 0.5 * away.max():
        phase += int(np.argmax(away)) / _PLACES
    return float(phase % 1.0)
