"""Slow and simple solutions of the equations of motion, to check the solvers against.

The equations are those of `independent_equations`. The methods too are others than the solvers':
SciPy's DOP853 between events that SciPy locates, and matrix exponentials.
"""

import itertools
from dataclasses import dataclass, replace
from math import pi

import numpy as np
from independent_equations import (
    CONTACT_LOSS,
    INVERSE_MESH,
    NORMAL_MESH,
    PHI_2,
    PHI_3,
    Y_2,
    Y_3,
    Z_2,
    Z_3,
    Mode,
    backlash,
    bodies,
    bracket,
    contact_force,
    deviates,
    distance,
    elastic,
    holding_force,
    pairs,
    phase_at,
    pitch_point,
    rates,
    relative_motion,
)
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

from gearmesh.model.problem import Problem

_TOLERANCE = 1e-12

_STEPS = 40
"""Least number of steps in a mesh period. The state at an event is that of SciPy's polynomial over
the step, whose error is not controlled: with 24 steps it reaches 1e-8."""

_BEHIND = 1e-12
"""How far behind an event the motion is if it has passed it, and not only reached it."""


def rest(problem: Problem) -> np.ndarray:
    """Return the state at rest with y = 1, the bearings loaded by F_st."""
    x = np.zeros(12)
    third, second = bodies(problem)
    x[Y_3], x[Y_2] = -1.0 / third.stiffness[0], 1.0 / second.stiffness[0]
    for _ in range(60):
        x[[PHI_3, PHI_2]] += 0.5 * (1.0 - relative_motion(problem, problem.start_time, x)[0])
    return x


@dataclass
class Course:
    """A run: strobes (n_periods + 1, 2) of y and y', extrema (n, 3) of time, y, kind; end state.

    `regimes` and `slips` list (time, new value) of each change; times count from the start.
    `partings` counts how often the flanks part while they overlap, or touch again, and `pressings`
    how often a pair of teeth touches or parts by itself.
    """

    strobes: np.ndarray
    extrema: np.ndarray
    state: np.ndarray
    regimes: list
    slips: list
    partings: int = 0
    pressings: int = 0


def integrate(
    problem: Problem,
    periods: int | None = None,
    share: float = 1.0,
) -> Course:
    """Integrate by DOP853 from event to event, over all mesh periods or the first `periods`.

    With `periods` = 1 the motion may end within the mesh period, after a `share` of it.

    The direction in which each event function passes 0 is part of the event, so the place where
    the last one was found is not found again.
    """
    run = _Run(problem)
    strobes = [run.relative_motion()]
    if periods is None:
        periods = problem.revolutions * bodies(problem)[0].teeth
    stops = [*(place for place in _stops(problem) if place < share), share]
    for n in range(periods):
        for low, high in itertools.pairwise(stops):
            run.mode = replace(run.mode, inside=n + 0.5 * (low + high) + problem.initial_phase)
            run.advance(_time_at(problem, n + high))
        strobes.append(run.relative_motion())
    return Course(
        np.array(strobes),
        np.array(run.extrema),
        run.state,
        run.regimes,
        run.slips,
        run.partings,
        run.pressings,
    )


def _time_at(problem: Problem, periods: float) -> float:
    """Return the time when the mesh has turned by so many mesh periods since the start."""
    if problem.final_nu is None:
        return (periods + problem.initial_phase) * problem.period
    begins = problem.start_time
    latest = begins + 1.01 * (2.0 * pi * periods) / min(problem.nu, problem.final_nu)

    def behind(t):
        return phase_at(problem, t) - problem.initial_phase - periods

    return brentq(behind, begins, latest, xtol=1e-13)


def _stops(problem: Problem) -> list[float]:
    """Return the places in <0; 1> where C(t) or gamma(t) jumps or has a kink."""
    half, terms = 0.5 * (problem.contact_ratio - 1.0), problem.terms
    begins = 0.5 - 0.5 * problem.contact_ratio
    points = len(terms.tooth_pair_stiffness)
    places = [half, begins + pitch_point(problem), 1.0 - half]
    places += [place for place, _ in terms.stiffness_table]
    length_3, length_2 = terms.tip_relief_length
    places += [begins + length_2, begins + problem.contact_ratio - length_3]
    places += [begins + problem.contact_ratio * i / (points - 1) for i in range(points)]
    inner = sorted({(place - problem.initial_phase) % 1.0 for place in places} | {0.0, 1.0})
    # Places that differ by rounding are one.
    return [0.0] + [b for a, b in itertools.pairwise(inner) if b - a > 1e-12]


