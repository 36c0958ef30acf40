"""Relative motion and equations of motion of the gear pair.

The coordinates are q = (phi_3, phi_2, y_3, y_2, z_3, z_2): rotations of the two wheels and
displacements of their bodies along the mesh line and across it. The rotations are held as the
lengths R_b phi. Wheels, bodies and bearings of the pair are equal; a wheel alone has the inertia
2 m_red on its base circle.

The model is stated here only. `accelerations` takes floats or truncated Taylor series of time; with
series, tests compare the fast recurrences of the solvers with it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearmesh.model import stiffness
from gearmesh.model.contact import CONTACT_LOSS, elastic_force, regime_of
from gearmesh.model.damping import damping_force
from gearmesh.model.friction import (
    arms,
    follows_run_out,
    friction_force,
    holding_force,
    pairs_in_contact,
)
from gearmesh.model.problem import Problem, State

Six = Sequence[float] | np.ndarray
"""Six coordinates or their rates; truncated Taylor series may stand in place of floats."""

ROTATION_3, ROTATION_2, Y_3, Y_2, Z_3, Z_2 = range(6)
"""Places of R_b phi_3, R_b phi_2, y_3, y_2, z_3, z_2 among the coordinates."""

WHEEL_INERTIA = 2.0
"""I / (R_b^2 m_red) of one wheel, so that the pair has the reduced mass m_red."""


@dataclass(frozen=True, slots=True)
class Mode:
    """The branch of every law that jumps; between jumps the equations of motion are smooth.

    Attributes
    ----------
    regime : int
        `NORMAL_MESH`, `CONTACT_LOSS` or `INVERSE_MESH`.
    segment : float
        Any mesh phase between the same two jumps of C(t) and gamma(t).
    run_out_sign : int
        First sign of eq. (6).
    slip_sign : int
        Second sign of eq. (6), that of z_3' - z_2'; 0 while the flanks stick, with z_3' = z_2'.
    """

    regime: int
    segment: float
    run_out_sign: int = 1
    slip_sign: int = 1


def _sine(angle: float) -> float:
    """Return the sine of a float, or of a series by its own method."""
    return angle.sin() if hasattr(angle, "sin") else math.sin(angle)


def _cosine(angle: float) -> float:
    return angle.cos() if hasattr(angle, "cos") else math.cos(angle)


def mesh_phase(problem: Problem, time: float) -> float:
    """Return the mesh phase at `time`, in mesh periods from t = 0 of eq. (4)."""
    return time / problem.period


def angles(problem: Problem, time: float, q: Six) -> tuple[float, float]:
    """Return Phi_3 and Delta - Phi_2, where Phi_i = omega_i t + phi_i is a total rotation."""
    turned = problem.rotation_speed * time
    phi_3 = q[ROTATION_3] / problem.base_radius
    phi_2 = q[ROTATION_2] / problem.base_radius
    return turned + phi_3, problem.eccentricity_angle - (turned + phi_2)


def levers(problem: Problem, time: float, q: Six) -> tuple[float, float]:
    """Return dy/dphi_3 and dy/dphi_2 in R_b: run-out changes the lever of the normal force."""
    angle_3, angle_2 = angles(problem, time, q)
    return (
        1.0 + problem.eccentricity_3 / problem.base_radius * _cosine(angle_3),
        1.0 + problem.eccentricity_2 / problem.base_radius * _cosine(angle_2),
    )


def deviation(problem: Problem, time: float) -> tuple[float, float]:
    """Return the profile deviation f and its rate."""
    value = rate = 0.0
    for n, (cosine, sine) in enumerate(problem.deviation, start=1):
        angle = n * problem.nu * time
        value += cosine * _cosine(angle) + sine * _sine(angle)
        rate += n * problem.nu * (sine * _cosine(angle) - cosine * _sine(angle))
    return value, rate


def relative_motion(problem: Problem, time: float, q: Six, v: Six) -> tuple[float, float]:
    """Return the relative motion y of eq. (3) and its rate.

    Parameters
    ----------
    problem : Problem
    time : float
        t, in tau_s; `Problem.start_time` at the start of the run.
    q, v : array_like, shape (6,)
        Coordinates and their rates, in y_st and y_st Omega_s.
    """
    angle_3, angle_2 = angles(problem, time, q)
    f, f_rate = deviation(problem, time)
    y = q[ROTATION_3] + q[ROTATION_2] + q[Y_3] - q[Y_2] + f
    y += problem.eccentricity_3 * _sine(angle_3) - problem.eccentricity_2 * _sine(angle_2)
    lever_3, lever_2 = levers(problem, time, q)
    rate = lever_3 * v[ROTATION_3] + lever_2 * v[ROTATION_2] + v[Y_3] - v[Y_2] + f_rate
    rate += problem.eccentricity_3 * problem.rotation_speed * _cosine(angle_3)
    rate += problem.eccentricity_2 * problem.rotation_speed * _cosine(angle_2)
    return y, rate


def mesh_stiffness(problem: Problem, phase: float, segment: float | None = None) -> float:
    """Return C / C_s at the mesh phase `phase`; `segment` chooses the side of a jump."""
    levels = (problem.contact_ratio, problem.stiffness_max, problem.stiffness_min)
    if problem.stiffness_harmonics:
        return float(stiffness.fourier(phase, *levels, problem.stiffness_harmonics))
    return float(stiffness.rectangular(phase if segment is None else segment, *levels))


def run_out_argument(problem: Problem, time: float, q: Six, v: Six) -> float:
    """Return the bracket of eq. (6), e_3 Phi_3' sin Phi_3 - e_2 Phi_2' sin(Delta - Phi_2)."""
    angle_3, angle_2 = angles(problem, time, q)
    speed_3 = problem.rotation_speed + v[ROTATION_3] / problem.base_radius
    speed_2 = problem.rotation_speed + v[ROTATION_2] / problem.base_radius
    return problem.eccentricity_3 * speed_3 * _sine(
        angle_3
    ) - problem.eccentricity_2 * speed_2 * _sine(angle_2)


def bearing_damping(problem: Problem) -> float:
    """Return b_b of a body, in F_st / (y_st Omega_s)."""
    critical = 2.0 * math.sqrt(problem.bearing_stiffness * problem.body_mass)
    return problem.bearing_damping_ratio * critical


def mode_of(problem: Problem, time: float, q: Six, v: Six) -> Mode:
    """Return the branches that act in a state; where a sign has argument 0 it is +1."""
    y, _ = relative_motion(problem, time, q, v)
    regime = int(regime_of(y, problem.backlash))
    segment = mesh_phase(problem, time)
    if not follows_run_out(problem.eccentricity_3, problem.eccentricity_2):
        return Mode(regime, segment)
    bracket = run_out_argument(problem, time, q, v)
    return Mode(regime, segment, 1 if bracket >= 0.0 else -1, 1 if v[Z_3] >= v[Z_2] else -1)


def friction_actions(
    problem: Problem, time: float, q: Six, v: Six, mode: Mode, elastic: float
) -> tuple[float, float, float]:
    """Return F_T on wheel 3 and the additional moments on both wheels over R_b, in F_st."""
    phase = mesh_phase(problem, time)
    # Whole periods apart, `phase` and `segment` are the same place on the mesh line.
    passed = phase - mode.segment - round(phase - mode.segment)
    force = moment_3 = moment_2 = 0.0
    for gamma, sigma in pairs_in_contact(mode.segment, problem.contact_ratio):
        pair_force = friction_force(
            elastic, problem.friction_coefficient, gamma, mode.run_out_sign, mode.slip_sign
        )
        if mode.slip_sign == 0:
            pair_force = holding_force(bearing_pull(problem, q, v))
        arm_3, arm_2 = arms(sigma + passed, problem.pressure_angle, problem.teeth)
        force += pair_force
        moment_3 -= arm_3 * pair_force
        moment_2 -= arm_2 * pair_force
    return force, moment_3, moment_2


def bearing_pull(problem: Problem, q: Six, v: Six) -> float:
    """Return the force of the bearings against z_3 - z_2."""
    pull = problem.bearing_stiffness * (q[Z_3] - q[Z_2])
    return pull + bearing_damping(problem) * (v[Z_3] - v[Z_2])


def accelerations(
    problem: Problem, time: float, q: Six, v: Six, mode: Mode | None = None
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
    c = mesh_stiffness(problem, mesh_phase(problem, time), mode.segment)
    elastic = elastic_force(y, c, mode.regime, problem.backlash)
    law = problem.lubricant if mode.regime == CONTACT_LOSS else problem.material
    normal = elastic + damping_force(rate, law)
    friction, moment_3, moment_2 = friction_actions(problem, time, q, v, mode, elastic)
    lever_3, lever_2 = levers(problem, time, q)
    damping = bearing_damping(problem)
    bearing = [-problem.bearing_stiffness * q[i] - damping * v[i] for i in range(6)]
    return np.array(
        [
            (1.0 - lever_3 * normal + moment_3) / WHEEL_INERTIA,
            (1.0 - lever_2 * normal + moment_2) / WHEEL_INERTIA,
            (bearing[Y_3] - normal) / problem.body_mass,
            (bearing[Y_2] + normal) / problem.body_mass,
            (bearing[Z_3] + friction) / problem.body_mass,
            (bearing[Z_2] - friction) / problem.body_mass,
        ]
    )


def static_equilibrium(problem: Problem, y: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates and rates at rest with the relative motion `y`.

    The bearings carry F_st. Both wheels share the rotation that `y` takes, run-out and profile
    deviation included. With y = 1 this is static equilibrium in a mesh of stiffness C_s. At rest
    means that the six rates vanish; run-out and deviation, which the mean rotation carries along,
    still move y.
    """
    q = np.zeros(6)
    q[Y_3] = -1.0 / problem.bearing_stiffness
    q[Y_2] = 1.0 / problem.bearing_stiffness
    v = np.zeros(6)
    _rotate_to(problem, y, q, v)
    return q, v


