"""The parameters of a gear pair and of its runs: unit, symbol, meaning and range of each."""

import math
from typing import Literal, Self

from pydantic import model_validator

from gearmesh.study.flanks import check_flanks
from gearmesh.study.frequencies import NU_MAX, NU_MIN
from gearmesh.study.harmonics import BacklashHarmonic, ToothStiffness, TorqueHarmonic
from gearmesh.study.reading.schema import Section, of_wheels, quantity

SETTINGS = frozenset(
    {"initial_phase", "initial_displacement", "initial_velocity"}
    | {"initial_coordinates", "initial_rates", "final_nu"}
    | {"revolutions", "kept_revolutions", "samples_per_period", "tolerance"}
)
"""Parameters of a run. They state nothing about the gear."""


_STIFFNESSES = (
    "stiffness_harmonics",
    "stiffness_fourier",
    "stiffness_table",
    "tooth_pair_stiffness",
)


MOST_HARMONICS = 100
"""Higher harmonics shorten the steps of the solver: a run with 2,000 would take many minutes."""


MOST_SAMPLES = 10_000_000
"""Most samples that a run may keep. Each takes some 440 bytes of memory, so together 4.4 GB."""

MOST_SWEPT_SAMPLES = 3 * MOST_SAMPLES
"""Most samples that all runs of a sweep may keep. Each takes some 210 bytes, so together 6.4 GB."""


