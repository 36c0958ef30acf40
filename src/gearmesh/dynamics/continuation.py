"""Curves of orbits in state and parameters: corrector, tangent and steps by pseudo-arclength.

The period-n orbits of a family of problems with one parameter are curves in the space of the state
and the parameter. So are those orbits of a family with two parameters that meet one condition, such
as a fold. The curves are smooth through grazings and folds, so they are followed by their
arclength and not by a parameter.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from gearmesh.dynamics.orbits import Orbit
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced import curves
from gearmesh.solvers.reduced.curves import LARGEST_RESIDUAL, ROUNDED, is_clear
from gearmesh.solvers.reduced.period_map import (
    Passage,
    Statement,
    advance,
    passage,
    passage_of,
    statement,
    trace,
)

Family = Callable[..., Problem]
"""The problem at the values of the parameters."""

_MOST_CORRECTIONS = 12
_DIFFERENCE = 1e-5
_PLACES = 64
_MOST_STEPS = 64  # in one call of the compiled code


@dataclass(frozen=True)
class Point:
    """A point of a curve of orbits.

    Attributes
    ----------
    place : ndarray, shape (4 + m,)
        The state, and the m parameters in units of the curve.
    values : tuple of float
        The parameters.
    tangent : ndarray, shape (4 + m,)
        Unit tangent of the curve.
    determinant : float
        Determinant of the Jacobian of P^n(x) - x (and of the condition) in state and parameters,
        bordered by the tangent.
    passage : Passage
        The motion over the period of the orbit.
    curve : Curve
    """

    place: np.ndarray
    values: tuple[float, ...]
    tangent: np.ndarray
    determinant: float
    passage: Passage
    curve: "Curve" = field(repr=False)

    @cached_property
    def orbit(self) -> Orbit:
        """The orbit."""
        problem = self.curve.problem(self.values)
        return Orbit(problem, self.curve.periods, self.place[:4], self.passage)

    def reversed(self) -> "Point":
        """Return the same point, seen in the other direction along the curve."""
        return replace(self, tangent=-self.tangent, determinant=-self.determinant)


@dataclass(frozen=True)
class Curve:
    """The curves of period-n orbits of a family.

    Attributes
    ----------
    family : callable
        The problem at the values of the parameters.
    periods : int
        n.
    units : tuple of float
        Change of each parameter that counts like a change of 1 in the state.
    phase : float
        Mesh phase at which the state is taken. The state has a kink along the curve where it
        passes an end of a regime at this very phase, because damping jumps there.
    condition : callable, optional
        A function of the orbit that is 0 along the curve. It is needed if two parameters vary.
    value : float, optional
        A value of nu if nu is the only parameter that varies. Then the integration itself gives the
        derivative with respect to the mesh period, and compiled code follows the curve.
    """

    family: Family
    periods: int
    units: tuple[float, ...]
    phase: float
    condition: Callable[[Orbit], float] | None = None
    value: float | None = None

    @cached_property
    def _stated(self) -> Statement:
        return statement(self.problem((self.value or 0.0,)), self.periods)

    def point(self, place: np.ndarray, normal: np.ndarray, along: np.ndarray) -> Point:
        """Return the point of the curve in the plane through `place` with the given normal.

        Parameters
        ----------
        place, normal : ndarray, shape (4 + m,)
        along : ndarray, shape (4 + m,)
            Direction that the tangent follows.

        Raises
        ------
        NoOrbit
            If Newton's method does not converge.
        """
        if self.value is not None:
            point = self._traced(place, normal, _MOST_CORRECTIONS)
            return point if point.tangent @ along > 0.0 else point.reversed()
        origin, best = place, np.inf
        orbit = self._orbit(place)
        gradients = self._gradients(place, orbit, rough=True)
        for _ in range(_MOST_CORRECTIONS):
            defect = self._defect(orbit)
            if not np.abs(defect).max() < best:
                break
            best = float(np.abs(defect).max())
            found, found_orbit = place, orbit
            if best < ROUNDED:
                break
            gradients[:4, :4] = orbit.passage.jacobian - np.eye(4)
            try:
                correction = np.linalg.solve(
                    np.vstack([gradients, normal]), np.append(defect, normal @ (place - origin))
                )
            except np.linalg.LinAlgError as error:
                raise NoOrbit("the curve is singular here") from error
            place = place - correction
            orbit = self._orbit(place)
        if not best < LARGEST_RESIDUAL:
            raise NoOrbit(f"the corrector stops at a residual of {best:.1e}")
        return self._with_tangent(found, found_orbit, along)

    def _traced(self, place: np.ndarray, normal: np.ndarray, corrections: int) -> Point:
        """Return the point that compiled code finds."""
        points, events, _ = trace(self._stated, place, normal, self.units[0], corrections)
        point = self._found(points[0], events[0])
        if point.passage.status != "complete":
            raise NoOrbit(f"the motion ends with {point.passage.status}")
        residual = np.abs(point.passage.end - point.place[:4]).max()
        if corrections and not residual < LARGEST_RESIDUAL:
            raise NoOrbit(f"the corrector stops at a residual of {residual:.1e}")
        return point

    def _found(self, point: np.ndarray, events: np.ndarray) -> Point:
        """Return a point of the compiled code."""
        return Point(
            point[: curves.DIMENSIONS],
            (float(point[4]) * self.units[0],),
            point[curves.TANGENT : curves.DETERMINANT],
            float(point[curves.DETERMINANT]),
            passage_of(self._stated, self.units[0], point, events),
            self,
        )

    def beside(self, point: Point, length: float) -> Point:
        """Return the point at a small distance along the tangent, where the curve still is."""
        place = point.place + length * point.tangent
        if self.value is not None:
            return self._traced(place, point.tangent, 0)
        return self._with_tangent(place, self._orbit(place), point.tangent)

    def _with_tangent(self, place: np.ndarray, orbit: Orbit, along: np.ndarray) -> Point:
        gradients = self._gradients(place, orbit)
        tangent = np.linalg.svd(gradients)[2][-1]
        if tangent @ along < 0.0:
            tangent = -tangent
        determinant = float(np.linalg.det(np.vstack([gradients, tangent])))
        return Point(place, self._values(place), tangent, determinant, orbit.passage, self)

    def at(self, orbit: Orbit, values: tuple[float, ...]) -> Point:
        """Return the point near `orbit` at a value of the first parameter, or near several.

        Its tangent points to more of the first parameter.
        """
        up = np.zeros(4 + len(values))
        up[4] = 1.0
        return self.point(np.append(orbit.state, np.divide(values, self.units)), up, up)

    def moved_to(self, phase: float, point: Point) -> tuple["Curve", Point]:
        """Return the curve with its state taken at another phase, and a point on it."""
        other = replace(self, phase=phase)
        near = self.step(point, _DIFFERENCE)
        here, there = (at_phase(one.orbit, phase).state for one in (point, near))
        along = np.append((there - here) / _DIFFERENCE, point.tangent[4:])
        along /= np.linalg.norm(along)
        return other, other.point(np.append(here, point.place[4:]), along, along)

    def step(self, point: Point, length: float) -> Point:
        """Return the point one step ahead along the tangent."""
        return self.point(point.place + length * point.tangent, point.tangent, point.tangent)

    def ahead(
        self, point: Point, length: float, longest: float, limits: tuple[tuple[float, float], ...]
    ) -> tuple[list[Point], float]:
        """Return the next points after `point`, and the length of the step behind them.

        The first step is at most `length`, and shorter where the curve bends. Later ones grow. The
        last point may be outside the limits or far away.

        Raises
        ------
        NoOrbit
            If the curve cannot be followed further.
        """
        if self.value is None:
            following, length = self._step_on(point, length)
            size = max(following.orbit.y_max, -following.orbit.y_min)
            grown = min(curves.GROWTH * length, longest * max(1.0, size / curves.LARGE))
            return [following], grown
        points, events, length = trace(
            self._stated,
            point.place,
            point.tangent,
            self.units[0],
            _MOST_CORRECTIONS,
            _MOST_STEPS,
            length,
            longest,
            limits[0],
        )
        if len(points) == 1:
            raise NoOrbit("it bends too sharply")
        return [self._found(points[i], events[i]) for i in range(1, len(points))], length

    def _step_on(self, point: Point, length: float) -> tuple[Point, float]:
        """Return the next point after `point` and the length of the step that reaches it."""
        reason = "it bends too sharply"
        while length > curves.SHORTEST_STEP:
            try:
                following = self.step(point, length)
                moved = following.place - point.place - length * point.tangent
                straight = following.tangent @ point.tangent > curves.LEAST_ALIGNMENT
                if straight and np.linalg.norm(moved) < curves.LARGEST_CORRECTION * length:
                    return following, length
            except NoOrbit as error:
                reason = str(error)
            length *= 0.5
        raise NoOrbit(reason)

    def problem(self, values: tuple[float, ...]) -> Problem:
        """Return the problem at values of the parameters, with its state taken at the phase."""
        problem = self.family(*values)
        if problem.initial_phase == self.phase and problem.initial_state is None:
            return problem
        return replace(problem, initial_phase=self.phase, initial_state=None)

    def _orbit(self, place: np.ndarray) -> Orbit:
        problem = self.problem(self._values(place))
        moved = passage(problem, place[:4], self.periods)
        if moved.status != "complete":
            raise NoOrbit(f"the motion ends with {moved.status}")
        return Orbit(problem, self.periods, place[:4], moved)

    def _values(self, place: np.ndarray) -> tuple[float, ...]:
        return tuple(float(value) for value in place[4:] * self.units)

    def _defect(self, orbit: Orbit) -> np.ndarray:
        defect = orbit.passage.end - orbit.state
        return defect if self.condition is None else np.append(defect, self.condition(orbit))

    def _gradients(self, place: np.ndarray, orbit: Orbit, rough: bool = False) -> np.ndarray:
        """Return the gradients of the defect, by differences where the integration gives none.

        They are one-sided if rough: good enough for the direction of Newton's steps, which does not
        change the point to which they converge.
        """
        gradients = np.zeros((len(place) - 1, len(place)))
        gradients[:4, :4] = orbit.passage.jacobian - np.eye(4)
        for i in range(4 if self.condition is None else 0, len(place)):
            away = _DIFFERENCE * np.eye(len(place))[i]
            ahead = self._defect(self._orbit(place + away))
            behind = self._defect(orbit if rough else self._orbit(place - away))
            difference = (ahead - behind) / (_DIFFERENCE if rough else 2.0 * _DIFFERENCE)
            gradients[0 if i >= 4 else 4 :, i] = difference[0 if i >= 4 else 4 :]
        return gradients


def frequency(family: Family, value: float) -> float | None:
    """Return `value` if the only parameter of a family is nu."""
    here, there = family(value), family(1.001 * value)
    return value if here.nu == value and there == replace(here, nu=1.001 * value) else None


def at_phase(orbit: Orbit, phase: float) -> Orbit:
    """Return an orbit with its state taken at another mesh phase."""
    share = (phase - orbit.problem.initial_phase) % 1.0
    if share == 0.0:
        return orbit
    state = advance(orbit.problem, orbit.state, share)
    problem = replace(orbit.problem, initial_phase=phase)
    return Orbit(problem, orbit.periods, state, passage(problem, state, orbit.periods))


def clear_phase(orbit: Orbit) -> float:
    """Return a mesh phase at which the orbit is far from the ends of its regimes.

    The phase of the orbit's state is kept if it is at least half as far from them as the best
    phase.
    """
    phase, backlash = orbit.problem.initial_phase, orbit.problem.backlash
    if not is_clear.py_func(orbit.y, orbit.y_max, orbit.y_min, backlash):
        course = orbit.time_course(_PLACES)
        away = np.minimum(np.abs(course.y), np.abs(course.y + backlash))
        phase += int(np.argmax(away)) / _PLACES
    return float(phase % 1.0)
