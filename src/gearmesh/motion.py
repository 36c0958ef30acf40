"""Relative motion and equations of motion of the gear pair, and the statement of one run."""

from dataclasses import dataclass


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
