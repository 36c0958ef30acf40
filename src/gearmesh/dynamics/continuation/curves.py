"""Curves of orbits in state and parameters: corrector, tangent and steps by pseudo-arclength.

The period-n orbits of a family of problems with one parameter are curves in the space of the state
and the parameter. So are those orbits of a family with two parameters that meet one condition, such
as a fold. The curves are smooth through grazings and folds, so they are followed by their
arclength and not by a parameter.
"""

import contextlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import repeat

import numpy as np

from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.continuation.tracing import MOST_CORRECTIONS, Tracer
from gearmesh.dynamics.periodic.orbits import Orbit
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.errors import InputError, NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.derivatives import curves
from gearmesh.solvers.reduced.derivatives.curves import LARGEST_RESIDUAL, ROUNDED

Family = Callable[..., Problem]
"""The problem at the values of the parameters."""

_CONTRACTION = 0.01  # of the defect: gradients that reduce it so far are used again
_DIFFERENCE = 1e-5
ASTRAY = 0.02
"""Largest distance between a point and where a polynomial through its neighbours predicts it, as a
share of the distance of the nearest two. A point farther away may belong to another branch."""

_CLOSE = 1e-6  # distance, in y_st, at which two orbits are not told apart
_ANYWHERE = -math.inf, math.inf


def _cubic(left: Point, right: Point, normal: np.ndarray, share: float) -> np.ndarray:
    """Return a place on the cubic polynomial through two points, with their tangents."""
    apart, rest = right.place - left.place, 1.0 - share
    length = float(normal @ apart) * share * rest
    ahead, behind = length / (left.tangent @ normal), length / (right.tangent @ normal)
    bend = rest * ahead * left.tangent - share * behind * right.tangent
    place: np.ndarray = left.place + share * share * (3.0 - 2.0 * share) * apart + bend
    return place


