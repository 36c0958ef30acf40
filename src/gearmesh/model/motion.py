"""Relative motion and equations of motion of the gear pair, and the statement of one run.

The coordinates are q = (phi_3, phi_2, y_3, y_2, z_3, z_2): rotations of the two wheels and
displacements of their bodies along the mesh line and across it. The rotations are held as the
lengths R_b phi. Wheels, bodies and bearings of the pair are equal; a wheel alone has the inertia
2 m_red on its base circle.

This is the model as one reads it, for checking and for single evaluations; the solvers
(`gearmesh.solvers.simulation`, `gearmesh.solvers.full.runs`) have their own compiled forms of it.
"""

import math
from dataclasses import dataclass

import numpy as np

from gearmesh.model import stiffness
from gearmesh.model.damping import damping_force
from gearmesh.model.friction import arms, follows_run_out, friction_force, pairs_in_contact

NORMAL_MESH, CONTACT_LOSS, INVERSE_MESH = 1, 0, -1
"""Regimes of the mesh: y >= 0, -s < y < 0 and y <= -s."""

ROTATION_3, ROTATION_2, Y_3, Y_2, Z_3, Z_2 = range(6)
"""Places of R_b phi_3, R_b phi_2, y_3, y_2, z_3, z_2 among the coordinates."""

WHEEL_INERTIA = 2.0
"""I / (R_b^2 m_red) of one wheel, so that the pair has the reduced mass m_red."""


@dataclass(frozen=True, slots=True)
class Problem:
    """One run, in dimensionless form.

    Lengths are in static deflections y_st = F_st / C_s, forces in the static mesh force F_st,
    times in 1 / Omega_s with Omega_s = sqrt(C_s / m_red), so the mean mesh stiffness and the
    reduced mass are 1.

    Attributes
    ----------
    nu : float
        Mesh frequency, nu_s = omega_c / Omega_s.
    contact_ratio : float
        epsilon.
    stiffness_max, stiffness_min : float
        C_max / C_s and C_min / C_s.
    material, lubricant : tuple of three float
        Coefficients of v, abs(v) v and v^3 in normal and inverse mesh, and in contact loss.
    backlash : float
        s / y_st.
    body_mass : float
        m / m_red, the mass of each wheel body in y and z.
    bearing_stiffness : float
        c_b / C_s, of each body in y and z.
    bearing_damping_ratio : float
        b_b / (2 sqrt(c_b m)).
    friction_coefficient : float
        f_T.
    pressure_angle : float
        alpha, in rad.
    teeth : int
        Z, of each wheel.
    base_radius : float
        R_b / y_st, of each wheel.
    eccentricity_3, eccentricity_2 : float
        e_3 / y_st and e_2 / y_st.
    eccentricity_angle : float
        Delta, in rad.
    deviation : tuple of (float, float)
        Profile deviation f: amplitudes (cosine, sine) of harmonics 1, 2, ... of the mesh
        frequency, in y_st.
    stiffness_harmonics : int
        Terms of eq. (4) that are kept; 0 for all of them, the rectangular wave.
    initial_phase : float
        Mesh phase at the start of the run, in mesh periods.
    revolutions, kept_revolutions : int
        Revolutions of the wheels that are run, and how many of the last are measured.
    initial_state : tuple of four float, optional
        u, u', b, b' at the start, with u = R_b (phi_3 + phi_2) and b = y_3 - y_2, in place of
        rest in static equilibrium: another initial velocity, or the end of a run before it in a
        sweep.
    """

    nu: float
    contact_ratio: float
    stiffness_max: float
    stiffness_min: float
    material: tuple[float, float, float]
    lubricant: tuple[float, float, float]
    backlash: float
    body_mass: float
    bearing_stiffness: float
    bearing_damping_ratio: float
    friction_coefficient: float
    pressure_angle: float
    teeth: int
    base_radius: float
    eccentricity_3: float = 0.0
    eccentricity_2: float = 0.0
    eccentricity_angle: float = 0.0
    deviation: tuple[tuple[float, float], ...] = ()
    stiffness_harmonics: int = 0
    initial_phase: float = 0.0
    revolutions: int = 5
    kept_revolutions: int = 1
    initial_state: tuple[float, float, float, float] | None = None

    @property
    def period(self) -> float:
        """Mesh period T in tau_s."""
        return 2.0 * math.pi / self.nu

    @property
    def rotation_speed(self) -> float:
        """Mean speed of the wheels omega_i = omega_c / Z, in Omega_s."""
        return self.nu / self.teeth

    @property
    def start_time(self) -> float:
        """Time t of eqs. (3), (4) and (6) at the start of the run."""
        return self.initial_phase * self.period