class _Run:
    """A run between two calls of the ODE solver."""

    def __init__(self, problem):
        self.problem = problem
        self.longest = problem.period / _STEPS
        self.time = problem.start_time
        start = problem.initial_state
        self.state = np.array(start.coordinates) if start else rest(problem)
        positive = bracket(problem, self.time, self.state) >= 0.0
        self.mode = Mode(NORMAL_MESH, self.time / problem.period, 1 if positive else -1)
        total = problem.eccentricity_3 + problem.eccentricity_2
        self.has_signs = problem.friction_coefficient != 0.0 and total != 0.0
        if not self.has_signs:
            self.mode = Mode(NORMAL_MESH, self.time / problem.period)
        self.direction = 0
        self.extrema, self.regimes, self.slips = [], [], []
        self.partings = self.pressings = 0

    def relative_motion(self):
        return relative_motion(self.problem, self.time, self.state)

    def advance(self, end):
        if deviates(self.problem):
            y, _ = self.relative_motion()
            touching = [p for _, _, p in pairs(self.problem, self.mode.inside)]
            self._press(p for p in touching if y >= distance(self.problem, self.time, p))
        if self.has_signs:
            self._settle_slip()
        if self.problem.terms.non_adhesive and self.mode.regime != CONTACT_LOSS:
            force = contact_force(self.problem, self.time, self.state.tolist(), self.mode)
            self.mode = replace(self.mode, parted=self.mode.regime * force < 0.0)
        while self.time < end:
            self._settle_direction()
            events = self._events()
            solution = self._solved(end, list(events))
            self.time, self.state = solution.t[-1], solution.y[:, -1]
            for follow, found in zip(events.values(), solution.t_events, strict=True):
                if found.size:
                    follow()
        self.time = end

    def _solved(self, end, events):
        """Return the motion to the first event.

        SciPy sees an event only if a step ends behind it. A step may pass one and end at another,
        as where y turns a little below 0. It is then repeated with shorter steps.
        """
        options = {"method": "DOP853", "rtol": _TOLERANCE, "atol": _TOLERANCE, "events": events}
        longest, span = self.longest, (self.time, end)
        while True:
            solution = solve_ivp(self._rates, span, self.state, max_step=longest, **options)
            assert solution.success, solution.message
            last = solution.t[-1], solution.y[:, -1]
            missed = [
                event
                for event, found in zip(events, solution.t_events, strict=True)
                if not found.size and event.direction * event(*last) > _BEHIND
            ]
            if not missed:
                return solution
            longest *= 0.25

    def _rates(self, time, state):
        return rates(self.problem, time, state.tolist(), self.mode)

    def _settle_direction(self):
        """The velocity may be 0 at the start of the run; a short step then shows the direction."""
        if self.direction == 0:
            _, v = self.relative_motion()
            if v == 0.0:
                step = 1e-4
                ahead = self.state + step * np.array(self._rates(self.time, self.state))
                ahead[:6] += 0.5 * step**2 * np.array(self._rates(self.time, self.state))[6:]
                _, v = relative_motion(self.problem, self.time + step, ahead)
            self.direction = int(np.sign(v))

    def _events(self):
        """Return the event functions that can occur in the present mode, and what they do."""
        problem, mode = self.problem, self.mode

        def motion(t, x):
            return relative_motion(problem, t, x.tolist())

        events = {}

        def watch(function, direction, follow):
            function.terminal, function.direction = True, direction
            events[function] = follow

        if self.direction:
            watch(lambda t, x: motion(t, x)[1], -self.direction, self._turn)
        if deviates(problem) and mode.regime != INVERSE_MESH:
            for _, _, p in pairs(problem, mode.inside):
                watch(
                    lambda t, x, p=p: motion(t, x)[0] - distance(problem, t, p),
                    -1 if p in mode.pressing else 1,
                    lambda p=p: self._press({*mode.pressing} ^ {p}),
                )
        elif mode.regime == NORMAL_MESH:
            watch(lambda t, x: motion(t, x)[0], -1, lambda: self._enter(CONTACT_LOSS))
        elif mode.regime == INVERSE_MESH:
            watch(
                lambda t, x: motion(t, x)[0] + backlash(problem, t, x),
                1,
                lambda: self._enter(CONTACT_LOSS),
            )
        else:
            watch(lambda t, x: motion(t, x)[0], 1, lambda: self._enter(NORMAL_MESH))
        if mode.regime == CONTACT_LOSS:
            watch(
                lambda t, x: motion(t, x)[0] + backlash(problem, t, x),
                -1,
                lambda: self._enter(INVERSE_MESH),
            )
        if problem.terms.non_adhesive and mode.regime != CONTACT_LOSS:
            watch(
                lambda t, x: contact_force(problem, t, x.tolist(), mode),
                mode.regime if mode.parted else -mode.regime,
                self._part,
            )
        if self.has_signs:
            watch(
                lambda t, x: bracket(problem, t, x),
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
            and sum(gamma for gamma, _, _ in pairs(self.problem, self.mode.inside)) == 0.0
        )

    def _turn(self):
        y, _ = self.relative_motion()
        self.extrema.append((self.time - self.problem.start_time, y, self.direction))
        self.direction = -self.direction

    def _enter(self, regime):
        self.mode = replace(self.mode, regime=regime, parted=False)
        self.regimes.append((self.time - self.problem.start_time, regime))

    def _press(self, pressing):
        self.mode = replace(self.mode, pressing=tuple(sorted(pressing)))
        self.pressings += 1
        if self.mode.pressing and self.mode.regime != NORMAL_MESH:
            self._enter(NORMAL_MESH)
        elif not self.mode.pressing and self.mode.regime == NORMAL_MESH:
            self._enter(CONTACT_LOSS)

    def _part(self):
        self.mode = replace(self.mode, parted=not self.mode.parted)
        self.partings += 1

    def _available(self, time, state):
        """F_T at slip sign -1: what friction can hold with, negative where it drives."""
        problem = self.problem
        y, _ = relative_motion(problem, time, state)
        gamma = sum(gamma for gamma, _, _ in pairs(problem, self.mode.inside))
        force = elastic(problem, time, y, self.mode, state)
        return problem.friction_coefficient * force * gamma * self.mode.run_out_sign

    def _margin(self, time, state):
        needed = holding_force(self.problem, state)
        return self._available(time, state) - abs(needed)

    def _set_slip(self, slip):
        if slip != self.mode.slip_sign:
            self.mode = replace(self.mode, slip_sign=slip)
            self.slips.append((self.time - self.problem.start_time, slip))

    def _join(self):
        """Flanks that stick have one velocity; rounding leaves two."""
        if self.mode.slip_sign == 0:
            self.state[[6 + Z_3, 6 + Z_2]] = self.state[[6 + Z_3, 6 + Z_2]].mean()

    def _release(self):
        self._join()
        needed = holding_force(self.problem, self.state)
        self._set_slip(1 if needed <= 0.0 else -1)

    def _stop_sliding(self):
        self.state[[6 + Z_3, 6 + Z_2]] = self.state[[6 + Z_3, 6 + Z_2]].mean()
        self._settle_slip()

    def _flip_run_out_sign(self):
        self.mode = replace(self.mode, run_out_sign=-self.mode.run_out_sign)
        self._settle_slip()

    def _settle_slip(self):
        self._join()
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
    state = np.append(rest(problem), 1.0)
    period_map = np.eye(13)
    for low, high in itertools.pairwise(_stops(problem)):
        mode = Mode(NORMAL_MESH, 0.5 * (low + high) + problem.initial_phase)
        period_map = expm(_matrix(problem, mode) * (high - low) * problem.period) @ period_map
    strobes = [relative_motion(problem, 0.0, state)]
    for _ in range(problem.revolutions * problem.teeth):
        state = period_map @ state
        strobes.append(relative_motion(problem, 0.0, state))
    return np.array(strobes)


