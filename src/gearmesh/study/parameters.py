"""The parameters of a gear pair and of its runs: unit, symbol, meaning and range of each."""

import math
from typing import Self

from pydantic import model_validator

from gearmesh.study.schema import Section, quantity

SETTINGS = frozenset(
    {"initial_phase", "initial_displacement", "initial_velocity"}
    | {"revolutions", "kept_revolutions", "samples_per_period", "tolerance"}
)
"""Parameters of a run. They state nothing about the gear."""


class Parameters(Section):
    """The declared parameters, in the order in which they are listed.

    `gearmesh.study.pair.Pair` adds how each was stated and what follows from them.
    """

    contact_ratio: float = quantity("1", "ε", "contact ratio (mesh duration)", 1.0, 2.0)
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
    teeth: int = quantity("1", "Z", "number of teeth of each wheel", 3, 1000)
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
    body_mass: float = quantity("kg", "m", "mass of each wheel body in y and z", 1e-6, 1e9)
    bearing_stiffness: float = quantity(
        "N/mm", "c_b", "stiffness of the bearing of each body in y and z", 1e-3, 1e12
    )
    bearing_damping_ratio: float = quantity(
        "1", "ζ_b", "damping ratio b_b/(2 √(c_b m)) of each bearing", 0.0, 1.0
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
    )
    stiffness_harmonics: int = quantity(
        *("1", "n", "terms of eq. (4) that are kept; 0 is the closed rectangular wave", 0, 100),
        default=0,
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
    def _keeps_what_it_runs(self) -> Self:
        if self.kept_revolutions > self.revolutions:
            raise ValueError(
                f"kept_revolutions: found {self.kept_revolutions}; allowed are at most the "
                f"{self.revolutions} that are run"
            )
        return self