@dataclass(frozen=True, slots=True)
class Mode:
    """The branch of every law that jumps; between jumps the equations of motion are smooth.

    Attributes
    ----------
    regime : int
        `NORMAL_MESH`, `CONTACT_LOSS` or `INVERSE_MESH`.
    stretch : float
        Any mesh phase between the same two jumps of C(t) and gamma(t).
    run_out_sign : int
        First sign of eq. (6).
    slip_sign : int
        Second sign of eq. (6), that of z_3' - z_2'; 0 while the flanks stick, with z_3' = z_2'.
    """

    regime: int
    stretch: float
    run_out_sign: int = 1
    slip_sign: int = 1


def mesh_phase(problem: Problem, time: float) -> float:
    """Return the mesh phase at `time`, in mesh periods from t = 0 of eq. (4)."""
    return time / problem.period


def angles(problem: Problem, time: float, q) -> tuple[float, float]:
    """Return Phi_3 and Delta - Phi_2, where Phi_i = omega_i t + phi_i is a total rotation."""
    turned = problem.rotation_speed * time
    phi_3 = q[ROTATION_3] / problem.base_radius
    phi_2 = q[ROTATION_2] / problem.base_radius
    return turned + phi_3, problem.eccentricity_angle - (turned + phi_2)


def levers(problem: Problem, time: float, q) -> tuple[float, float]:
    """Return dy/dphi_3 and dy/dphi_2 in R_b: run-out changes the lever of the normal force."""
    angle_3, angle_2 = angles(problem, time, q)
    return (
        1.0 + problem.eccentricity_3 / problem.base_radius * math.cos(angle_3),
        1.0 + problem.eccentricity_2 / problem.base_radius * math.cos(angle_2),
    )


def deviation(problem: Problem, time: float) -> tuple[float, float]:
    """Return the profile deviation f and its rate."""
    value = rate = 0.0
    for n, (cosine, sine) in enumerate(problem.deviation, start=1):
        angle = n * problem.nu * time
        value += cosine * math.cos(angle) + sine * math.sin(angle)
        rate += n * problem.nu * (sine * math.cos(angle) - cosine * math.sin(angle))
    return value, rate


def relative_motion(problem: Problem, time: float, q, v) -> tuple[float, float]:
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
    y += problem.eccentricity_3 * math.sin(angle_3) - problem.eccentricity_2 * math.sin(angle_2)
    lever_3, lever_2 = levers(problem, time, q)
    rate = lever_3 * v[ROTATION_3] + lever_2 * v[ROTATION_2] + v[Y_3] - v[Y_2] + f_rate
    rate += problem.eccentricity_3 * problem.rotation_speed * math.cos(angle_3)
    rate += problem.eccentricity_2 * problem.rotation_speed * math.cos(angle_2)
    return y, rate


def regime_of(problem: Problem, y: float) -> int:
    """Return the regime at the relative motion `y`."""
    if y >= 0.0:
        return NORMAL_MESH
    return CONTACT_LOSS if y > -problem.backlash else INVERSE_MESH


def mesh_stiffness(problem: Problem, phase: float, stretch: float | None = None) -> float:
    """Return C / C_s at the mesh phase `phase`; `stretch` chooses the side of a jump."""
    levels = (problem.contact_ratio, problem.stiffness_max, problem.stiffness_min)
    if problem.stiffness_harmonics:
        return float(stiffness.fourier(phase, *levels, problem.stiffness_harmonics))
    return float(stiffness.rectangular(phase if stretch is None else stretch, *levels))


def elastic_force(problem: Problem, y: float, c: float, regime: int) -> float:
    """Return C (y H1 + (y + s) H2) in F_st."""
    if regime == CONTACT_LOSS:
        return 0.0
    return c * (y + problem.backlash if regime == INVERSE_MESH else y)


def dynamic_force(y: float, c: float) -> float:
    """Return F_dyn of eq. (2) in F_st; unlike the elastic force it knows no contact loss."""
    return c * y


def run_out_argument(problem: Problem, time: float, q, v) -> float:
    """Return the bracket of eq. (6), e_3 Phi_3' sin Phi_3 - e_2 Phi_2' sin(Delta - Phi_2)."""
    angle_3, angle_2 = angles(problem, time, q)
    speed_3 = problem.rotation_speed + v[ROTATION_3] / problem.base_radius
    speed_2 = problem.rotation_speed + v[ROTATION_2] / problem.base_radius
    return problem.eccentricity_3 * speed_3 * math.sin(
        angle_3
    ) - problem.eccentricity_2 * speed_2 * math.sin(angle_2)


