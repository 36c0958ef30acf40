"""Slow and simple solutions of the equations of motion, to check the solvers against.

The equations are stated here afresh, from the paper, and the library is asked for nothing but the
statement of a run. The methods too are others than the solvers': SciPy's DOP853 between events
that SciPy locates, and matrix exponentials.
"""

import itertools
from dataclasses import dataclass, replace
from math import copysign, cos, floor, pi, sin, sqrt, tan

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
    parted: bool = False


class Body:
    """What eq. (1) takes of one wheel: numbers in y_st, F_st and m_red."""

    def __init__(self, problem: Problem, place: int) -> None:
        wheel = problem.wheels[place] if problem.wheels else None
        self.teeth = wheel.teeth if wheel else problem.teeth
        self.radius = wheel.base_radius if wheel else problem.base_radius
        # Each of two equal wheels has twice the reduced mass of the pair.
        self.inertia = wheel.inertia if wheel else 2.0
        self.mass = wheel.body_mass if wheel else problem.body_mass
        self.stiffness = wheel.bearing_stiffness if wheel else (problem.bearing_stiffness,) * 2
        ratios = wheel.bearing_damping_ratio if wheel else (problem.bearing_damping_ratio,) * 2
        self.damping = [
            2.0 * d * sqrt(c * self.mass) for d, c in zip(ratios, self.stiffness, strict=True)
        ]
        self.omega = problem.nu / self.teeth


def kept(function):
    """Remember what a function of a problem returns, by the identity of the problem."""
    known = {}

    def remembered(problem):
        if id(problem) not in known:
            known[id(problem)] = problem, function(problem)
        return known[id(problem)][1]

    return remembered


@kept
def bodies(problem: Problem) -> tuple[Body, Body]:
    return Body(problem, 0), Body(problem, 1)


def series_of(harmonics, angle: float) -> float:
    """Return the sum of (order, cosine, sine) at the angle nu t."""
    return sum(a * cos(n * angle) + b * sin(n * angle) for n, a, b in harmonics)


def backlash(problem: Problem, t: float) -> float:
    return problem.backlash + series_of(problem.terms.backlash_harmonics, problem.nu * t)


def relative_motion(problem: Problem, t: float, x) -> tuple[float, float]:
    """Return y of eq. (3) and its rate in the state `x`, shape (12,)."""
    e_3, e_2 = problem.eccentricity_3, problem.eccentricity_2
    third, second = bodies(problem)
    total_3 = third.omega * t + x[PHI_3] / third.radius
    behind = problem.eccentricity_angle - second.omega * t - x[PHI_2] / second.radius
    speed_3 = third.omega + x[6 + PHI_3] / third.radius
    speed_2 = second.omega + x[6 + PHI_2] / second.radius
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
    third, second = bodies(problem)
    turned_3 = third.omega * t + x[PHI_3] / third.radius
    turned_2 = second.omega * t + x[PHI_2] / second.radius
    one = problem.eccentricity_3 * (third.omega + x[6 + PHI_3] / third.radius) * sin(turned_3)
    two = problem.eccentricity_2 * (second.omega + x[6 + PHI_2] / second.radius)
    return one - two * sin(problem.eccentricity_angle - turned_2)


@kept
def pitch_point(problem: Problem) -> float:
    """Return how far the path of a pair has run at the pitch point, in base pitches.

    A pair of standard wheels enters on the tip circle of wheel 2 and leaves on that of wheel 3. In
    modules; on the mesh line no point beyond the base circles is reached.
    """
    z_3, z_2 = (body.teeth for body in bodies(problem))
    alpha = problem.pressure_angle

    def to_tip(z, other):
        tip = sqrt((z / 2 + 1) ** 2 - (z / 2 * cos(alpha)) ** 2) - z / 2 * sin(alpha)
        return min(tip, other / 2 * sin(alpha))

    before, behind = to_tip(z_2, z_3), to_tip(z_3, z_2)
    return problem.contact_ratio * before / (before + behind)


def pairs(problem: Problem, inside: float) -> list[tuple[float, float, int]]:
    """Return gamma, the distance behind the pitch point in base pitches, and number of each pair.

    Pair p is at the middle of its path at the phase p + 1/2.
    """
    length = problem.contact_ratio
    found = []
    for p in range(floor(inside) - 2, floor(inside) + 3):
        passed = inside - (p + 0.5 - 0.5 * length)
        if 0.0 <= passed <= length:
            found.append((passed - pitch_point(problem), p))
    return [(-copysign(1.0, sigma) / len(found), sigma, p) for sigma, p in found]