class Parameters(Section):
    """The declared parameters, in the order in which they are listed.

    `gearmesh.study.pair.Pair` adds how each was stated and what follows from them.
    """

    contact_ratio: float = quantity("1", "ε", "contact ratio (mesh duration)", 1.0, 3.0)
    stiffness_ratio: float = quantity("1", "κ", "stiffness ratio C_min/C_max", 1e-3, 1.0)
    mesh_stiffness_max: float = quantity(
        "N/mm", "C_max", "mesh stiffness in double contact", 1.0, 1e9
    )
    reduced_mass: float = quantity(
        "kg", "m_red", "reduced mass of the wheels on the mesh line", 1e-6, 1e6
    )
    mass_ratio: float = quantity(
        *("1", "μ", "ratio of the wheels' masses on the mesh line, (J_3/R_b3²)/(J_2/R_b2²)"),
        *(1e-6, 1e6),
        default=1.0,
    )
    teeth: int | tuple[int, int] = quantity(
        "1", "Z", "number of teeth of the wheels", 3, 1000, may_differ=True
    )
    damping: float = quantity(
        "N*s/mm", "k", "damping of every term that a variant switches on", 0.0, 1e6
    )
    damping_1: float | None = quantity(
        "N*s/mm", "k_1", "linear damping of the material, if not k", 0.0, 1e6, default=None
    )
    damping_2: float | None = quantity(
        "N*s/mm", "k_2", "quadratic damping of the material, if not k", 0.0, 1e6, default=None
    )
    damping_3: float | None = quantity(
        "N*s/mm", "k_3", "cubic damping of the material, if not k", 0.0, 1e6, default=None
    )
    damping_1m: float | None = quantity(
        "N*s/mm", "k_1m", "linear damping of the lubricant, if not k", 0.0, 1e6, default=None
    )
    damping_2m: float | None = quantity(
        "N*s/mm", "k_2m", "quadratic damping of the lubricant, if not k", 0.0, 1e6, default=None
    )
    damping_3m: float | None = quantity(
        "N*s/mm", "k_3m", "cubic damping of the lubricant, if not k", 0.0, 1e6, default=None
    )
    static_deflection: float = quantity("mm", "y_st", "static mesh deflection F_st/C_s", 1e-6, 10.0)
    backlash: float = quantity("mm", "s", "backlash on the mesh line", 1e-6, 100.0)
    damping_length: float = quantity(
        "mm", "ℓ", "length in the velocity scale ℓ Ω_s of nonlinear damping", 1e-6, 1e6
    )
    body_mass: float | tuple[float, float] = quantity(
        "kg", "m", "mass of the wheel bodies in y and z", 1e-6, 1e9, may_differ=True
    )
    bearing_stiffness: float | tuple[float, float] = quantity(
        "N/mm", "c_b", "stiffness of the bearings in y and z", 1e-3, 1e12, may_differ=True
    )
    bearing_damping_ratio: float | tuple[float, float] = quantity(
        "1", "ζ_b", "damping ratio b_b/(2 √(c_b m)) of the bearings", 0.0, 1.0, may_differ=True
    )
    friction_coefficient: float = quantity("1", "f_T", "coefficient of dry friction", 0.0, 1.0)
    pressure_angle: float = quantity("rad", "α", "pressure angle", 1e-3, 0.8)
    module: float = quantity("mm", "m_n", "module, for the arms of friction", 1e-2, 1000.0)
    eccentricity: tuple[float, float] = quantity(
        *("mm", "e", "eccentricity of the wheels: one value, or two for wheels 3 and 2", 0.0, 10.0),
        of_wheels=True,
        default=(0.0, 0.0),
    )
    eccentricity_angle: float = quantity(
        *("rad", "Δ", "angle between the eccentricities", -2.0 * math.pi, 2.0 * math.pi),
        default=0.0,
    )
    profile_deviation: tuple[tuple[float, float], ...] = quantity(
        *("mm", "f", "(cos, sin) amplitudes of harmonics 1, 2, … of the mesh frequency"),
        *(-10.0, 10.0),
        default=(),
        max_length=MOST_HARMONICS,
    )
    stiffness_harmonics: int = quantity(
        *(
            "1",
            "n",
            "terms of eq. (4) that are kept; 0 is the closed rectangular wave",
            0,
            MOST_HARMONICS,
        ),
        default=0,
    )
    bearing_stiffness_z: float | tuple[float, float] | None = quantity(
        *("N/mm", "c_bz", "stiffness of the bearings across the mesh line, if not c_b", 1e-3, 1e12),
        may_differ=True,
        default=None,
    )
    bearing_damping_ratio_z: float | tuple[float, float] | None = quantity(
        *("1", "ζ_bz", "damping ratio of the bearings across the mesh line, if not ζ_b", 0.0, 1.0),
        may_differ=True,
        default=None,
    )
    torsional_damping: tuple[float, float] = quantity(
        *("N*m*s/rad", "b_φ", "damping of the rotation of the wheels to the frame", 0.0, 1e9),
        of_wheels=True,
        default=(0.0, 0.0),
    )
    torque_harmonics: tuple[TorqueHarmonic, ...] = quantity(
        *("1", "a_n, b_n", "harmonics of the torques, relative to the static ones", 0.0, 0.0),
        structured=True,
        default=(),
    )
    stiffness_fourier: tuple[tuple[float, float], ...] = quantity(
        *("1", "U_n, V_n", "(cos, sin) amplitudes of C(t)/C_s, harmonics 1, 2, …", -10.0, 10.0),
        default=(),
        max_length=MOST_HARMONICS,
    )
    stiffness_table: tuple[float, ...] = quantity(
        *("N/mm", "C(t)", "mesh stiffness at equal distances over a mesh period", 0.0, 1e9),
        default=(),
    )
    tooth_pair_stiffness: tuple[float, ...] = quantity(
        *("N/mm", "c(x)", "stiffness of a pair of teeth at equal distances along its path"),
        *(0.0, 1e9),
        default=(),
    )
    tooth_factors: tuple[ToothStiffness, ...] = quantity(
        *("1", "c_z", "factors of the stiffness of single teeth", 0.0, 0.0),
        structured=True,
        default=(),
    )
    restoring_2: float = quantity(
        "1", "c_2", "quadratic part of the elastic force, in 1/y_st", -10.0, 10.0, default=0.0
    )
    restoring_3: float = quantity(
        "1", "c_3", "cubic part of the elastic force, in 1/y_st²", -10.0, 10.0, default=0.0
    )
    restoring_fourier: tuple[tuple[float, float], ...] = quantity(
        *("1", "I_n", "(cos, sin) by which c_2 and c_3 vary, harmonics 1, 2, … of the mesh"),
        *(-10.0, 10.0),
        default=(),
        max_length=MOST_HARMONICS,
    )
    restoring_power: float = quantity(
        *("1", "p", "power of the depth in the elastic force: for Hertz 10/9 or 3/2", 1.0, 2.0),
        default=1.0,
    )
    non_adhesive: bool = quantity(
        *("1", "N ≥ 0", "whether the contact force never pulls", 0.0, 1.0),
        structured=True,
        default=False,
    )
    damping_follows_stiffness: Literal["none", "sqrt", "linear"] = quantity(
        *("1", "k(C)", "how the damping of the material follows C(t)/C_s", 0.0, 1.0),
        structured=True,
        default="none",
    )
    backlash_harmonics: tuple[BacklashHarmonic, ...] = quantity(
        *("mm", "s(t)", "harmonics of the backlash", 0.0, 0.0),
        structured=True,
        default=(),
    )
    backlash_follows_centres: bool = quantity(
        *("1", "s(y, z)", "whether s changes with the distance of the wheels' centres", 0.0, 1.0),
        structured=True,
        default=False,
    )
    pitch_errors: tuple[tuple[float, ...], ...] = quantity(
        *("mm", "F_p", "how far each tooth stands out, a list for each of wheels 3 and 2"),
        *(-10.0, 10.0),
        default=(),
    )
    tip_relief: tuple[float, float] = quantity(
        *("mm", "C_a", "how far the flanks of wheels 3 and 2 stand back at the tip", 0.0, 10.0),
        of_wheels=True,
        default=(0.0, 0.0),
    )
    tip_relief_length: tuple[float, float] = quantity(
        *("mm", "L_a", "length of the tip relief along the path of contact", 0.0, 1e4),
        of_wheels=True,
        default=(0.0, 0.0),
    )
    initial_phase: float = quantity(
        *("1", "p_0", "mesh phase at which a run starts; 0: middle of the C_max pulse", 0.0, 1.0),
        default=0.0,
    )
    initial_displacement: float | None = quantity(
        *("mm", "y_0", "initial relative motion y; static equilibrium if open", -1e3, 1e3),
        default=None,
    )
    initial_velocity: float = quantity(
        "mm", "y'_0", "initial dy/dτ_s, τ_s = Ω_s t", -1e3, 1e3, default=0.0
    )
    initial_coordinates: tuple[float, ...] = quantity(
        *("mm", "q_0", "initial R_b3 φ_3, R_b2 φ_2, y_3, y_2, z_3, z_2; by default as for y_0"),
        *(-1e3, 1e3),
        default=(),
    )
    initial_rates: tuple[float, ...] = quantity(
        *("mm", "q'_0", "initial dq/dτ_s of these six, τ_s = Ω_s t; by default 0", -1e3, 1e3),
        default=(),
    )
    final_nu: float | None = quantity(
        *("1", "ν_e", "ν_s at the end of a speed ramp, linear in time; constant speed if open"),
        *(NU_MIN, NU_MAX),
        default=None,
    )
    revolutions: int = quantity("1", "n_r", "revolutions that are run", 1, 10_000, default=5)
    kept_revolutions: int = quantity(
        "1", "n_k", "last revolutions that are kept", 1, 10_000, default=1
    )
    samples_per_period: int = quantity(
        "1", "n_s", "samples of a time course in a mesh period", 4, 4096, default=256
    )
    tolerance: float = quantity(
        *("1", "tol", "local error tolerance, relative to y_st and y_st Ω_s", 1e-13, 1e-3),
        default=1e-10,
    )

    @model_validator(mode="after")
    def _states_one_stiffness(self) -> Self:
        stated = [name for name in _STIFFNESSES if getattr(self, name)]
        if len(stated) > 1:
            raise ValueError(f"{stated[1]}: stated beside {stated[0]}; allowed is one of the two")
        for name in ("stiffness_table", "tooth_pair_stiffness"):
            values = getattr(self, name)
            if values and (len(values) < 2 or sum(values) == 0.0):
                raise ValueError(
                    f"{name}: found {list(values)}; allowed are two values or more, not all 0"
                )
        if self.contact_ratio > 2.0 and not self.tooth_pair_stiffness:
            raise ValueError(
                f"contact_ratio: found {self.contact_ratio:g}; allowed are 1 to 2, and up to 3 "
                "with tooth_pair_stiffness: eqs. (4) and (5) hold no further"
            )
        return self

    @model_validator(mode="after")
    def _has_flanks_that_fit(self) -> Self:
        check_flanks(self)
        return self

    @model_validator(mode="after")
    def _starts_from_one_state(self) -> Self:
        for name in ("initial_coordinates", "initial_rates"):
            values = getattr(self, name)
            if len(values) not in (0, 6):
                raise ValueError(f"{name}: found {len(values)} values; allowed are six")
            if values and (self.initial_displacement is not None or self.initial_velocity):
                raise ValueError(
                    f"{name}: stated beside initial_displacement or initial_velocity; allowed are "
                    "the six coordinates, or y and its rate"
                )
        return self

    @model_validator(mode="after")
    def _keeps_what_it_runs(self) -> Self:
        if self.kept_revolutions > self.revolutions:
            raise ValueError(
                f"kept_revolutions: found {self.kept_revolutions}; allowed are at most the "
                f"{self.revolutions} that are run"
            )
        if self.kept_samples > MOST_SAMPLES:
            most = MOST_SAMPLES * self.kept_revolutions // self.kept_samples
            raise ValueError(
                f"kept_revolutions: found {self.kept_revolutions}, which makes {self.kept_samples} "
                "samples (teeth × samples_per_period × kept_revolutions); allowed are at most "
                f"{MOST_SAMPLES}, here {most} revolutions"
            )
        return self

    @property
    def kept_samples(self) -> int:
        """Samples of the time course of a run."""
        return self.kept_revolutions * int(of_wheels(self.teeth)[0]) * self.samples_per_period
