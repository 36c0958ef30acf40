"""The Poincaré map of a gear pair, whichever solver integrates it."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Protocol

import numpy as np

from gearmesh.dynamics.attraction.general_map import GeneralMap
from gearmesh.dynamics.periodic.orbits import Orbit, correct
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.dynamics.starts import initial_coordinates, initial_states
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem, State
from gearmesh.solvers.reduced.derivatives.period_map import (
    FIXED,
    Statement,
    passage_of,
    statement,
    trace,
)
from gearmesh.solvers.reduced.ensembles import advance, advance_to_phase, laws_of
from gearmesh.solvers.reduced.runs import is_reducible

WEIGHTS = np.array([1.0, 1.0, 0.01, 0.01])
"""Weights of y, y', b, b' in distances: the bodies hardly act on the mesh."""


class PoincareMap(Protocol):
    """The map from the state at the initial phase to the state after the excitation repeats.

    A state is a row of k numbers, which may contain what a drive has to know. The coordinates of a
    state are those m numbers of which deviations and Lyapunov exponents are made: y and y' (up to
    what the excitation adds), then those of the bodies.
    """

    @property
    def problem(self) -> Problem:
        """The gear pair, without an initial state."""

    @property
    def block(self) -> int:
        """Mesh periods of one step."""

    @property
    def weights(self) -> np.ndarray:
        """Weights of the coordinates in distances, shape (m,)."""

    @property
    def duration(self) -> float | np.ndarray:
        """Time of one step, in tau_s."""

    def start(self, problem: Problem) -> np.ndarray:
        """Return the state at the start of a run of the same gear pair, shape (k,)."""

    def starts(self, y: np.ndarray, v: np.ndarray, phases: Sequence[float]) -> np.ndarray:
        """Return the states to which a grid of initial conditions leads, shape (n, k).

        They start at the mesh phases, the bodies in static equilibrium, and are taken at the
        initial phase of the problem.
        """

    def advance(self, states: np.ndarray, steps: int) -> np.ndarray:
        """Move states, shape (n, k), ahead by some steps. A run that fails gives not-a-number."""

    def step(self, state: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
        """Return the state after a step, and factors of the Jacobian of the coordinates.

        The Jacobian is the product of the factors, the last one first. There is one for each mesh
        period, so that small numbers are resolved, too. Raises NoOrbit if the motion fails.
        """

    def coordinates(self, states: np.ndarray) -> np.ndarray:
        """Return the coordinates of states of shape (n, k), shape (n, m)."""

    def displaced(self, states: np.ndarray, away: np.ndarray) -> np.ndarray:
        """Return states whose coordinates are displaced by `away`, of shape (n, m)."""

    def orbit(self, state: np.ndarray, steps: int) -> Shot:
        """Return the orbit of so many steps near a state; raises NoOrbit if there is none."""

    def state_of(self, orbit: Shot) -> np.ndarray:
        """Return the state of an orbit, shape (k,)."""

    def runs(self, states: np.ndarray, periods: int) -> list[Problem]:
        """Return runs over at least so many mesh periods from states, all of them kept."""


class ReducedMap:
    """The map of the reduced system over a mesh period: y, y', b, b' and exact Jacobians.

    See `PoincareMap` for the methods.

    Parameters
    ----------
    problems : sequence of Problem
        Of all states, or of each.
    """

    block = 1
    weights = WEIGHTS

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = [replace(one, initial_state=None) for one in problems]
        self.problem = self.problems[0]

    @cached_property
    def _laws(self) -> np.ndarray:
        return laws_of(self.problems)

    @cached_property
    def _stated(self) -> Statement:
        return statement(self.problem)

    @property
    def duration(self) -> np.ndarray:
        """Time of one step, in tau_s."""
        return self._laws["period"]

    def start(self, problem: Problem) -> np.ndarray:
        """Return the state at the start of a run."""
        return initial_coordinates(problem)

    def starts(self, y: np.ndarray, v: np.ndarray, phases: Sequence[float]) -> np.ndarray:
        """Return the states to which initial conditions lead."""
        begun = np.tile(initial_states(self.problem, y, v), (len(phases), 1))
        return advance_to_phase(self.problem, np.repeat(phases, len(y) * len(v)), begun)

    def advance(self, states: np.ndarray, steps: int) -> np.ndarray:
        """Return states after some steps."""
        return advance(self._laws, states, steps)

    def step(self, state: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
        """Return the state after a step, and factors of the Jacobian."""
        points, events, _ = trace(self._stated, np.append(state, 1.0), FIXED, self.problem.nu)
        moved = passage_of(self._stated, self.problem.nu, points[0], events[0])
        if moved.status != "complete":
            raise NoOrbit(f"the motion ends with {moved.status}")
        return moved.end, [moved.jacobian]

    def coordinates(self, states: np.ndarray) -> np.ndarray:
        """Return the coordinates of states."""
        return states

    def displaced(self, states: np.ndarray, away: np.ndarray) -> np.ndarray:
        """Return displaced states."""
        return states + away

    def orbit(self, state: np.ndarray, steps: int) -> Orbit:
        """Return the orbit near a state."""
        return correct(self.problem, state, steps)

    def state_of(self, orbit: Shot) -> np.ndarray:
        """Return the state of an orbit."""
        return orbit.state

    def runs(self, states: np.ndarray, periods: int) -> list[Problem]:
        """Return runs from states."""
        several = self.problems if len(self.problems) > 1 else self.problems * len(states)
        return [
            replace(
                problem,
                revolutions=revolutions,
                kept_revolutions=revolutions,
                initial_state=State(*state),
            )
            for problem, state in zip(several, states.tolist(), strict=True)
            for revolutions in (math.ceil(periods / problem.teeth),)
        ]


def map_of(problem: Problem) -> PoincareMap:
    """Return the Poincaré map of a gear pair.

    Raises
    ------
    NoOrbit
        If the excitation does not repeat.
    """
    return ReducedMap([problem]) if is_reducible(problem) else GeneralMap(problem)