def unit_of(low: float, high: float) -> float:
    """Return the unit of a parameter that is followed over a range.

    It is a power of two close to the width of the range, so that a value in this unit keeps all its
    digits.
    """
    return math.ldexp(1.0, round(math.log2(high - low)))


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
    def tracer(self) -> Tracer | None:
        """Compiled code that finds the points, if the problems differ in nu alone."""
        if self.condition is not None or not self.stretches or not isinstance(self.like, Orbit):
            return None
        problem = self.like.problem
        if problem.initial_phase != self.phase:
            problem = replace(problem, initial_phase=self.phase)
        return Tracer(problem, self.periods, self.units[0])

    @property
    def gap_moves(self) -> bool:
        """Whether the backlash changes with time."""
        return self.like.problem.terms.backlash_varies

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
        if self.tracer is not None:
            return self.tracer.point(place, normal, along)
        origin, best = place, np.inf
        orbit = self._orbit(place)
        gradients = self._gradients(place, orbit, rough=True)
        for _ in range(MOST_CORRECTIONS):
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

    def landed(self, places: np.ndarray, normal: np.ndarray, alongs: np.ndarray) -> Sequence[Point]:
        """Return the points as of `point` near several places, shape (n, k + m).

        A place that leads to no orbit has a point of not-a-numbers.
        """
        if self.tracer is not None:
            return self.tracer.landed(places, normal, alongs)
        return [
            self._point_or_nan(*one) for one in zip(places, repeat(normal), alongs, strict=False)
        ]

    def _point_or_nan(self, place: np.ndarray, normal: np.ndarray, along: np.ndarray) -> Point:
        """Return the point as of `point`; one of not-a-numbers if there is no orbit."""
        try:
            return self.point(place, normal, along)
        except NoOrbit:
            nowhere, values = place * np.nan, (float("nan"),) * len(self.units)
            return Point(nowhere, values, nowhere, float("nan"), self.like, lambda: self.like)

    def beside(self, point: Point, length: float) -> Point:
        """Return the point at a small distance along the tangent, where the curve still is."""
        return self._evaluated(point.place + length * point.tangent, point.tangent)

    def _evaluated(self, place: np.ndarray, along: np.ndarray) -> Point:
        """Return the point at a place that is known to be on the curve, without a correction."""
        if self.tracer is not None:
            return self.tracer.evaluated(place, along)
        return self._with_tangent(place, self._orbit(place), along)

    def _with_tangent(self, place: np.ndarray, orbit: Shot, along: np.ndarray) -> Point:
        gradients = self._gradients(place, orbit)
        tangent = np.linalg.svd(gradients)[2][-1]
        if tangent @ along < 0.0:
            tangent = -tangent
        determinant = float(np.linalg.det(np.vstack([gradients, tangent])))
        return Point(place, self._values(place), tangent, determinant, orbit, lambda: orbit)

    def at(self, orbit: Shot, values: tuple[float, ...]) -> Point:
        """Return the point near `orbit` at a value of the first parameter, or near several.

        Its tangent points to more of the first parameter.
        """
        up = np.zeros(orbit.state.size + len(values))
        up[orbit.state.size] = 1.0
        place = np.append(orbit.state, np.divide(values, self.units))
        try:
            return self.point(place, up, up)
        except NoOrbit:  # a fold, where the parameter does not tell one orbit from the next
            along = self._evaluated(place, up).tangent
            return self.point(place, along, along)

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

        Raises
        ------
        NoOrbit
            If there is none near the predicted place.
        """
        return self._near(_cubic(left, right, normal, share), normal, left, right)

    def crossing(self, left: Point, right: Point, value: float, i: int) -> Point:
        """Return the point between two known points at which parameter `i` has a value.

        The parameter must not turn between the two.

        Raises
        ------
        NoOrbit
            As of `between`.
        """
        axis = len(left.place) - len(self.units) + i
        normal = np.eye(len(left.place))[axis]
        share = (value - left.values[i]) / (right.values[i] - left.values[i])
        place = _cubic(left, right, normal, share)
        place[axis] = value / self.units[i]
        return self._near(place, normal, left, right)

    def _near(self, place: np.ndarray, normal: np.ndarray, left: Point, right: Point) -> Point:
        """Return the point near a place that is predicted between two known points."""
        found = self.point(place, normal, left.tangent)
        apart, away = right.place - left.place, found.place - place
        if float(np.linalg.norm(away)) > max(ASTRAY * float(np.linalg.norm(apart)), _CLOSE):
            raise NoOrbit("the corrector leads away from the branch")
        return found

    def towards(self, left: Point, right: Point) -> Point:
        """Step from the left of two points towards the right one, at most half of the way.

        Raises
        ------
        NoOrbit
            If no step leads further.
        """
        length = 0.5 * float(left.tangent @ (right.place - left.place))
        if self.tracer is not None:
            return self.tracer.ahead(left, length, length, _ANYWHERE, 1)[0][0]
        return self._step_on(left, length, (_ANYWHERE,) * len(self.units))[0]

    def step(self, point: Point, length: float) -> Point:
        """Return the point one step ahead along the tangent."""
        return self.point(point.place + length * point.tangent, point.tangent, point.tangent)

    def ahead(
        self, point: Point, length: float, longest: float, limits: tuple[tuple[float, float], ...]
    ) -> tuple[Sequence[Point], float]:
        """Return the next points after `point`, and the length of the step behind them.

        The first step is at most `length`, and shorter where the curve bends. Later ones grow. The
        last point may be at a limit, outside the limits or far away.

        Raises
        ------
        NoOrbit
            If the curve cannot be followed further.
        """
        if self.tracer is not None:
            return self.tracer.ahead(point, length, longest, limits[0])
        following, length = self._step_on(point, length, limits)
        grown = min(curves.GROWTH * length, longest * max(1.0, following.size / curves.LARGE))
        return [following], grown

    def track(self, point: Point) -> Sequence[Point]:
        """Return a sequence of one point, to which others can be added."""
        return [point] if self.tracer is None else self.tracer.track(point)

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
                aligned = float(following.tangent @ point.tangent)
                # An arc that turns by an angle ends half of it, times its length, off the tangent.
                bent = math.sqrt(max(1.0 - aligned**2, 0.0)) + curves.LARGEST_CORRECTION
                if aligned > curves.LEAST_ALIGNMENT and np.linalg.norm(moved) < bent * whole:
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
        return tuple((place[-len(self.units) :] * self.units).tolist())

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
        except NoOrbit as error:
            try:
                side, one = -1, beside(-1)
            except NoOrbit:
                raise error from None
        if rough:
            return side * (one - here) / _DIFFERENCE
        return side * (4.0 * one - beside(2 * side) - 3.0 * here) / (2.0 * _DIFFERENCE)

    def _differentiate(self, orbit: Shot, gradients: np.ndarray) -> None:
        """Write the gradients that the integration gives."""
        k = orbit.state.size
        gradients[:k, :k] = orbit.gradient
        if self.stretches and orbit.stretched is not None:
            gradients[:, k] = orbit.stretched * (-self.units[0] / orbit.problem.nu)