def tooth_factor(problem: Problem, p: int) -> float:
    product = 1.0
    for wheel, tooth, factor in problem.terms.tooth_factors:
        if p % bodies(problem)[3 - wheel].teeth == tooth:
            product *= factor
    return product


def stiffness(problem: Problem, t: float, inside: float) -> float:
    """Return C / C_s: of the mesh, by eq. (4) if it is cut, else by its sum; or of its pairs."""
    terms, length = problem.terms, problem.contact_ratio
    touching = pairs(problem, inside)
    phase = t / problem.period
    phase -= round(phase - inside)
    if terms.tooth_pair_stiffness:
        values = terms.tooth_pair_stiffness
        total = 0.0
        for _, _, p in touching:
            # The piece of the table is that of `inside`; the place on it is that of t.
            start = p + 0.5 - 0.5 * length
            piece = min(int((inside - start) / length * (len(values) - 1)), len(values) - 2)
            share = (phase - start) / length * (len(values) - 1) - piece
            at = values[piece] + share * (values[piece + 1] - values[piece])
            total += at * tooth_factor(problem, p)
        return total
    if terms.stiffness_table:
        for (low, before), (high, after) in itertools.pairwise(terms.stiffness_table):
            if low <= inside % 1.0 <= high and low < high:
                within = phase - floor(inside) - low
                c = before + (after - before) * within / (high - low)
                break
    else:
        high, low, share = problem.stiffness_max, problem.stiffness_min, length - 1.0
        c = low + (high - low) * share
        if not problem.stiffness_harmonics and not terms.stiffness_fourier:
            c = high if len(touching) == 2 else low
        for n in range(1, problem.stiffness_harmonics + 1):
            c += 2.0 * (high - low) * sin(n * pi * share) / (n * pi) * cos(n * problem.nu * t)
        for n, (a, b) in enumerate(terms.stiffness_fourier, start=1):
            c += a * cos(n * problem.nu * t) + b * sin(n * problem.nu * t)
    return c * sum(tooth_factor(problem, p) for _, _, p in touching) / len(touching)


def elastic(problem: Problem, t: float, y: float, mode: Mode) -> float:
    """Return C (d + c_2 d |d| + c_3 d^3) of the depth d."""
    if mode.regime == CONTACT_LOSS:
        return 0.0
    d = y if mode.regime == NORMAL_MESH else y + backlash(problem, t)
    softening = problem.terms.restoring_2 * abs(d) * d + problem.terms.restoring_3 * d**3
    return stiffness(problem, t, mode.inside) * (d + softening)


def contact_force(problem: Problem, t: float, x, mode: Mode) -> float:
    """Return elastic and damping force, eqs. (1) and (7), of flanks in contact or of the film."""
    y, v = relative_motion(problem, t, x)
    k_1, k_2, k_3 = problem.lubricant if mode.regime == CONTACT_LOSS else problem.material
    damping = k_1 * v + k_2 * abs(v) * v + k_3 * v**3
    if mode.regime != CONTACT_LOSS and problem.terms.damping_power:
        damping *= stiffness(problem, t, mode.inside) ** problem.terms.damping_power
    return elastic(problem, t, y, mode) + damping


def bearing(problem: Problem, i: int, x) -> float:
    """Return the force of a bearing on its body."""
    body, across = bodies(problem)[i % 2], i // 2 - 1
    return -body.stiffness[across] * x[i] - body.damping[across] * x[6 + i]


def holding_force(problem: Problem, x) -> float:
    """Return the F_T with which z_3'' = z_2''."""
    m_3, m_2 = (body.mass for body in bodies(problem))
    difference = bearing(problem, Z_2, x) / m_2 - bearing(problem, Z_3, x) / m_3
    return difference / (1.0 / m_3 + 1.0 / m_2)