def bearing_damping(problem: Problem) -> float:
    """Return b_b of a body, in F_st / (y_st Omega_s)."""
    critical = 2.0 * math.sqrt(problem.bearing_stiffness * problem.body_mass)
    return problem.bearing_damping_ratio * critical


def mode_of(problem: Problem, time: float, q, v) -> Mode:
    """Return the branches that act in a state; where a sign has argument 0 it is +1."""
    y, _ = relative_motion(problem, time, q, v)
    regime = regime_of(problem, y)
    stretch = mesh_phase(problem, time)
    if not follows_run_out(problem.eccentricity_3, problem.eccentricity_2):
        return Mode(regime, stretch)
    bracket = run_out_argument(problem, time, q, v)
    return Mode(regime, stretch, 1 if bracket >= 0.0 else -1, 1 if v[Z_3] >= v[Z_2] else -1)


def friction_actions(
    problem: Problem, time: float, q, v, mode: Mode, elastic: float
) -> tuple[float, float, float]:
    """Return F_T on wheel 3 and the additional moments on both wheels over R_b, in F_st."""
    phase = mesh_phase(problem, time)
    # Whole periods apart, `phase` and `stretch` are the same place on the mesh line.
    passed = phase - mode.stretch - round(phase - mode.stretch)
    force = moment_3 = moment_2 = 0.0
    for gamma, sigma in pairs_in_contact(mode.stretch, problem.contact_ratio):
        pair_force = friction_force(
            elastic, problem.friction_coefficient, gamma, mode.run_out_sign, mode.slip_sign
        )
        if mode.slip_sign == 0:
            pair_force = holding_force(problem, q, v)
        arm_3, arm_2 = arms(sigma + passed, problem.pressure_angle, problem.teeth)
        force += pair_force
        moment_3 -= arm_3 * pair_force
        moment_2 -= arm_2 * pair_force
    return force, moment_3, moment_2


def holding_force(problem: Problem, q, v) -> float:
    """Return the F_T that keeps z_3' - z_2' constant: half of what the bearings pull with."""
    pull = problem.bearing_stiffness * (q[Z_3] - q[Z_2])
    return 0.5 * (pull + bearing_damping(problem) * (v[Z_3] - v[Z_2]))


def accelerations(problem: Problem, time: float, q, v, mode: Mode | None = None) -> np.ndarray:
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
    c = mesh_stiffness(problem, mesh_phase(problem, time), mode.stretch)
    elastic = elastic_force(problem, y, c, mode.regime)
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


def static_equilibrium(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates and rates at rest, with F_st in a mesh of stiffness C_s.

    The relative motion is y = 1 there, run-out and profile deviation included; both wheels share
    the rotation that this takes, and the bearings carry F_st. At rest means that the six rates
    vanish; run-out and deviation, which the mean rotation carries along, still move y.
    """
    q = np.zeros(6)
    q[Y_3] = -1.0 / problem.bearing_stiffness
    q[Y_2] = 1.0 / problem.bearing_stiffness
    v = np.zeros(6)
    # A contraction by the factor e / R_b.
    for _ in range(100):
        y, _ = relative_motion(problem, problem.start_time, q, v)
        if y == 1.0:
            break
        q[ROTATION_3] += 0.5 * (1.0 - y)
        q[ROTATION_2] = q[ROTATION_3]
    return q, v


def start(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates and rates at the start of the run.

    Static equilibrium, or what `Problem.initial_state` says: its sums and differences are shared
    evenly by the wheels, and nothing moves across the mesh line.
    """
    if problem.initial_state is None:
        return static_equilibrium(problem)
    u, u_rate, b, b_rate = problem.initial_state
    shares = np.array([[0.5, 0.0], [0.5, 0.0], [0.0, 0.5], [0.0, -0.5], [0.0, 0.0], [0.0, 0.0]])
    return shares @ [u, b], shares @ [u_rate, b_rate]


def sum_and_difference(q, v) -> tuple[float, float, float, float]:
    """Return u, u', b, b' with u = R_b (phi_3 + phi_2) and b = y_3 - y_2."""
    return (
        float(q[ROTATION_3] + q[ROTATION_2]),
        float(v[ROTATION_3] + v[ROTATION_2]),
        float(q[Y_3] - q[Y_2]),
        float(v[Y_3] - v[Y_2]),
    )
