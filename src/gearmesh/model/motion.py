"""Relative motion and equations of motion of the gear pair.

The coordinates are q = (phi_3, phi_2, y_3, y_2, z_3, z_2): rotations of the two wheels and
displacements of their bodies along the mesh line and across it. The rotations are held as the
lengths R_bi phi_i. An equal wheel alone has the inertia 2 m_red on its base circle.

The model is stated here only. Every function takes floats, truncated Taylor series of time, or
numbers that record what is done with them: the general solver derives its recurrences from this
statement (`gearmesh.solvers.full.tape`), and tests hold those of the reduced solver against it.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearmesh.model.contact import CONTACT_LOSS, NORMAL_MESH, elastic_force, regime_of
from gearmesh.model.damping import damping_force
from gearmesh.model.flanks import distances
from gearmesh.model.friction import (
    arms,
    follows_run_out,
    friction_force,
    holding_force,
    pairs_in_contact,
)
from gearmesh.model.functions import (
    Harmonic,
    Number,
    cosine,
    harmonic_rate,
    harmonic_sum,
    sine,
    square_root,
)
from gearmesh.model.mesh import backlash, mesh_phase, mesh_stiffness, pair_stiffnesses, since
from gearmesh.model.mode import Forces, Mode
from gearmesh.model.problem import Problem, State
from gearmesh.model.segments import pitch_offset_of

Six = Sequence[Number] | np.ndarray
"""Six coordinates or their rates; other numbers may stand in place of floats."""

ROTATION_3, ROTATION_2, Y_3, Y_2, Z_3, Z_2 = range(6)
"""Indices of the coordinates R_b3 phi_3, R_b2 phi_2, y_3, y_2, z_3 and z_2."""


def angles(problem: Problem, time: Number, q: Six) -> tuple[Number, Number]:
    """Return Phi_3 and Delta - Phi_2, where Phi_i = omega_i t + phi_i is a total rotation."""
    wheel_3, wheel_2 = problem.both_wheels
    speed_3, speed_2 = problem.rotation_speeds
    phi_3 = q[ROTATION_3] / wheel_3.base_radius
    phi_2 = q[ROTATION_2] / wheel_2.base_radius
    return speed_3 * time + phi_3, problem.eccentricity_angle - (speed_2 * time + phi_2)


def levers(problem: Problem, time: Number, q: Six) -> tuple[Number, Number]:
    """Return dy/dphi_3 and dy/dphi_2 in R_bi: run-out changes the lever of the normal force."""
    if not problem.has_run_out:
        return 1.0, 1.0
    wheel_3, wheel_2 = problem.both_wheels
    angle_3, angle_2 = angles(problem, time, q)
    return (
        1.0 + problem.eccentricity_3 / wheel_3.base_radius * cosine(angle_3),
        1.0 + problem.eccentricity_2 / wheel_2.base_radius * cosine(angle_2),
    )


def _deviation(problem: Problem) -> list[Harmonic]:
    return [Harmonic(n, *amplitudes) for n, amplitudes in enumerate(problem.deviation, start=1)]


def displacement(problem: Problem, time: Number, q: Six) -> Number:
    """Return the relative motion y of eq. (3), as `relative_motion` does."""
    y = q[ROTATION_3] + q[ROTATION_2] + q[Y_3] - q[Y_2]
    y += harmonic_sum(_deviation(problem), problem.nu * time)
    if problem.has_run_out:
        angle_3, angle_2 = angles(problem, time, q)
        y += problem.eccentricity_3 * sine(angle_3) - problem.eccentricity_2 * sine(angle_2)
    return y


def relative_motion(problem: Problem, time: Number, q: Six, v: Six) -> tuple[Number, Number]:
    """Return the relative motion y of eq. (3) and its rate.

    Parameters
    ----------
    problem : Problem
    time : float
        t, in tau_s; `Problem.start_time` at the start of the run.
    q, v : array_like, shape (6,)
        Coordinates and their rates, in y_st and y_st Omega_s.
    """
    lever_3, lever_2 = levers(problem, time, q)
    rate = lever_3 * v[ROTATION_3] + lever_2 * v[ROTATION_2] + v[Y_3] - v[Y_2]
    rate += harmonic_rate(_deviation(problem), problem.nu * time, problem.nu)
    if problem.has_run_out:
        angle_3, angle_2 = angles(problem, time, q)
        speed_3, speed_2 = problem.rotation_speeds
        rate += problem.eccentricity_3 * speed_3 * cosine(angle_3)
        rate += problem.eccentricity_2 * speed_2 * cosine(angle_2)
    return displacement(problem, time, q), rate


def gap(problem: Problem, time: Number, q: Six) -> Number:
    """Return the backlash s(t) in y_st.

    If the backlash follows the wheels' centres, each increase of the centre distance increases it
    by 2 sin(alpha) times as much. The line of centres has the components sin(alpha) along y and
    cos(alpha) along z. The centres move with the bodies. The centre of an eccentric wheel also
    turns about its axis.
    """
    s = backlash(problem, time)
    if not problem.terms.backlash_follows_centres:
        return s
    along, across = q[Y_2] - q[Y_3], q[Z_2] - q[Z_3]
    if problem.has_run_out:
        angle_3, angle_2 = angles(problem, time, q)
        e_3, e_2 = problem.eccentricity_3, problem.eccentricity_2
        along += e_2 * sine(angle_2) - e_3 * sine(angle_3)
        across += e_2 * cosine(angle_2) - e_3 * cosine(angle_3)
    rise, run = math.sin(problem.pressure_angle), math.cos(problem.pressure_angle)
    return s + 2.0 * rise * (rise * along + run * across)


def run_out_argument(problem: Problem, time: Number, q: Six, v: Six) -> Number:
    """Return the bracket of eq. (6), e_3 Phi_3' sin Phi_3 - e_2 Phi_2' sin(Delta - Phi_2)."""
    wheel_3, wheel_2 = problem.both_wheels
    angle_3, angle_2 = angles(problem, time, q)
    speed_3, speed_2 = problem.rotation_speeds
    speed_3 += v[ROTATION_3] / wheel_3.base_radius
    speed_2 += v[ROTATION_2] / wheel_2.base_radius
    return problem.eccentricity_3 * speed_3 * sine(
        angle_3
    ) - problem.eccentricity_2 * speed_2 * sine(angle_2)


def run_out_integral(problem: Problem, time: Number, q: Six) -> Number:
    """Return a function of time whose rate is `run_out_argument`."""
    angle_3, angle_2 = angles(problem, time, q)
    return -(problem.eccentricity_3 * cosine(angle_3) + problem.eccentricity_2 * cosine(angle_2))


def mode_of(problem: Problem, time: float, q: Six, v: Six) -> Mode:
    """Return the branches that act in a state; where a sign has argument 0 it is +1."""
    y, rate = relative_motion(problem, time, q, v)
    regime = int(regime_of(y, gap(problem, time, q)))
    phase = mesh_phase(problem, time)
    pressing: tuple[float, ...] = ()
    if problem.terms.pairs_touch_singly:
        pressing = tuple(float(y >= distance) for distance in distances(problem, phase, phase))
        regime = NORMAL_MESH if any(pressing) else min(regime, CONTACT_LOSS)
    mode = Mode(regime, phase, pressing=pressing)
    if follows_run_out(problem.eccentricity_3, problem.eccentricity_2):
        bracket = run_out_argument(problem, time, q, v)
        mode = replace(
            mode,
            run_out_sign=1 if bracket >= 0.0 else -1,
            slip_sign=1 if v[Z_3] >= v[Z_2] else -1,
        )
    if problem.terms.non_adhesive and regime != CONTACT_LOSS:
        pulls = regime * forces(problem, time, q, v, y, rate, mode).contact < 0.0
        mode = replace(mode, parted=pulls)
    return mode


def bearing_pulls(problem: Problem, q: Six, v: Six) -> list[Number]:
    """Return the forces c_b q + b_b q' of the bearings against y_3, y_2, z_3, z_2."""
    pulls = []
    for i in (Y_3, Y_2, Z_3, Z_2):
        wheel = problem.both_wheels[i % 2]
        across = 1 if i in (Z_3, Z_2) else 0
        stiffness, damping = wheel.bearing_stiffness[across], wheel.bearing_damping[across]
        pulls.append(stiffness * q[i] + damping * v[i])
    return pulls