def rates(problem: Problem, t: float, x, mode: Mode) -> list[float]:
    """Return the derivative of the state, eq. (1)."""
    y, _ = relative_motion(problem, t, x)
    force = 0.0 if mode.parted else elastic(problem, t, y, mode)
    normal = 0.0 if mode.parted else contact_force(problem, t, x, mode)
    signs = mode.run_out_sign * mode.slip_sign
    third, second = bodies(problem)
    moved = t / problem.period - mode.inside
    moved -= round(moved)
    f_t = moment_3 = moment_2 = 0.0
    touching = pairs(problem, mode.inside)
    for gamma, sigma, _ in touching:
        pair = -problem.friction_coefficient * force * gamma * signs
        if mode.slip_sign == 0:
            pair = holding_force(problem, x) / len(touching)
        f_t += pair
        middle, shift = tan(problem.pressure_angle), 2.0 * pi * (sigma + moved)
        moment_3 -= (middle + shift / third.teeth) * pair
        moment_2 -= (middle - shift / second.teeth) * pair
    lever_3 = 1.0 + problem.eccentricity_3 / third.radius * cos(
        third.omega * t + x[PHI_3] / third.radius
    )
    behind = problem.eccentricity_angle - second.omega * t - x[PHI_2] / second.radius
    lever_2 = 1.0 + problem.eccentricity_2 / second.radius * cos(behind)
    terms = problem.terms
    load_3 = 1.0 + series_of(terms.torque_harmonics_3, problem.nu * t)
    load_2 = 1.0 + series_of(terms.torque_harmonics_2, problem.nu * t)
    load_3 -= terms.torsional_damping[0] * x[6 + PHI_3]
    load_2 -= terms.torsional_damping[1] * x[6 + PHI_2]
    supports = [bearing(problem, i, x) if i > 1 else 0.0 for i in range(6)]
    return [
        *x[6:],
        (load_3 - lever_3 * normal + moment_3) / third.inertia,
        (load_2 - lever_2 * normal + moment_2) / second.inertia,
        (supports[Y_3] - normal) / third.mass,
        (supports[Y_2] + normal) / second.mass,
        (supports[Z_3] + f_t) / third.mass,
        (supports[Z_2] - f_t) / second.mass,
    ]


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
    `partings` counts how often the flanks part while they overlap, or touch again.
    """

    strobes: np.ndarray
    extrema: np.ndarray
    state: np.ndarray
    regimes: list
    slips: list
    partings: int = 0


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
        periods = problem.revolutions * bodies(problem)[0].teeth
    stops = _stops(problem)
    for n in range(periods):
        for low, high in itertools.pairwise(stops):
            run.mode = replace(run.mode, inside=n + 0.5 * (low + high) + problem.initial_phase)
            run.advance((n + high + problem.initial_phase) * problem.period)
        strobes.append(run.relative_motion())
    return Course(
        np.array(strobes), np.array(run.extrema), run.state, run.regimes, run.slips, run.partings
    )


def _stops(problem: Problem) -> list[float]:
    """Return the places in <0; 1> where C(t) or gamma(t) jumps or has a kink."""
    half, terms = 0.5 * (problem.contact_ratio - 1.0), problem.terms
    begins = 0.5 - 0.5 * problem.contact_ratio
    points = len(terms.tooth_pair_stiffness)
    places = [half, begins + pitch_point(problem), 1.0 - half]
    places += [place for place, _ in terms.stiffness_table]
    places += [begins + problem.contact_ratio * i / (points - 1) for i in range(points)]
    inner = sorted({(place - problem.initial_phase) % 1.0 for place in places} | {0.0, 1.0})
    # Places that differ by rounding are one.
    return [0.0] + [b for a, b in itertools.pairwise(inner) if b - a > 1e-12]


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
        self.partings = 0

    def relative_motion(self):
        return relative_motion(self.problem, self.time, self.state)

    def advance(self, end):
        if self.has_signs:
            self._settle_slip()
        if self.problem.terms.non_adhesive and self.mode.regime != CONTACT_LOSS:
            force = contact_force(self.problem, self.time, self.state.tolist(), self.mode)
            self.mode = replace(self.mode, parted=self.mode.regime * force < 0.0)
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
                lambda t, x: motion(t, x)[0] + backlash(problem, t),
                1,
                lambda: self._enter(CONTACT_LOSS),
            )
        else:
            watch(lambda t, x: motion(t, x)[0], 1, lambda: self._enter(NORMAL_MESH))
            watch(
                lambda t, x: motion(t, x)[0] + backlash(problem, t),
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

    def _part(self):
        self.mode = replace(self.mode, parted=not self.mode.parted)
        self.partings += 1

    def _available(self, time, state):
        """F_T at slip sign -1: what friction can hold with, negative where it drives."""
        problem = self.problem
        y, _ = relative_motion(problem, time, state)
        gamma = sum(gamma for gamma, _, _ in pairs(problem, self.mode.inside))
        force = elastic(problem, time, y, self.mode)
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