def _matrix(problem: Problem, mode: Mode) -> np.ndarray:
    """Return the matrix of the affine equations of motion, for the state and a 1 behind it."""

    matrix = np.zeros((13, 13))
    matrix[:12, 12] = rates(problem, 0.0, np.zeros(12), mode)
    for i in range(12):
        matrix[:12, i] = rates(problem, 0.0, np.eye(12)[i], mode) - matrix[:12, 12]
    return matrix


def energy(problem: Problem, state: np.ndarray, level: float) -> float:
    """Return the energy in F_st y_st at the constant mesh stiffness `level`, without run-out."""
    q, v = state[:6], state[6:]
    y, _ = relative_motion(problem, 0.0, state)
    inertia = np.array([2.0, 2.0] + 4 * [problem.body_mass])
    kinetic = 0.5 * np.sum(inertia * v**2)
    bearings = 0.5 * problem.bearing_stiffness * np.sum(q[2:] ** 2)
    depth = max(y, 0.0) + max(-problem.backlash - y, 0.0)
    return kinetic + bearings + 0.5 * level * depth**2 - (q[0] + q[1])


def period_map_trace(starts: np.ndarray, ends: np.ndarray) -> float:
    """Return the trace of an affine map from three points (y, y') and where they go, (3, 2)."""
    before, after = np.diff(starts, axis=0).T, np.diff(ends, axis=0).T
    return float(np.trace(after @ np.linalg.inv(before)))