def _friction(
    problem: Problem, time: Number, q: Six, v: Six, mode: Mode, elastic: Number
) -> tuple[Number, Number, Number]:
    """Return F_T on wheel 3 and the additional moments on both wheels over R_bi, in F_st."""
    force = moment_3 = moment_2 = 0.0
    if problem.friction_coefficient == 0.0:
        return force, moment_3, moment_2
    wheel_3, wheel_2 = problem.both_wheels
    passed = since(mesh_phase(problem, time), mode.segment)
    offset = pitch_offset_of(problem)
    pulls = bearing_pulls(problem, q, v)
    held = holding_force(pulls[2], pulls[3], wheel_3.body_mass, wheel_2.body_mass)
    pairs = pairs_in_contact(mode.segment, problem.contact_ratio, offset)
    for gamma, sigma in pairs:
        if mode.slip_sign == 0:
            pair_force = held / len(pairs)
        else:
            pair_force = friction_force(
                elastic, problem.friction_coefficient, gamma, mode.run_out_sign, mode.slip_sign
            )
        arm_3, arm_2 = arms(sigma + passed, problem.pressure_angle, wheel_3.teeth, wheel_2.teeth)
        force += pair_force
        moment_3 -= arm_3 * pair_force
        moment_2 -= arm_2 * pair_force
    return force, moment_3, moment_2


