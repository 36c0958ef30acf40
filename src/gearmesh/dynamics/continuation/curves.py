"""Curves of orbits in state and parameters: corrector, tangent and steps by pseudo-arclength.

The period-n orbits of a family of problems with one parameter are curves in the space of the state
and the parameter. So are those orbits of a family with two parameters that meet one condition, such
as a fold. The curves are smooth through grazings and folds, so they are followed by their
arclength and not by a parameter.
"""

import contextlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from gearmesh.dynamics.periodic.orbits import Orbit
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.errors import InputError, NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.derivatives import curves
from gearmesh.solvers.reduced.derivatives.curves import LARGEST_RESIDUAL, ROUNDED
from gearmesh.solvers.reduced.derivatives.deviations import SIZE
from gearmesh.solvers.reduced.derivatives.period_map import (
    STATUSES,
    Statement,
    passage_of,
    statement,
    trace,
)
from gearmesh.solvers.reduced.derivatives.variational import COMPLETE

Family = Callable[..., Problem]
"""The problem at the values of the parameters."""

_MOST_CORRECTIONS = 12
_CONTRACTION = 0.01  # of the defect: gradients that reduce it so far are used again
_DIFFERENCE = 1e-5
_MOST_STEPS = 64  # in one call of the compiled code


@dataclass(frozen=True, eq=False)
class Point:
    """A point of a curve of orbits.

    Attributes
    ----------
    place : ndarray, shape (k + m,)
        The k numbers of the state, and the m parameters in units of the curve.
    values : tuple of float
        The parameters.
    tangent : ndarray, shape (k + m,)
        Unit tangent of the curve.
    determinant : float
        Determinant of the Jacobian of P^n(x) - x (and of the condition) in state and parameters,
        bordered by the tangent.
    made : callable
        Returns the orbit.
    found : tuple of two ndarray, optional
        The row of `gearmesh.solvers.reduced.derivatives.curves` and the events of the motion over
        the period, if compiled code found it.
    """

    place: np.ndarray
    values: tuple[float, ...]
    tangent: np.ndarray
    determinant: float
    made: Callable[[], Shot] = field(repr=False)
    found: tuple[np.ndarray, np.ndarray] | None = field(default=None, repr=False)

    @cached_property
    def orbit(self) -> Shot:
        """The orbit."""
        return self.made()

    @property
    def slope(self) -> float:
        """Change of the first parameter along the tangent, in units of the curve."""
        return float(self.tangent[-len(self.values)])

    def reversed(self) -> "Point":
        """Return the same point, seen in the other direction along the curve."""
        back = -self.tangent, -self.determinant
        return Point(self.place, self.values, *back, self.made, self.found)


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
    like : Shot
        Any motion of the solver that integrates those along the curve.
    condition : callable, optional
        A function of the orbit that is 0 along the curve. It is needed if two parameters vary.
    stretches : bool
        Whether nu is the only parameter that varies. Then the integration itself gives the
        derivative with respect to the mesh period, without differences.
    """

    family: Family
    periods: int
    units: tuple[float, ...]
    phase: float
    like: Shot
    condition: Callable[[Shot], float] | None = None
    stretches: bool = False

    @cached_property
    def _compiled(self) -> tuple[Problem, Statement] | None:
        """A problem, and how compiled code takes it, if the others differ from it in nu alone."""
        if self.condition is not None or not self.stretches or not isinstance(self.like, Orbit):
            return None
        problem = replace(self._problem((self.like.problem.nu,)), initial_state=None)
        return problem, statement(problem, self.periods)

    def point(self, place: np.ndarray, normal: np.ndarray, along: np.ndarray) -> Point:
        """Return the point of the curve in the plane through `place` with the given normal.

        Parameters
        ----------
        place, normal : ndarray, shape (k + m,)
        along : ndarray, shape (k + m,)
            Direction that the tangent follows.

        Raises
        ------
        NoOrbit
            If Newton's method does not converge.
        """
        if self._compiled is not None:
            point = self._traced(self._compiled, place, normal, _MOST_CORRECTIONS)
            return point if point.tangent @ along > 0.0 else point.reversed()
        origin, best = place, np.inf
        orbit = self._orbit(place)
        gradients = self._gradients(place, orbit, rough=True)
        for _ in range(_MOST_CORRECTIONS):
            defect = self._defect(orbit)
            size = float(np.abs(defect).max())
            if not size < best:
                break
            known = size < _CONTRACTION * best < np.inf
            found, found_orbit, best = place, orbit, size
            if best < ROUNDED:
                break
            if not known:
                self._differentiate(orbit, gradients)
            try:
                correction = np.linalg.solve(
                    np.vstack([gradients, normal]), np.append(defect, normal @ (place - origin))
                )
            except np.linalg.LinAlgError as error:
                raise NoOrbit("the curve is singular here") from error
            # Rounding must not move a parameter that the plane holds fixed.
            place = np.where(normal == 1.0, origin, place - correction)
            orbit = self._orbit(place)
        if not best < LARGEST_RESIDUAL:
            raise NoOrbit(f"the corrector stops at a residual of {best:.1e}")
        return self._with_tangent(found, found_orbit, along)

    def beside(self, point: Point, length: float) -> Point:
        """Return the point at a small distance along the tangent, where the curve still is."""
        place = point.place + length * point.tangent
        if self._compiled is not None:
            return self._traced(self._compiled, place, point.tangent, 0)
        return self._with_tangent(place, self._orbit(place), point.tangent)

    def _traced(
        self,
        compiled: tuple[Problem, Statement],
        place: np.ndarray,
        normal: np.ndarray,
        corrections: int,
    ) -> Point:
        """Return the point that compiled code finds."""
        points, events, _ = trace(compiled[1], place, normal, self.units[0], corrections)
        row = points[0]
        if row[curves.OUTCOME] != COMPLETE:
            raise NoOrbit(f"the motion ends with {STATUSES[int(row[curves.OUTCOME])]}")
        residual = np.abs(row[curves.END : curves.JACOBIAN] - row[:SIZE]).max()
        if corrections and not residual < LARGEST_RESIDUAL:
            raise NoOrbit(f"the corrector stops at a residual of {residual:.1e}")
        return self._found(compiled, row, events[0])

    def _found(
        self, compiled: tuple[Problem, Statement], row: np.ndarray, events: np.ndarray
    ) -> Point:
        """Return a point of the compiled code."""
        events = events[: int(row[curves.N_EVENTS])]
        nu = float(row[SIZE]) * self.units[0]

        def made() -> Orbit:
            problem, stated = compiled
            moved = passage_of(stated, self.units[0], row, events)
            return Orbit(replace(problem, nu=nu), self.periods, row[:SIZE], moved)

        return Point(
            row[: curves.DIMENSIONS],
            (nu,),
            row[curves.TANGENT : curves.DETERMINANT],
            float(row[curves.DETERMINANT]),
            made,
            (row, events),
        )

    def _with_tangent(self, place: np.ndarray, orbit: Shot, along: np.ndarray) -> Point:
        gradients = self._gradients(place, orbit)
        tangent = np.linalg.svd(gradients)[2][-1]
        if tangent @ along < 0.0:
            tangent = -tangent
        determinant = float(np.linalg.det(np.vstack([gradients, tangent])))
        return Point(place, self._values(place), tangent, determinant, lambda: orbit)

    def at(self, orbit: Shot, values: tuple[float, ...]) -> Point:
        """Return the point near `orbit` at a value of the first parameter, or near several.

        Its tangent points to more of the first parameter.
        """
        up = np.zeros(orbit.state.size + len(values))
        up[orbit.state.size] = 1.0
        return self.point(np.append(orbit.state, np.divide(values, self.units)), up, up)

    def moved_to(self, phase: float, point: Point) -> tuple["Curve", Point]:
        """Return the curve with its state taken at another phase, and a point on it."""
        other = replace(self, phase=phase)
        near = self.step(point, _DIFFERENCE)
        here, there = (one.orbit.at_phase(phase).state for one in (point, near))
        along = np.append((there - here) / _DIFFERENCE, point.tangent[here.size :])
        along /= np.linalg.norm(along)
        return other, other.point(np.append(here, point.place[here.size :]), along, along)

    def between(self, left: Point, right: Point, normal: np.ndarray, share: float) -> Point:
        """Return a point of the curve between two known points.

        `share` says how far it is from `left` to `right`, from 0 to 1. Distances are measured along
        `normal`, which must be close to both tangents. A cubic polynomial through both points, with
        their tangents, predicts the new point.
        """
        length = float(normal @ (right.place - left.place))
        ahead, behind = (length / (one.tangent @ normal) * one.tangent for one in (left, right))
        apart = right.place - left.place
        bend = share * (1.0 - share) * ((1.0 - share) * (ahead - apart) - share * (behind - apart))
        return self.point(left.place + share * apart + bend, normal, left.tangent)

    def step(self, point: Point, length: float) -> Point:
        """Return the point one step ahead along the tangent."""
        return self.point(point.place + length * point.tangent, point.tangent, point.tangent)

    def ahead(
        self, point: Point, length: float, longest: float, limits: tuple[tuple[float, float], ...]
    ) -> tuple[list[Point], float]:
        """Return the next points after `point`, and the length of the step behind them.

        The first step is at most `length`, and shorter where the curve bends. Later ones grow. The
        last point may be at a limit, outside the limits or far away.

        Raises
        ------
        NoOrbit
            If the curve cannot be followed further.
        """
        compiled = self._compiled
        if compiled is None:
            following, length = self._step_on(point, length, limits)
            size = max(following.orbit.y_max, -following.orbit.y_min)
            grown = min(curves.GROWTH * length, longest * max(1.0, size / curves.LARGE))
            return [following], grown
        points, events, length = trace(
            compiled[1],
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
        return [self._found(compiled, points[i], events[i]) for i in range(1, len(points))], length

    def _step_on(
        self, point: Point, length: float, limits: tuple[tuple[float, float], ...]
    ) -> tuple[Point, float]:
        """Return the next point after `point` and the length of the step that reaches it."""
        reason = "it bends too sharply"
        while length > curves.SHORTEST_STEP:
            place, normal = self._predicted(point, length, limits)
            try:
                following = self.point(place, normal, point.tangent)
                moved, whole = following.place - place, np.linalg.norm(place - point.place)
                straight = following.tangent @ point.tangent > curves.LEAST_ALIGNMENT
                if straight and np.linalg.norm(moved) < curves.LARGEST_CORRECTION * whole:
                    return following, length
            except NoOrbit as error:
                reason = str(error)
            length *= 0.5
        raise NoOrbit(reason)

    def _predicted(
        self, point: Point, length: float, limits: tuple[tuple[float, float], ...]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the next place, and the normal of the plane in which its point is searched for.

        It is one step ahead along the tangent, or where this step meets a limit of a parameter.
        Beyond a limit a parameter may have no meaning.
        """
        k, share, normal = len(point.place) - len(self.units), 1.0, point.tangent
        for i, ends in enumerate(np.divide(limits, np.array(self.units)[:, None])):
            here, change = point.place[k + i], length * point.tangent[k + i]
            edge = ends[int(change > 0.0)]
            if abs(edge - here) < share * abs(change):
                share, normal = abs((edge - here) / change), np.eye(len(point.place))[k + i]
                reached = edge
        place = point.place + share * length * point.tangent
        return (place if share == 1.0 else np.where(normal == 1.0, reached, place)), normal

    def _problem(self, values: tuple[float, ...]) -> Problem:
        """Return the problem at values of the parameters, with its state taken at the phase."""
        try:
            problem = self.family(*values)
        except InputError as error:
            raise NoOrbit(str(error)) from error
        return (
            problem
            if problem.initial_phase == self.phase
            else replace(problem, initial_phase=self.phase)
        )

    @cached_property
    def _problem_at(self) -> Callable[[tuple[float, ...]], Problem]:
        """`_problem` with a memory: differences in the state need the same problem often."""
        return lru_cache(maxsize=16)(self._problem)

    def _orbit(self, place: np.ndarray) -> Shot:
        problem = self._problem_at(self._values(place))
        return self.like.shot(problem, place[: -len(self.units)], self.periods)

    def _values(self, place: np.ndarray) -> tuple[float, ...]:
        # Rounding to 15 digits restores a limit as it was stated.
        return tuple(float(f"{value:.15g}") for value in place[-len(self.units) :] * self.units)

    def _defect(self, orbit: Shot) -> np.ndarray:
        defect = orbit.defect
        return defect if self.condition is None else np.append(defect, self.condition(orbit))

    def _gradients(self, place: np.ndarray, orbit: Shot, rough: bool = False) -> np.ndarray:
        """Return the gradients of the defect, by differences where the integration gives none.

        They are one-sided if rough: good enough for the direction of Newton's steps, which does not
        change the point to which they converge.
        """
        gradients = np.zeros((len(place) - 1, len(place)))
        self._differentiate(orbit, gradients)
        if self.stretches and orbit.stretched is not None:
            return gradients
        k = orbit.state.size
        for i in range(k if self.condition is None else 0, len(place)):
            rows = slice(0 if i >= k else k, None)
            gradients[rows, i] = self._difference(place, orbit, i, rough)[rows]
        return gradients

    def _difference(self, place: np.ndarray, orbit: Shot, i: int, rough: bool) -> np.ndarray:
        """Return the derivative of the defect in one component of the place.

        Where a parameter has no values beyond this one, the differences are one-sided.
        """
        away = _DIFFERENCE * np.eye(len(place))[i]

        def beside(steps: int) -> np.ndarray:
            return self._defect(self._orbit(place + steps * away))

        if not rough:
            with contextlib.suppress(NoOrbit):
                return (beside(1) - beside(-1)) / (2.0 * _DIFFERENCE)
        here = self._defect(orbit)
        try:
            side, one = 1, beside(1)
        except NoOrbit:
            side, one = -1, beside(-1)
        if rough:
            return side * (one - here) / _DIFFERENCE
        return side * (4.0 * one - beside(2 * side) - 3.0 * here) / (2.0 * _DIFFERENCE)

    def _differentiate(self, orbit: Shot, gradients: np.ndarray) -> None:
        """Write the gradients that the integration gives."""
        k = orbit.state.size
        gradients[:k, :k] = orbit.gradient
        if self.stretches and orbit.stretched is not None:
            gradients[:, k] = orbit.stretched * (-self.units[0] / orbit.problem.nu)
