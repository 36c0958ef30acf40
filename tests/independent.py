"""Slow and simple solutions of the equations of motion, to check the solvers against.

The equations are stated here afresh, from the paper, and the library is asked for nothing but the
statement of a run. The methods too are others than the solvers': SciPy's DOP853 between events
that SciPy locates, and matrix exponentials.
"""

import itertools
from dataclasses import dataclass, replace
from math import copysign, cos, pi, sin, sqrt, tan

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from gearmesh.model.problem import Problem

PHI_3, PHI_2, Y_3, Y_2, Z_3, Z_2 = range(6)
"""Places of R_b phi_3, R_b phi_2, y_3, y_2, z_3, z_2 in the state; their rates come behind."""

NORMAL_MESH, CONTACT_LOSS, INVERSE_MESH = 1, 0, -1


@dataclass(frozen=True)
class Mode:
    """Which branch of the laws acts; `inside` is any mesh phase between the same switches."""

    regime: int
    inside: float
    run_out_sign: int = 1
    slip_sign: int = 1


def relative_motion(problem: Problem, t: float, x) -> tuple[float, float]:
    """Return y of eq. (3) and its rate in the state `x`, shape (12,)."""
    e_3, e_2, radius = problem.eccentricity_3, problem.eccentricity_2, problem.base_radius
    omega = problem.nu / problem.teeth
    total_3, total_2 = omega * t + x[PHI_3] / radius, omega * t + x[PHI_2] / radius
    speed_3, speed_2 = omega + x[6 + PHI_3] / radius, omega + x[6 + PHI_2] / radius
    behind = problem.eccentricity_angle - total_2
    y = x[PHI_3] + x[PHI_2] + x[Y_3] - x[Y_2] + e_3 * sin(total_3) - e_2 * sin(behind)
    rate = x[6 + PHI_3] + x[6 + PHI_2] + x[6 + Y_3] - x[6 + Y_2]
    rate += e_3 * speed_3 * cos(total_3) + e_2 * speed_2 * cos(behind)
    for n, (a, b) in enumerate(problem.deviation, start=1):
        angle = n * problem.nu * t
        y += a * cos(angle) + b * sin(angle)
        rate += n * problem.nu * (b * cos(angle) - a * sin(angle))
    return y, rate


def bracket(problem: Problem, t: float, x) -> float:
    """Return e_3 Phi_3' sin Phi_3 - e_2 Phi_2' sin(Delta - Phi_2) of eq. (6)."""
    omega, radius = problem.nu / problem.teeth, problem.base_radius
    turned_3, turned_2 = omega * t + x[PHI_3] / radius, omega * t + x[PHI_2] / radius
    first = problem.eccentricity_3 * (omega + x[6 + PHI_3] / radius) * sin(turned_3)
    second = problem.eccentricity_2 * (omega + x[6 + PHI_2] / radius)
    return first - second * sin(problem.eccentricity_angle - turned_2)


def pairs(problem: Problem, inside: float) -> list[tuple[float, float]]:
    """Return gamma and the distance behind the pitch point in base pitches of each pair."""
    place = inside % 1.0
    half = 0.5 * (problem.contact_ratio - 1.0)
    if half <= place <= 1.0 - half:
        return [(copysign(1.0, 0.5 - place), place - 0.5)]
    leaving = place + 0.5 if place < 0.5 else place - 0.5
    return [(-0.5, leaving), (0.5, leaving - 1.0)]


def stiffness(problem: Problem, t: float, inside: float) -> float:
    """Return C / C_s, by eq. (4) if it is cut, else by its sum."""
    high, low, share = problem.stiffness_max, problem.stiffness_min, problem.contact_ratio - 1.0
    if not problem.stiffness_harmonics:
        return high if len(pairs(problem, inside)) == 2 else low
    c = low + (high - low) * share
    for n in range(1, problem.stiffness_harmonics + 1):
        c += 2.0 * (high - low) * sin(n * pi * share) / (n * pi) * cos(n * problem.nu * t)
    return c


def elastic(problem: Problem, t: float, y: float, mode: Mode) -> float:
    """Return C (y H1 + (y + s) H2)."""
    depth = {NORMAL_MESH: y, CONTACT_LOSS: 0.0, INVERSE_MESH: y + problem.backlash}[mode.regime]
    return stiffness(problem, t, mode.inside) * depth


def bearing(problem: Problem, displacement: float, rate: float) -> float:
    """Return the force of a bearing on its body."""
    c, m = problem.bearing_stiffness, problem.body_mass
    return -c * displacement - 2.0 * problem.bearing_damping_ratio * sqrt(c * m) * rate


def holding_force(problem: Problem, x) -> float:
    """Return the F_T with which z_3'' = z_2''."""
    return -0.5 * bearing(problem, x[Z_3] - x[Z_2], x[6 + Z_3] - x[6 + Z_2])


