"""Slow and simple solutions of the equations of motion, to check the solvers against.

They take the right-hand side of `gearmesh.model.motion` and methods that the solvers do not use:
SciPy's DOP853 between events that SciPy locates, and matrix exponentials.
"""

import itertools
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from gearmesh.model import stiffness
from gearmesh.model.friction import follows_run_out, mesh_gamma
from gearmesh.model.motion import (
    CONTACT_LOSS,
    INVERSE_MESH,
    NORMAL_MESH,
    Z_2,
    Z_3,
    Mode,
    Problem,
    accelerations,
    elastic_force,
    holding_force,
    mesh_phase,
    mesh_stiffness,
    mode_of,
    relative_motion,
    run_out_argument,
    start,
)


@dataclass
class Course:
    """A run: strobes (n_periods + 1, 2) of y and y', extrema (n, 3) of time, y, kind; end state.

    `regimes` and `slips` list (time, new value) of each change; times count from the start.
    """

    strobes: np.ndarray
    extrema: np.ndarray
    state: np.ndarray
    regimes: list
    slips: list


def integrate(
    problem: Problem, periods: int | None = None, rtol: float = 1e-12, steps_per_period: int = 40
) -> Course:
    """Integrate by DOP853 from event to event, over all mesh periods or the first `periods`.

    The direction in which each event function passes 0 is part of the event, so the place where
    the last one was found is not found again.
    """
    run = _Run(problem, rtol, problem.period / steps_per_period)
    strobes = [run.relative_motion()]
    if periods is None:
        periods = problem.revolutions * problem.teeth
    stops = _stops(problem)
    for n in range(periods):
        for low, high in itertools.pairwise(stops):
            run.mode = replace(run.mode, stretch=0.5 * (low + high) + problem.initial_phase)
            run.advance((n + high + problem.initial_phase) * problem.period)
        strobes.append(run.relative_motion())
    return Course(np.array(strobes), np.array(run.extrema), run.state, run.regimes, run.slips)


def _stops(problem: Problem) -> list[float]:
    places = [*stiffness.switch_phases(problem.contact_ratio), 0.5]
    inner = {(place - problem.initial_phase) % 1.0 for place in places}
    return sorted(inner | {0.0, 1.0})


class _Run:
    """A run between two calls of the ODE solver."""

    def __init__(self, problem, rtol, max_step):
        self.problem = problem
        self.options = {"method": "DOP853", "rtol": rtol, "atol": rtol, "max_step": max_step}
        self.time = problem.start_time
        q, v = start(problem)
        self.state = np.concatenate([q, v])
        self.mode = mode_of(problem, self.time, q, v)
        self.has_signs = problem.friction_coefficient != 0.0 and follows_run_out(
            problem.eccentricity_3, problem.eccentricity_2
        )
        self.direction = 0
        self.extrema, self.regimes, self.slips = [], [], []

    def relative_motion(self):
        return relative_motion(self.problem, self.time, self.state[:6], self.state[6:])

    def advance(self, end):
        if self.has_signs:
            self._settle_slip()
        while self.time < end:
            self._settle_direction()
            events = self._events()
            solution = solve_ivp(
                self._rates, (self.time, end), self.state, events=list(events), **self.options
            )
            assert solution.success, solution.message
            self.time, self.state = solution.t[-1], solution.y[:, -1]
            for follow, found in zip(events.values(), solution.t_events, strict=True):
                if found.size:
                    follow()
        self.time = end

    def _rates(self, time, state):
        q, v = state[:6].tolist(), state[6:].tolist()
        return [*v, *accelerations(self.problem, time, q, v, self.mode)]

    def _settle_direction(self):
        """At the start of the run the velocity may be 0: then a short way tells the direction."""
        if self.direction == 0:
            _, v = self.relative_motion()
            if v == 0.0:
                step = 1e-4
                ahead = self.state + step * np.array(self._rates(self.time, self.state))
                ahead[:6] += 0.5 * step**2 * np.array(self._rates(self.time, self.state))[6:]
                _, v = relative_motion(self.problem, self.time + step, ahead[:6], ahead[6:])
            self.direction = int(np.sign(v))

    def _events(self):
        """Return the event functions that can occur in the present mode, and what they do."""
        problem, mode = self.problem, self.mode

        def motion(t, x):
            return relative_motion(problem, t, x[:6].tolist(), x[6:].tolist())

        events = {}

        def watch(function, direction, follow):
            function.terminal, function.direction = True, direction
            events[function] = follow

        if self.direction:
            watch(lambda t, x: motion(t, x)[1], -self.direction, self._turn)
        if mode.regime == NORMAL_MESH:
            watch(lambda t, x: motion(t, x)[0], -1, lambda: self._enter(CONTACT_LOSS))
        elif mode.regime == INVERSE_MESH:
            watch(
                lambda t, x: motion(t, x)[0] + problem.backlash,
                1,
                lambda: self._enter(CONTACT_LOSS),
            )
        else:
            watch(lambda t, x: motion(t, x)[0], 1, lambda: self._enter(NORMAL_MESH))
            watch(
                lambda t, x: motion(t, x)[0] + problem.backlash,
                -1,
                lambda: self._enter(INVERSE_MESH),
            )
        if self.has_signs:
            watch(
                lambda t, x: run_out_argument(problem, t, x[:6], x[6:]),
                -mode.run_out_sign,
                self._flip_run_out_sign,
            )
            if mode.slip_sign and not self._rests():
                watch(lambda t, x: x[6 + Z_3] - x[6 + Z_2], -mode.slip_sign, self._stop_sliding)
            if not mode.slip_sign:
                watch(lambda t, x: self._margin(t, x), -1, self._release)
        return events

    def _rests(self):
        """Nothing moves the wheels across the mesh line: unloaded bearings, and no friction."""
        z, rates = self.state[[Z_3, Z_2]], self.state[[6 + Z_3, 6 + Z_2]]
        return (
            z[0] == z[1]
            and rates[0] == rates[1]
            and self._available(self.time, self.state) == 0.0
            and mesh_gamma(self.mode.stretch, self.problem.contact_ratio) == 0.0
        )

    def _turn(self):
        y, _ = self.relative_motion()
        self.extrema.append((self.time - self.problem.start_time, y, self.direction))
        self.direction = -self.direction

    def _enter(self, regime):
        self.mode = replace(self.mode, regime=regime)
        self.regimes.append((self.time - self.problem.start_time, regime))

    def _available(self, time, state):
        """F_T at slip sign -1: what friction can hold with, negative where it drives."""
        problem = self.problem
        y, _ = relative_motion(problem, time, state[:6], state[6:])
        c = mesh_stiffness(problem, mesh_phase(problem, time), self.mode.stretch)
        gamma = mesh_gamma(self.mode.stretch, problem.contact_ratio)
        elastic = elastic_force(problem, y, c, self.mode.regime)
        return problem.friction_coefficient * elastic * gamma * self.mode.run_out_sign

    def _margin(self, time, state):
        needed = holding_force(self.problem, state[:6], state[6:])
        return self._available(time, state) - abs(needed)

    def _set_slip(self, slip):
        if slip != self.mode.slip_sign:
            self.mode = replace(self.mode, slip_sign=slip)
            self.slips.append((self.time - self.problem.start_time, slip))

    def _release(self):
        needed = holding_force(self.problem, self.state[:6], self.state[6:])
        self._set_slip(1 if needed <= 0.0 else -1)

    def _stop_sliding(self):
        self.state[[6 + Z_3, 6 + Z_2]] = self.state[[6 + Z_3, 6 + Z_2]].mean()
        self._settle_slip()

    def _flip_run_out_sign(self):
        self.mode = replace(self.mode, run_out_sign=-self.mode.run_out_sign)
        self._settle_slip()

    def _settle_slip(self):
        if self.state[6 + Z_3] != self.state[6 + Z_2]:
            return
        holds = self._margin(self.time, self.state) >= 0.0
        if holds and self._available(self.time, self.state) > 0.0:
            self._set_slip(0)
        else:
            self._release()


