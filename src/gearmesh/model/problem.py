"""The statement of one run, and the state that it starts from or ends in."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

from gearmesh.model.functions import Harmonic


class ToothFactor(NamedTuple):
    """A factor of the stiffness of one tooth: a crack lowers it, 0 is a missing tooth.

    `wheel` is 3 or 2. `tooth` counts from 0, the tooth in single contact at t = T / 2.
    """

    wheel: int
    tooth: int
    factor: float


@dataclass(frozen=True, slots=True)
class Wheel:
    """One wheel with its body and bearings, in the units of `Problem`.

    Attributes
    ----------
    teeth : int
        Z_i.
    base_radius : float
        R_bi / y_st.
    inertia : float
        J_i / (R_bi^2 m_red). The inverse values of both wheels add up to 1.
    body_mass : float
        m_i / m_red, in y and z.
    bearing_stiffness : tuple of two float
        c_b / C_s along the mesh line (y) and across it (z).
    bearing_damping_ratio : tuple of two float
        b_b / (2 sqrt(c_b m)) in y and z.
    """

    teeth: int
    base_radius: float
    inertia: float
    body_mass: float
    bearing_stiffness: tuple[float, float]
    bearing_damping_ratio: tuple[float, float]

    @property
    def bearing_damping(self) -> tuple[float, float]:
        """b_b in y and z, in F_st / (y_st Omega_s)."""
        along, across = (
            ratio * (2.0 * math.sqrt(stiffness * self.body_mass))
            for stiffness, ratio in zip(
                self.bearing_stiffness, self.bearing_damping_ratio, strict=True
            )
        )
        return along, across


@dataclass(frozen=True, slots=True)
class GeneralTerms:
    """The terms of eq. (1) that the paper writes and its examples do not use; all absent here.

    The names are those of the parameters of a pair.

    Attributes
    ----------
    torque_harmonics_3, torque_harmonics_2 : tuple of Harmonic
        M_i(t) / M_i - 1 of each wheel.
    torsional_damping : tuple of two float
        Damping of the rotation of wheels 3 and 2 to the frame, per R_b^2.
    stiffness_fourier : tuple of (float, float)
        Amplitudes (cosine, sine) of harmonics 1, 2, ... of C(t) / C_s.
    stiffness_table : tuple of (float, float)
        C(t) / C_s: mesh phases from 0 to 1 and values, linear in between. Two values at one phase
        are a jump.
    tooth_pair_stiffness : tuple of float
        Stiffness of one pair of teeth in C_s, at equal distances along its path of contact; linear
        in between, added over the pairs in contact.
    tooth_factors : tuple of ToothFactor
        Factors of single teeth. A pair of teeth takes the product of its two.
    restoring_2, restoring_3 : float
        The elastic force is C (d + c_2 d abs(d) + c_3 d^3) at the depth d.
    restoring_fourier : tuple of (float, float)
        Amplitudes (cosine, sine) of harmonics 1, 2, ... of the mesh frequency, by which c_2 and c_3
        vary relative to their means.
    restoring_power : float
        The power p of Hertz: d abs(d)^(p - 1) replaces the first d in the elastic force.
    non_adhesive : bool
        Whether the contact force never pulls: while it would, it is 0, and so is the friction.
    damping_power : float
        The damping of the material is multiplied by (C / C_s) to this power.
    backlash_harmonics : tuple of Harmonic
        s(t) - s, in y_st.
    backlash_follows_centres : bool
        Whether the backlash changes with the distance of the wheels' centres.
    pitch_errors_3, pitch_errors_2 : tuple of float
        How far the flank of each tooth of wheels 3 and 2 stands out towards its mate, in y_st;
        tooth 0 first, as in `ToothFactor`.
    tip_relief : tuple of two float
        How far the flanks of wheels 3 and 2 stand back at their tips, in y_st.
    tip_relief_length : tuple of two float
        Lengths of the tip reliefs along the path of contact, in base pitches.
    """

    torque_harmonics_3: tuple[Harmonic, ...] = ()
    torque_harmonics_2: tuple[Harmonic, ...] = ()
    torsional_damping: tuple[float, float] = (0.0, 0.0)
    stiffness_fourier: tuple[tuple[float, float], ...] = ()
    stiffness_table: tuple[tuple[float, float], ...] = ()
    tooth_pair_stiffness: tuple[float, ...] = ()
    tooth_factors: tuple[ToothFactor, ...] = ()
    restoring_2: float = 0.0
    restoring_3: float = 0.0
    restoring_fourier: tuple[tuple[float, float], ...] = ()
    restoring_power: float = 1.0
    non_adhesive: bool = False
    damping_power: float = 0.0
    backlash_harmonics: tuple[Harmonic, ...] = ()
    backlash_follows_centres: bool = False
    pitch_errors_3: tuple[float, ...] = ()
    pitch_errors_2: tuple[float, ...] = ()
    tip_relief: tuple[float, float] = (0.0, 0.0)
    tip_relief_length: tuple[float, float] = (0.0, 0.0)

    @property
    def backlash_varies(self) -> bool:
        """Whether the backlash changes with time."""
        return bool(self.backlash_harmonics) or self.backlash_follows_centres

    @property
    def pairs_touch_singly(self) -> bool:
        """Whether flanks deviate, so that each pair of teeth touches and parts by itself."""
        return bool(self.pitch_errors_3 or self.pitch_errors_2 or any(self.tip_relief))


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
        Revolutions of wheel 3 that are run, and how many of the last are measured; 0 measures
        nothing, for a run that only lets a transient die out.
    initial_state : State, optional
        Initial condition, if it is not rest in static equilibrium.
    final_nu : float, optional
        Mesh frequency at the end of the run, if the speed changes linearly with time. `nu` is then
        the mesh frequency at the start. The functions of `gearmesh.model` that take a time hold for
        a constant speed; `gearmesh.model.speeds` states how the mesh turns otherwise.
    wheels : tuple of two Wheel, optional
        Wheels 3 and 2 if they are not equal, or their bearings are not the same in y and z. The
        fields above then hold the values of wheel 3 along the mesh line.
    terms : GeneralTerms
        What eq. (1) contains besides.
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
    initial_state: "State | None" = None
    final_nu: float | None = None
    wheels: tuple[Wheel, Wheel] | None = None
    terms: GeneralTerms = GeneralTerms()

    @property
    def both_wheels(self) -> tuple[Wheel, Wheel]:
        """Wheels 3 and 2, equal ones too."""
        if self.wheels is not None:
            return self.wheels
        wheel = Wheel(
            self.teeth,
            self.base_radius,
            2.0,
            self.body_mass,
            (self.bearing_stiffness, self.bearing_stiffness),
            (self.bearing_damping_ratio, self.bearing_damping_ratio),
        )
        return wheel, wheel

    def over_periods(self, periods: int, kept: int, begun: "State | None") -> "Problem":
        """Return a run of the same pair that lasts whole mesh periods, not whole revolutions.

        The last `kept` mesh periods are kept, and the run starts from `begun`. A revolution of one
        tooth is one mesh period; both wheels keep their own teeth.
        """
        return replace(
            self,
            wheels=self.both_wheels,
            teeth=1,
            revolutions=periods,
            kept_revolutions=kept,
            initial_state=begun,
        )

    @property
    def period(self) -> float:
        """Mesh period T in tau_s."""
        return 2.0 * math.pi / self.nu

    @property
    def acceleration(self) -> float:
        """Rate of change of the mesh frequency, d nu / d tau_s."""
        if self.final_nu is None:
            return 0.0
        return (self.final_nu**2 - self.nu**2) / (4.0 * math.pi * self.periods)

    @property
    def rotation_speeds(self) -> tuple[float, float]:
        """Mean speeds of wheels 3 and 2, omega_i = omega_c / Z_i, in Omega_s."""
        wheel_3, wheel_2 = self.both_wheels
        return self.nu / wheel_3.teeth, self.nu / wheel_2.teeth

    @property
    def start_time(self) -> float:
        """Time t of eqs. (3), (4) and (6) at the start of the run."""
        return (self.start_period + self.initial_phase) * self.period

    @property
    def start_period(self) -> int:
        """Mesh periods that the wheels have turned since t = 0 when the run starts."""
        return 0 if self.initial_state is None else self.initial_state.periods

    @property
    def periods(self) -> int:
        """Mesh periods of the run."""
        return self.revolutions * self.teeth

    @property
    def kept_periods(self) -> int:
        """Mesh periods that are measured, at the end of the run."""
        return self.kept_revolutions * self.teeth

    @property
    def has_run_out(self) -> bool:
        """Whether a wheel is eccentric."""
        return self.eccentricity_3 != 0.0 or self.eccentricity_2 != 0.0


@dataclass(frozen=True, slots=True)
class State:
    """State of a run at a boundary between mesh periods.

    The end of a run (`gearmesh.solvers.response.Response.final_state`) holds all that the next run
    needs to continue it bit for bit. `gearmesh.model.motion.state_at` makes a state from y and its
    rate.

    Attributes
    ----------
    y, v : float
        Relative motion and its rate, in y_st and y_st Omega_s.
    b, b_rate : float
        Distance of the bodies along the mesh line, y_3 - y_2, and its rate.
    coordinates : tuple of 12 float, optional
        The six coordinates and their rates. A state of the reduced system does not have them. A run
        in the six coordinates that starts from it shares y and b evenly between the wheels, without
        a displacement across the mesh line.
    periods : int
        Mesh periods since t = 0. They determine the angle of the shafts, and with it that of the
        run-out.
    branches : Branches, optional
        The branches of the laws that jump. If they are missing, they are found from the numbers
        above.
    """

    y: float
    v: float
    b: float
    b_rate: float
    coordinates: tuple[float, ...] | None = None
    periods: int = 0
    branches: "Branches | None" = None

    def branches_for(self, problem: Problem) -> "Branches | None":
        """Return the branches if `problem` has the laws that they were found for."""
        if self.branches is None:
            return None
        same = _laws(self.branches.problem) == _laws(problem)
        return self.branches if same else None


@dataclass(frozen=True, slots=True)
class Branches:
    """The branches of the laws that jump, at the end of a run.

    Rounding may leave a quantity on the wrong side of the point where a law jumps. To continue a
    run bit for bit takes these discrete facts; numbers close to 0 are not enough.

    Attributes
    ----------
    problem : Problem
        The run that ended with them, without its initial state. They hold for its laws only.
    regime : int
        Of `gearmesh.model.contact`.
    direction : float
        Sign of y', 0 before the first motion.
    measured : bool
        Whether extrema were recorded up to here, so that one that falls on this boundary counts.
    signs : tuple of two float
        The two signs of eq. (6); the second is 0 while the flanks stick.
    level : float
        Level of y that was passed last.
    exact : tuple of bool
        Whether y', y - `level` and the bracket of eq. (6) are exactly 0, whether sticking has just
        ended, and whether y + s(t) and the contact force are exactly 0.
    parted : bool
        Whether the contact force is 0 although the flanks overlap (`GeneralTerms.non_adhesive`).
    """

    problem: Problem
    regime: int
    direction: float
    measured: bool
    signs: tuple[float, float] = (1.0, 1.0)
    level: float = 0.0
    exact: tuple[bool, ...] = (False,) * 6
    parted: bool = False


def _laws(problem: Problem) -> Problem:
    """Return `problem` with a fixed length and initial condition, so that only its laws count."""
    return replace(problem, revolutions=1, kept_revolutions=0, initial_state=None)