def rates(problem: Problem, t: float, x, mode: Mode) -> list[float]:
    """Return the derivative of the state, eq. (1)."""
    y, v = relative_motion(problem, t, x)
    force = elastic(problem, t, y, mode)
    k_1, k_2, k_3 = problem.lubricant if mode.regime == CONTACT_LOSS else problem.material
    normal = force + k_1 * v + k_2 * abs(v) * v + k_3 * v**3
    signs = mode.run_out_sign * mode.slip_sign
    moved = t / problem.period - mode.inside
    moved -= round(moved)
    f_t = moment_3 = moment_2 = 0.0
    for gamma, sigma in pairs(problem, mode.inside):
        pair = -problem.friction_coefficient * force * gamma * signs
        if mode.slip_sign == 0:
            pair = holding_force(problem, x)
        shift = 2.0 * pi / problem.teeth * (sigma + moved)
        f_t += pair
        moment_3 -= (tan(problem.pressure_angle) + shift) * pair
        moment_2 -= (tan(problem.pressure_angle) - shift) * pair
    omega, radius = problem.nu / problem.teeth, problem.base_radius
    lever_3 = 1.0 + problem.eccentricity_3 / radius * cos(omega * t + x[PHI_3] / radius)
    behind = problem.eccentricity_angle - omega * t - x[PHI_2] / radius
    lever_2 = 1.0 + problem.eccentricity_2 / radius * cos(behind)
    supports = [bearing(problem, x[i], x[6 + i]) for i in range(6)]
    # Each wheel has twice the reduced mass of the pair.
    return [
        *x[6:],
        (1.0 - lever_3 * normal + moment_3) / 2.0,
        (1.0 - lever_2 * normal + moment_2) / 2.0,
        (supports[Y_3] - normal) / problem.body_mass,
        (supports[Y_2] + normal) / problem.body_mass,
        (supports[Z_3] + f_t) / problem.body_mass,
        (supports[Z_2] - f_t) / problem.body_mass,
    ]


def rest(problem: Problem) -> np.ndarray:
    """Return the state at rest with y = 1, the bearings loaded by F_st."""
    x = np.zeros(12)
    x[Y_3], x[Y_2] = -1.0 / problem.bearing_stiffness, 1.0 / problem.bearing_stiffness
    for _ in range(60):
        x[[PHI_3, PHI_2]] += 0.5 * (1.0 - relative_motion(problem, problem.start_time, x)[0])
    return x


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
            run.mode = replace(run.mode, inside=0.5 * (low + high) + problem.initial_phase)
            run.advance((n + high + problem.initial_phase) * problem.period)
        strobes.append(run.relative_motion())
    return Course(np.array(strobes), np.array(run.extrema), run.state, run.regimes, run.slips)


def _stops(problem: Problem) -> list[float]:
    half = 0.5 * (problem.contact_ratio - 1.0)
    places = [half, 0.5, 1.0 - half]
    inner = {(place - problem.initial_phase) % 1.0 for place in places}
    return sorted(inner | {0.0, 1.0})


class _Run:
    """A run between two calls of the ODE solver."""

    def __init__(self, problem, rtol, max_step):
        self.problem = problem
        self.options = {"method": "DOP853", "rtol": rtol, "atol": rtol, "max_step": max_step}
        self.time = problem.start_time
        assert problem.initial_state is None
        self.state = rest(problem)
        positive = bracket(problem, self.time, self.state) >= 0.0
        self.mode = Mode(NORMAL_MESH, self.time / problem.period, 1 if positive else -1)
        total = problem.eccentricity_3 + problem.eccentricity_2
        self.has_signs = problem.friction_coefficient != 0.0 and total != 0.0
        if not self.has_signs:
            self.mode = Mode(NORMAL_MESH, self.time / problem.period)
        self.direction = 0
        self.extrema, self.regimes, self.slips = [], [], []

    def relative_motion(self):
        return relative_motion(self.problem, self.time, self.state)

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
            and len(pairs(self.problem, self.mode.inside)) == 2
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
        y, _ = relative_motion(problem, time, state)
        gamma = sum(gamma for gamma, _ in pairs(problem, self.mode.inside))
        force = elastic(problem, time, y, self.mode)
        return problem.friction_coefficient * force * gamma * self.mode.run_out_sign

    def _margin(self, time, state):
        needed = holding_force(self.problem, state)
        return self._available(time, state) - abs(needed)

    def _set_slip(self, slip):
        if slip != self.mode.slip_sign:
            self.mode = replace(self.mode, slip_sign=slip)
            self.slips.append((self.time - self.problem.start_time, slip))

    def _release(self):
        needed = holding_force(self.problem, self.state)
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