def _stiffening(problem: Problem, time: Number) -> tuple[Number, Number]:
    """Return c_2 and c_3 of the elastic force."""
    terms = problem.terms
    coefficients = terms.restoring_2, terms.restoring_3
    if not terms.restoring_fourier:
        return coefficients
    harmonics = [Harmonic(n, *both) for n, both in enumerate(terms.restoring_fourier, start=1)]
    share = 1.0 + harmonic_sum(harmonics, problem.nu * time)
    return coefficients[0] * share, coefficients[1] * share


def forces(
    problem: Problem, time: Number, q: Six, v: Six, y: Number, rate: Number, mode: Mode
) -> Forces:
    """Return the forces in the mesh at the relative motion `y` and its `rate`."""
    terms = problem.terms
    phase = mesh_phase(problem, time)
    c = mesh_stiffness(problem, phase, mode.segment)
    law = *_stiffening(problem, time), terms.restoring_power
    if terms.pairs_touch_singly and mode.regime == NORMAL_MESH:
        stiffnesses = pair_stiffnesses(problem, phase, mode.segment)
        starts = distances(problem, phase, mode.segment)
        elastic = sum(
            presses * elastic_force(y - start, stiffness, NORMAL_MESH, 0.0, *law)
            for presses, start, stiffness in zip(mode.pressing, starts, stiffnesses, strict=True)
        )
    else:
        elastic = elastic_force(y, c, mode.regime, gap(problem, time, q), *law)
    if mode.regime == CONTACT_LOSS:
        damping = damping_force(rate, problem.lubricant)
    else:
        damping = damping_force(rate, problem.material)
        if terms.damping_power == 0.5:
            damping = square_root(c) * damping
        elif terms.damping_power == 1.0:
            damping = c * damping
    contact = elastic + damping
    if mode.parted:
        return Forces(c, 0.0, contact, 0.0, 0.0, 0.0, 0.0)
    friction = _friction(problem, time, q, v, mode, elastic)
    return Forces(c, elastic, contact, contact, *friction)


def loads(problem: Problem, time: Number) -> tuple[Number, Number]:
    """Return the moments M_3 / R_b3 and M_2 / R_b2 in F_st: 1, and their harmonics."""
    angle = problem.nu * time
    return (
        1.0 + harmonic_sum(problem.terms.torque_harmonics_3, angle),
        1.0 + harmonic_sum(problem.terms.torque_harmonics_2, angle),
    )


def accelerations_under(
    problem: Problem, time: Number, q: Six, v: Six, mesh: Forces
) -> list[Number]:
    """Return the second time derivatives of the six coordinates under the forces of the mesh."""
    wheel_3, wheel_2 = problem.both_wheels
    lever_3, lever_2 = levers(problem, time, q)
    load_3, load_2 = loads(problem, time)
    frame_3, frame_2 = problem.terms.torsional_damping
    pulls = bearing_pulls(problem, q, v)
    moment_3 = load_3 - lever_3 * mesh.normal + mesh.moment_3 - frame_3 * v[ROTATION_3]
    moment_2 = load_2 - lever_2 * mesh.normal + mesh.moment_2 - frame_2 * v[ROTATION_2]
    return [
        moment_3 / wheel_3.inertia,
        moment_2 / wheel_2.inertia,
        (-pulls[0] - mesh.normal) / wheel_3.body_mass,
        (-pulls[1] + mesh.normal) / wheel_2.body_mass,
        (-pulls[2] + mesh.friction) / wheel_3.body_mass,
        (-pulls[3] - mesh.friction) / wheel_2.body_mass,
    ]


