"""The Poincaré map of the general solver, over the common period of shafts and mesh.

A state consists of the unknowns of an orbit (`gearmesh.dynamics.periodic.charts`). Where the mean
rotation has to be held, a drive corrects it after every step, so states contain the holding
moments.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from gearmesh.dynamics.periodic.charts import ABSENT, HELD, chart_of, state_at_place, with_moments
from gearmesh.dynamics.periodic.general_orbits import (
    GeneralOrbit,
    common_period,
    ends,
    moved_to_phase,
    shot_from,
)
from gearmesh.dynamics.periodic.general_search import correct
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.errors import NoOrbit
from gearmesh.model import motion
from gearmesh.model.motion import ROTATION_2, ROTATION_3, Y_2, Y_3
from gearmesh.model.problem import Problem
from gearmesh.solvers.full.coordinates import signs_act

_WEIGHT_OF_BODIES = 0.01  # in distances, as in the reduced system


class GeneralMap:
    """See `gearmesh.dynamics.attraction.maps.PoincareMap`.

    Raises
    ------
    NoOrbit
        If the excitation does not repeat.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = replace(problem, initial_state=None)
        # With both signs of friction, motions often repeat after two common periods.
        self._common = common_period(problem)
        self.block = self._common * (2 if signs_act(problem) else 1)
        self._chart = chart = chart_of(problem)
        self._angle = float(self._place(problem)[0])
        self._motions: dict[int, Callable[..., np.ndarray]] = {}
        # Coordinates are the numbers of a place that multipliers describe, with y and y' in place
        # of the sum of the rotations and its rate.
        n, first = chart.n, 0 if chart.rotation == ABSENT else 1
        columns = chart.columns
        along = columns[ROTATION_3] + columns[ROTATION_2] + columns[Y_3] - columns[Y_2]
        of_y = np.eye(2 * n)
        of_y[first, :n] = of_y[n + first, n:] = along
        pairs = [first, *range(first), *range(first + 1, n)]
        order = [i for one in pairs for i in (one, n + one) if i in chart.kept]
        self._to_coordinates = of_y[order]
        self._from_coordinates = np.linalg.inv(of_y)[:, order]

    @property
    def weights(self) -> np.ndarray:
        """Weights of the coordinates."""
        return np.array([1.0, 1.0] + [_WEIGHT_OF_BODIES] * (len(self._to_coordinates) - 2))

    @property
    def duration(self) -> float:
        """Time of one step, in tau_s."""
        return self.block * self.problem.period

    def start(self, problem: Problem) -> np.ndarray:
        """Return the state at the start of a run."""
        return self._chart.unknowns(self._place(problem))

    def _place(self, problem: Problem) -> np.ndarray:
        return self._chart.place_of_six(np.concatenate(motion.start(problem)))

    def starts(self, y: np.ndarray, v: np.ndarray, phases: Sequence[float]) -> np.ndarray:
        """Return the states to which initial conditions lead."""
        found = []
        for phase, height, rate in product(phases, y, v):
            there = replace(self.problem, initial_phase=float(phase))
            begun = motion.state_at(there, float(height), float(rate))
            place = self._place(replace(there, initial_state=begun))
            place = moved_to_phase(there, place, self.problem.initial_phase)
            found.append(self._chart.unknowns(place))
        return np.array(found)

    def advance(self, states: np.ndarray, steps: int) -> np.ndarray:
        """Return states after some steps."""
        try:
            return self._ends(states, steps)
        except NoOrbit:
            if len(states) == 1:
                return np.full_like(states, np.nan)
        return np.concatenate([self.advance(state[None], steps) for state in states])

    def _ends(self, states: np.ndarray, steps: int) -> np.ndarray:
        if self._chart.rotation == HELD:
            return np.array([self._held(state, steps) for state in states])
        if steps not in self._motions:
            self._motions[steps] = ends(self.problem, steps * self.block)
        places = self._motions[steps](self._places(states))
        return np.array([self._chart.unknowns(place) for place in places])

    def _held(self, state: np.ndarray, steps: int) -> np.ndarray:
        for _ in range(steps):
            state = self._next(shot_from(self.problem, state, self.block, self._angle))
        return state

    def _next(self, shot: GeneralOrbit) -> np.ndarray:
        held = float(shot.state[0])
        return self._chart.carried_on(shot.start, shot.end, held, self.duration)

    def step(self, state: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
        """Return the state after a step, and factors of the Jacobian."""
        shot = shot_from(self.problem, state, self.block, self._angle)
        factors, kept = shot.factors, self._chart.kept
        factors[0] = factors[0] @ self._from_coordinates[kept]
        factors[-1] = self._to_coordinates[:, kept] @ factors[-1]
        return self._next(shot), factors

    def coordinates(self, states: np.ndarray) -> np.ndarray:
        """Return the coordinates of states."""
        return self._places(states) @ self._to_coordinates.T

    def displaced(self, states: np.ndarray, away: np.ndarray) -> np.ndarray:
        """Return displaced states."""
        places = self._places(states) + away @ self._from_coordinates.T
        return np.array(
            [
                self._chart.unknowns(place, float(state[0]))
                for place, state in zip(places, states, strict=True)
            ]
        )

    def _places(self, states: np.ndarray) -> np.ndarray:
        return np.array([self._chart.place(state, self._angle) for state in states])

    def orbit(self, state: np.ndarray, steps: int) -> GeneralOrbit:
        """Return the orbit near a state."""
        periods = steps * self.block
        if steps == 1 and self._common < self.block:
            try:
                return self._corrected(state, self._common)
            except NoOrbit:
                pass
        return self._corrected(state, periods)

    def _corrected(self, state: np.ndarray, periods: int) -> GeneralOrbit:
        state = self._chart.rescaled(state, self.block, periods)
        return correct(shot_from(self.problem, state, periods, self._angle))

    def state_of(self, orbit: Shot) -> np.ndarray:
        """Return the state of an orbit."""
        return self._chart.rescaled(orbit.state, orbit.periods, self.block)

    def runs(self, states: np.ndarray, periods: int) -> list[Problem]:
        """Return runs from states."""
        whole = self.block * math.ceil(periods / self.block)
        found = []
        for state, place in zip(states, self._places(states), strict=True):
            moments = self._chart.moments(self.problem, state, self.block)
            held = with_moments(self.problem, moments)
            found.append(held.over_periods(whole, whole, state_at_place(self.problem, place)))
        return found
