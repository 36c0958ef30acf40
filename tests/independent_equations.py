"""The equations of motion stated afresh, from the paper.

The library is asked for nothing but the statement of a run. `independent` integrates them.
"""

import itertools
from dataclasses import dataclass
from math import copysign, cos, floor, pi, sin, sqrt, tan

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
    pressing: tuple[int, ...] = ()


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
        self.problem = problem

    def turned(self, t: float) -> float:
        """Return the mean angle omega_i t."""
        return turned(self.problem, t) / self.teeth

    def omega(self, t: float) -> float:
        return speed(self.problem, t) / self.teeth


def _acceleration(problem: Problem) -> float:
    """Return the constant rate at which nu changes over the run."""
    periods = problem.revolutions * problem.teeth
    mean = 0.5 * (problem.nu + problem.final_nu)
    return (problem.final_nu - problem.nu) / (2.0 * pi * periods / mean)


def speed(problem: Problem, t: float) -> float:
    """Return nu at the time t, which is `start_time` at the start."""
    if problem.final_nu is None:
        return problem.nu
    return problem.nu + _acceleration(problem) * (t - problem.start_time)


def turned(problem: Problem, t: float) -> float:
    """Return the angle of the mesh, nu t if the speed is constant."""
    if problem.final_nu is None:
        return problem.nu * t
    return problem.nu * t + 0.5 * _acceleration(problem) * (t - problem.start_time) ** 2


def phase_at(problem: Problem, t: float) -> float:
    """Return the mesh periods that have passed since t = 0."""
    return turned(problem, t) / (2.0 * pi)


def kept(function):
    """Remember what a function of a problem, and of a mesh phase, returns.

    The identity of the problem is asked for, because the hash of its many fields takes long.
    """
    known = {}

    def remembered(problem, *inside):
        key = id(problem), *inside
        if key not in known:
            known[key] = problem, function(problem, *inside)
        return known[key][1]

    return remembered


@kept
def bodies(problem: Problem) -> tuple[Body, Body]:
    return Body(problem, 0), Body(problem, 1)


def series_of(harmonics, angle: float) -> float:
    """Return the sum of (order, cosine, sine) at the angle nu t."""
    return sum(a * cos(n * angle) + b * sin(n * angle) for n, a, b in harmonics)


def backlash(problem: Problem, t: float, x) -> float:
    """Return s(t), with 2 sin(alpha) of what the distance of the centres grows by, where asked."""
    s = problem.backlash + series_of(problem.terms.backlash_harmonics, turned(problem, t))
    if not problem.terms.backlash_follows_centres:
        return s
    third, second = bodies(problem)
    turned_3 = third.turned(t) + x[PHI_3] / third.radius
    turned_2 = problem.eccentricity_angle - second.turned(t) - x[PHI_2] / second.radius
    e_3, e_2 = problem.eccentricity_3, problem.eccentricity_2
    along = x[Y_2] + e_2 * sin(turned_2) - x[Y_3] - e_3 * sin(turned_3)
    across = x[Z_2] + e_2 * cos(turned_2) - x[Z_3] - e_3 * cos(turned_3)
    alpha = problem.pressure_angle
    return s + 2.0 * sin(alpha) * (sin(alpha) * along + cos(alpha) * across)


def relative_motion(problem: Problem, t: float, x) -> tuple[float, float]:
    """Return y of eq. (3) and its rate in the state `x`, shape (12,)."""
    e_3, e_2 = problem.eccentricity_3, problem.eccentricity_2
    third, second = bodies(problem)
    total_3 = third.turned(t) + x[PHI_3] / third.radius
    behind = problem.eccentricity_angle - second.turned(t) - x[PHI_2] / second.radius
    speed_3 = third.omega(t) + x[6 + PHI_3] / third.radius
    speed_2 = second.omega(t) + x[6 + PHI_2] / second.radius
    y = x[PHI_3] + x[PHI_2] + x[Y_3] - x[Y_2] + e_3 * sin(total_3) - e_2 * sin(behind)
    rate = x[6 + PHI_3] + x[6 + PHI_2] + x[6 + Y_3] - x[6 + Y_2]
    rate += e_3 * speed_3 * cos(total_3) + e_2 * speed_2 * cos(behind)
    for n, (a, b) in enumerate(problem.deviation, start=1):
        angle = n * turned(problem, t)
        y += a * cos(angle) + b * sin(angle)
        rate += n * speed(problem, t) * (b * cos(angle) - a * sin(angle))
    return y, rate


def bracket(problem: Problem, t: float, x) -> float:
    """Return e_3 Phi_3' sin Phi_3 - e_2 Phi_2' sin(Delta - Phi_2) of eq. (6)."""
    third, second = bodies(problem)
    turned_3 = third.turned(t) + x[PHI_3] / third.radius
    turned_2 = second.turned(t) + x[PHI_2] / second.radius
    one = problem.eccentricity_3 * (third.omega(t) + x[6 + PHI_3] / third.radius) * sin(turned_3)
    two = problem.eccentricity_2 * (second.omega(t) + x[6 + PHI_2] / second.radius)
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


@kept
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