def accelerations(
    problem: Problem, time: Number, q: Six, v: Six, mode: Mode | None = None
) -> np.ndarray:
    """Return the second time derivatives of the six coordinates.

    Parameters
    ----------
    problem : Problem
    time : float
        t, in tau_s; `Problem.start_time` at the start of the run.
    q, v : array_like, shape (6,)
        Coordinates and their rates, in y_st and y_st Omega_s.
    mode : Mode, optional
        Branches of the laws that jump; those of the state if it is not given.

    Returns
    -------
    ndarray, shape (6,)
        In y_st Omega_s^2.
    """
    if mode is None:
        mode = mode_of(problem, time, q, v)
    y, rate = relative_motion(problem, time, q, v)
    mesh = forces(problem, time, q, v, y, rate, mode)
    return np.array(accelerations_under(problem, time, q, v, mesh))


def static_equilibrium(problem: Problem, y: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates and rates at rest with the relative motion `y`.

    The bearings carry F_st. Both wheels share the rotation that `y` takes, run-out and profile
    deviation included. With y = 1 this is static equilibrium in a mesh of stiffness C_s. At rest
    means that the six rates vanish; run-out and deviation, which the mean rotation carries along,
    still move y.
    """
    q = np.zeros(6)
    compliance_3, compliance_2 = _compliances(problem)
    q[Y_3], q[Y_2] = -compliance_3, compliance_2
    v = np.zeros(6)
    _rotate_to(problem, y, q)
    return q, v


def _compliances(problem: Problem) -> tuple[float, float]:
    """Return C_s / c_b of both bearings along the mesh line."""
    wheel_3, wheel_2 = problem.both_wheels
    return 1.0 / wheel_3.bearing_stiffness[0], 1.0 / wheel_2.bearing_stiffness[0]


def _rotate_to(problem: Problem, y: float, q: np.ndarray) -> None:
    """Turn both wheels alike until the relative motion is `y`."""
    # A contraction by the factor e / R_b. In the end, rounding may let two values take turns.
    for _ in range(50):
        before = q[ROTATION_3]
        for _ in range(2):
            q[ROTATION_3] += 0.5 * (y - displacement(problem, problem.start_time, q))
            q[ROTATION_2] = q[ROTATION_3]
        if q[ROTATION_3] == before:
            return


def state_at(problem: Problem, y: float = 1.0, v: float = 0.0) -> State:
    """Return the state at t = 0 with given motion of the mesh and the bodies in equilibrium.

    Parameters
    ----------
    problem : Problem
    y : float
        Relative motion, in y_st; 1 is static equilibrium.
    v : float
        Rate of R_b (phi_3 + phi_2), in y_st Omega_s. This is y' without the parts of run-out and
        profile deviation.
    """
    q, rates = static_equilibrium(problem, y)
    rates[[ROTATION_3, ROTATION_2]] = 0.5 * v
    b = -sum(_compliances(problem))
    # y is the sum of both motions, as everywhere in the reduced system.
    return State((y - b) + b, v, b, 0.0, coordinates=(*q.tolist(), *rates.tolist()))


def state_of(problem: Problem, q: np.ndarray, v: np.ndarray) -> State:
    """Return the state at t = 0 with these coordinates and rates, each of shape (6,)."""
    y, rate = relative_motion(problem, problem.start_time, q, v)
    b, b_rate = (float(x[Y_3] - x[Y_2]) for x in (q, v))
    return State(float(y), float(rate), b, b_rate, coordinates=(*q.tolist(), *v.tolist()))


def start(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates and rates at the start of the run."""
    state = problem.initial_state
    if state is None:
        return static_equilibrium(problem)
    if state.coordinates is not None:
        both = np.array(state.coordinates)
        return both[:6], both[6:]
    q, v = np.zeros(6), np.zeros(6)
    compliance_3, compliance_2 = _compliances(problem)
    share_3 = compliance_3 / (compliance_3 + compliance_2)
    q[Y_3], q[Y_2] = share_3 * state.b, (share_3 - 1.0) * state.b
    v[Y_3], v[Y_2] = share_3 * state.b_rate, (share_3 - 1.0) * state.b_rate
    v[[ROTATION_3, ROTATION_2]] = 0.5 * (state.v - state.b_rate)
    _rotate_to(problem, state.y, q)
    return q, v