def linear_strobes(problem: Problem) -> np.ndarray:
    """Return y and y' at the boundaries, shape (n_periods + 1, 2), by matrix exponentials.

    For linear damping in normal mesh throughout, without friction, run-out and deviation.
    """
    q, v = start(problem)
    state = np.concatenate([q, v, [1.0]])
    period_map = np.eye(13)
    for low, high in itertools.pairwise(_stops(problem)):
        mode = Mode(NORMAL_MESH, 0.5 * (low + high) + problem.initial_phase)
        period_map = expm(_matrix(problem, mode) * (high - low) * problem.period) @ period_map
    strobes = [relative_motion(problem, 0.0, state[:6], state[6:12])]
    for _ in range(problem.revolutions * problem.teeth):
        state = period_map @ state
        strobes.append(relative_motion(problem, 0.0, state[:6], state[6:12]))
    return np.array(strobes)


def _matrix(problem: Problem, mode: Mode) -> np.ndarray:
    """Return the matrix of the affine equations of motion, for the state and a 1 behind it."""

    def rates(state):
        return np.concatenate([state[6:], accelerations(problem, 0.0, state[:6], state[6:], mode)])

    matrix = np.zeros((13, 13))
    matrix[:12, 12] = rates(np.zeros(12))
    for i in range(12):
        matrix[:12, i] = rates(np.eye(12)[i]) - matrix[:12, 12]
    return matrix


def energy(problem: Problem, state: np.ndarray, level: float) -> float:
    """Return the energy in F_st y_st at the constant mesh stiffness `level`, without run-out."""
    q, v = state[:6], state[6:]
    y, _ = relative_motion(problem, 0.0, q, v)
    inertia = np.array([2.0, 2.0] + 4 * [problem.body_mass])
    kinetic = 0.5 * np.sum(inertia * v**2)
    bearings = 0.5 * problem.bearing_stiffness * np.sum(q[2:] ** 2)
    depth = max(y, 0.0) + max(-problem.backlash - y, 0.0)
    return kinetic + bearings + 0.5 * level * depth**2 - (q[0] + q[1])


def period_map_trace(starts: np.ndarray, ends: np.ndarray) -> float:
    """Return the trace of an affine map from three points (y, y') and where they go, (3, 2)."""
    before, after = np.diff(starts, axis=0).T, np.diff(ends, axis=0).T
    return float(np.trace(after @ np.linalg.inv(before)))