@kept
def deviates(problem: Problem) -> bool:
    """Return whether flanks have pitch errors or tip relief."""
    terms = problem.terms
    return bool(terms.pitch_errors_3 or terms.pitch_errors_2 or any(terms.tip_relief))


def distance(problem: Problem, t: float, p: int) -> float:
    """Return the y at which pair p touches: its relief less the pitch errors of its teeth."""
    terms, length = problem.terms, problem.contact_ratio
    apart = 0.0
    for errors in (terms.pitch_errors_3, terms.pitch_errors_2):
        apart -= errors[p % len(errors)] if errors else 0.0
    from_entry = phase_at(problem, t) - (p + 0.5 - 0.5 * length)
    for i, from_tip in enumerate((length - from_entry, from_entry)):
        if terms.tip_relief[i]:
            apart += terms.tip_relief[i] * max(0.0, 1.0 - from_tip / terms.tip_relief_length[i])
    return apart


def stiffness(problem: Problem, t: float, inside: float) -> float:
    return sum(stiffness_of_pairs(problem, t, inside).values())


def stiffness_of_pairs(problem: Problem, t: float, inside: float) -> dict[int, float]:
    """Return C / C_s of each pair: its own, or an equal share of eq. (4), cut or as its sum."""
    terms, length = problem.terms, problem.contact_ratio
    touching = pairs(problem, inside)
    phase = phase_at(problem, t)
    phase -= round(phase - inside)
    if terms.tooth_pair_stiffness:
        values = terms.tooth_pair_stiffness
        found = {}
        for _, _, p in touching:
            # The piece of the table is that of `inside`; the place on it is that of t.
            start = p + 0.5 - 0.5 * length
            piece = min(int((inside - start) / length * (len(values) - 1)), len(values) - 2)
            share = (phase - start) / length * (len(values) - 1) - piece
            at = values[piece] + share * (values[piece + 1] - values[piece])
            found[p] = at * tooth_factor(problem, p)
        return found
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
            c += 2.0 * (high - low) * sin(n * pi * share) / (n * pi) * cos(n * turned(problem, t))
        for n, (a, b) in enumerate(terms.stiffness_fourier, start=1):
            c += a * cos(n * turned(problem, t)) + b * sin(n * turned(problem, t))
    return {p: c * tooth_factor(problem, p) / len(touching) for _, _, p in touching}


def elastic(problem: Problem, t: float, y: float, mode: Mode, x) -> float:
    """Return the restoring force of the depth; added over the pairs where flanks deviate."""
    if mode.regime == CONTACT_LOSS:
        return 0.0
    if deviates(problem) and mode.regime == NORMAL_MESH:
        shares = stiffness_of_pairs(problem, t, mode.inside)
        return sum(
            shares[p] * _restoring(problem, t, y - distance(problem, t, p)) for p in mode.pressing
        )
    d = y if mode.regime == NORMAL_MESH else y + backlash(problem, t, x)
    return stiffness(problem, t, mode.inside) * _restoring(problem, t, d)


def _restoring(problem: Problem, t: float, d: float) -> float:
    """Return |d|^p + c_2 d^2 + c_3 |d|^3 with the sign of d, where c_2 and c_3 may vary."""
    terms, size = problem.terms, abs(d)
    orders = [(n, *both) for n, both in enumerate(terms.restoring_fourier, start=1)]
    varies = 1.0 + series_of(orders, turned(problem, t))
    stiffening = terms.restoring_2 * size**2 + terms.restoring_3 * size**3
    return copysign(size**terms.restoring_power + varies * stiffening, d)


def contact_force(problem: Problem, t: float, x, mode: Mode) -> float:
    """Return elastic and damping force, eqs. (1) and (7), of flanks in contact or of the film."""
    y, v = relative_motion(problem, t, x)
    return elastic(problem, t, y, mode, x) + _damping(problem, t, v, mode)


def _damping(problem: Problem, t: float, v: float, mode: Mode) -> float:
    k_1, k_2, k_3 = problem.lubricant if mode.regime == CONTACT_LOSS else problem.material
    damping = k_1 * v + k_2 * abs(v) * v + k_3 * v**3
    if mode.regime != CONTACT_LOSS and problem.terms.damping_power:
        damping *= stiffness(problem, t, mode.inside) ** problem.terms.damping_power
    return damping


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
    force = normal = 0.0
    if not mode.parted:
        y, v = relative_motion(problem, t, x)
        force = elastic(problem, t, y, mode, x)
        normal = force + _damping(problem, t, v, mode)
    signs = mode.run_out_sign * mode.slip_sign
    third, second = bodies(problem)
    moved = phase_at(problem, t) - mode.inside
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
        third.turned(t) + x[PHI_3] / third.radius
    )
    behind = problem.eccentricity_angle - second.turned(t) - x[PHI_2] / second.radius
    lever_2 = 1.0 + problem.eccentricity_2 / second.radius * cos(behind)
    terms = problem.terms
    load_3 = 1.0 + series_of(terms.torque_harmonics_3, turned(problem, t))
    load_2 = 1.0 + series_of(terms.torque_harmonics_2, turned(problem, t))
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
