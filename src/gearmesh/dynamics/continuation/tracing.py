"""Points of curves over the mesh frequency that compiled code finds, and what they show at once."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import overload

import numpy as np

from gearmesh.dynamics.continuation.points import Point
from gearmesh.dynamics.periodic.events import extrema_of, jumping_segments, jumps_of
from gearmesh.dynamics.periodic.orbits import Orbit, sorted_multipliers
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.derivatives import curves
from gearmesh.solvers.reduced.derivatives.curves import LARGEST_RESIDUAL
from gearmesh.solvers.reduced.derivatives.deviations import DEVIATIONS, SIZE
from gearmesh.solvers.reduced.derivatives.landings import land
from gearmesh.solvers.reduced.derivatives.period_map import (
    STATUSES,
    Statement,
    passage_of,
    statement,
    trace,
)
from gearmesh.solvers.reduced.derivatives.variational import COMPLETE

MOST_CORRECTIONS = 12
_MOST_STEPS = 64  # in one call of the compiled code
_MANY = 128  # points that are worth the ten seconds in which the code of the lanes is compiled
_UNRECORDED = np.empty(0)  # stands for the events of a motion in a lane


@dataclass(frozen=True)
class Tracer:
    """The orbits of a problem over nu, as compiled code finds them.

    Attributes
    ----------
    problem : Problem
        At any nu.
    periods : int
        Mesh periods of the orbits.
    unit : float
        Change of nu that counts like a change of 1 in the state.
    """

    problem: Problem
    periods: int
    unit: float

    @cached_property
    def stated(self) -> Statement:
        """The problem in the form that the compiled code takes."""
        return statement(self.problem, self.periods)

    @cached_property
    def jumping(self) -> np.ndarray:
        """Whether C(t) jumps at the start of each segment of the mesh period."""
        return jumping_segments(self.stated[0])

    def point(self, place: np.ndarray, normal: np.ndarray, along: np.ndarray) -> Point:
        """Return the point as of `Curve.point`."""
        return self._landed(place, normal, along, MOST_CORRECTIONS)

    def evaluated(self, place: np.ndarray, along: np.ndarray) -> Point:
        """Return the point at a place, without any correction."""
        return self._landed(place, along, along, 0)

    def _landed(
        self, place: np.ndarray, normal: np.ndarray, along: np.ndarray, corrections: int
    ) -> Point:
        rows, events, _ = trace(self.stated, place, normal, self.unit, corrections)
        if rows[0, curves.OUTCOME] != COMPLETE:
            raise NoOrbit(f"the motion ends with {STATUSES[int(rows[0, curves.OUTCOME])]}")
        residual = float(_residuals(rows)[0])
        if corrections and not residual < LARGEST_RESIDUAL:
            raise NoOrbit(f"the corrector stops at a residual of {residual:.1e}")
        return Track(self, _directed(rows, along), _recorded(rows, events))[0]

    def landed(self, places: np.ndarray, normal: np.ndarray, alongs: np.ndarray) -> "Track":
        """Return the points as of `Curve.landed`."""
        if len(places) < _MANY:
            rows, recorded, _ = trace(self.stated, places, normal, self.unit, MOST_CORRECTIONS)
            events = _recorded(rows, recorded)
        else:
            rows = land(self.problem, self.periods, self.unit, places, normal, MOST_CORRECTIONS)
            events = [_UNRECORDED] * len(rows)
        met = (rows[:, curves.OUTCOME] == COMPLETE) & (_residuals(rows) < LARGEST_RESIDUAL)
        rows[~met] = np.nan
        return Track(self, _directed(rows, alongs), events)

    def ahead(
        self,
        point: Point,
        length: float,
        longest: float,
        limits: tuple[float, float],
        most: int = _MOST_STEPS,
    ) -> tuple["Track", float]:
        """Return the next points, at most `most`, and the next length as of `Curve.ahead`."""
        rows, events, length = trace(
            self.stated,
            point.place,
            point.tangent,
            self.unit,
            MOST_CORRECTIONS,
            most,
            length,
            longest,
            limits,
        )
        if len(rows) == 1:
            raise NoOrbit("it bends too sharply")
        return Track(self, rows[1:], _recorded(rows[1:], events[1:])), length

    def track(self, point: Point) -> "Track":
        """Return a track of one point, in the direction of the point's tangent."""
        motion = point.motion
        assert isinstance(motion, _Traced)
        row = motion.row.copy()
        row[curves.TANGENT : curves.DETERMINANT] = point.tangent
        row[curves.DETERMINANT] = point.determinant
        return Track(self, row[None], [motion.recorded])

    def read(self, row: np.ndarray, events: np.ndarray) -> Point:
        """Return the point that stands in a row of the compiled code."""
        motion = _Traced(self, row, events)
        return Point(
            row[: curves.DIMENSIONS],
            (motion.nu,),
            row[curves.TANGENT : curves.DETERMINANT],
            float(row[curves.DETERMINANT]),
            motion,
            lambda: motion.orbit,
        )