def _rotate_to(problem: Problem, y: float, q: np.ndarray, v: np.ndarray) -> None:
    """Turn both wheels alike until the relative motion is `y`."""
    # A contraction by the factor e / R_b.
    for _ in range(100):
        now, _ = relative_motion(problem, problem.start_time, q, v)
        if now == y:
            break
        q[ROTATION_3] += 0.5 * (y - now)
        q[ROTATION_2] = q[ROTATION_3]


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
    b = -2.0 / problem.bearing_stiffness
    # y is the sum of both motions, as everywhere in the reduced system.
    return State((y - b) + b, v, b, 0.0, coordinates=(*q.tolist(), *rates.tolist()))


def start(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates and rates at the start of the run."""
    state = problem.initial_state
    if state is None:
        return static_equilibrium(problem)
    if state.coordinates is not None:
        both = np.array(state.coordinates)
        return both[:6], both[6:]
    q, v = np.zeros(6), np.zeros(6)
    q[Y_3], q[Y_2] = 0.5 * state.b, -0.5 * state.b
    v[Y_3], v[Y_2] = 0.5 * state.b_rate, -0.5 * state.b_rate
    v[[ROTATION_3, ROTATION_2]] = 0.5 * (state.v - state.b_rate)
    _rotate_to(problem, state.y, q, v)
    return q, v