@dataclass(eq=False)
class _Traced:
    """A motion that compiled code found, with the names of `Motion`.

    Events that were not recorded are found when they are asked for.
    """

    tracer: Tracer
    row: np.ndarray
    recorded: np.ndarray

    @cached_property
    def events(self) -> np.ndarray:
        return self.orbit.passage.events if self.recorded is _UNRECORDED else self.recorded

    @cached_property
    def orbit(self) -> Orbit:
        tracer, row, known = self.tracer, self.row, None
        if self.recorded is not _UNRECORDED:
            known = passage_of(tracer.stated, tracer.unit, row, self.recorded)
        problem = replace(tracer.problem, nu=self.nu)
        return Orbit(problem, tracer.periods, row[:SIZE], known)

    @property
    def nu(self) -> float:
        return float(self.row[SIZE]) * self.tracer.unit

    @property
    def period(self) -> float:
        return 2.0 * np.pi / self.nu

    @property
    def periods(self) -> int:
        return self.tracer.periods

    @property
    def backlash(self) -> float:
        return self.tracer.problem.backlash

    @property
    def monodromy(self) -> np.ndarray:
        return monodromies(self.row)

    @property
    def undamped(self) -> bool:
        return bool(self.row[curves.DAMPING] == 0.0)

    @cached_property
    def extrema(self) -> np.ndarray:
        return extrema_of(self.events)

    @property
    def gap_extrema(self) -> np.ndarray:
        return self.extrema + np.array([0.0, self.backlash, 0.0])

    @cached_property
    def stiffness_jumps(self) -> np.ndarray:
        return jumps_of(self.events, self.tracer.jumping)

    @property
    def y(self) -> float:
        return float(self.row[0])

    @property
    def y_max(self) -> float:
        return float(self.row[curves.Y_MAX])

    @property
    def y_min(self) -> float:
        return float(self.row[curves.Y_MIN])


def _residuals(rows: np.ndarray) -> np.ndarray:
    """Return |P^n(x) - x| of each row."""
    # NumPy is three times as fast with four long rows as with many short ones.
    columns = rows.T
    defects = np.subtract(columns[curves.END : curves.JACOBIAN], columns[:SIZE], order="C")
    residuals: np.ndarray = np.abs(defects).max(axis=0)
    return residuals


def _directed(rows: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Reverse the tangents that point against `along`, and return the rows."""
    tangents = rows[:, curves.TANGENT : curves.DETERMINANT]
    back = np.einsum("...i,...i", tangents, along) < 0.0
    rows[back, curves.TANGENT : curves.OUTCOME] *= -1.0
    return rows


def _recorded(rows: np.ndarray, events: np.ndarray) -> list[np.ndarray]:
    """Return the events of each row, out of the room for them."""
    counts = rows[:, curves.N_EVENTS].astype(int).tolist()
    return [one[:count] for one, count in zip(events, counts, strict=False)]


class Track(Sequence[Point]):
    """Successive points of a curve, read from arrays when they are asked for.

    Attributes
    ----------
    tracer : Tracer
    rows : ndarray, shape (n, POINT_SIZE)
        The columns of `gearmesh.solvers.reduced.derivatives.curves`.
    events : list of ndarray
        Events of each motion; `_UNRECORDED` for those that were corrected in the lanes.
    """

    def __init__(self, tracer: Tracer, rows: np.ndarray, events: list[np.ndarray]) -> None:
        self.tracer, self.rows, self.events = tracer, rows, events

    def __len__(self) -> int:
        return len(self.events)

    @overload
    def __getitem__(self, index: int) -> Point: ...

    @overload
    def __getitem__(self, index: slice) -> "Track": ...

    def __getitem__(self, index: int | slice) -> "Point | Track":
        if isinstance(index, slice):
            return Track(self.tracer, self.rows[index], self.events[index])
        return self.tracer.read(self.rows[index], self.events[index])

    @cached_property
    def multipliers(self) -> np.ndarray:
        """Floquet multipliers of each orbit, the largest modulus first, shape (n, 4)."""
        return sorted_multipliers(np.linalg.eigvals(monodromies(self.rows)))


def chained(first: Sequence[Point], second: Sequence[Point]) -> Sequence[Point]:
    """Return the points of two sequences in one."""
    if not first or not second:
        return first or second
    if isinstance(first, Track) and isinstance(second, Track) and first.tracer is second.tracer:
        rows = np.concatenate([first.rows, second.rows])
        return Track(first.tracer, rows, first.events + second.events)
    return [*first, *second]


def backwards(points: Sequence[Point]) -> Sequence[Point]:
    """Return the same points, passed in the other direction."""
    if isinstance(points, Track):
        rows = points.rows[::-1].copy()
        rows[:, curves.TANGENT : curves.OUTCOME] *= -1.0
        return Track(points.tracer, rows, points.events[::-1])
    return [point.reversed() for point in reversed(points)]


def first_values(points: Sequence[Point]) -> np.ndarray:
    """Return the first parameter at each point, shape (n,)."""
    if isinstance(points, Track):
        return points.rows[:, SIZE] * points.tracer.unit
    return np.array([point.values[0] for point in points])


def geometry(points: Sequence[Point]) -> tuple[np.ndarray, np.ndarray]:
    """Return the places and the tangents of points, shape (n, k + m)."""
    if isinstance(points, Track):
        rows = points.rows
        return rows[:, : curves.DIMENSIONS], rows[:, curves.TANGENT : curves.DETERMINANT]
    return np.array([one.place for one in points]), np.array([one.tangent for one in points])


def monodromies(rows: np.ndarray) -> np.ndarray:
    """Return the monodromy matrices of rows, shape (..., 4, 4)."""
    extended = rows[..., curves.JACOBIAN : curves.TANGENT]
    return extended.reshape(*extended.shape[:-1], SIZE, DEVIATIONS)[..., :SIZE]
