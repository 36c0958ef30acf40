"""Every parameter of the model: printed, derived, assumed; and what follows from them.

Stored in mm, kg, s, N and rad. Sections mirror the configuration; `DERIVATIONS` lists what is
computed from them. Equation numbers are those of the paper.
"""

import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Self

from pydantic import model_validator

from gearmesh.model import stiffness
from gearmesh.model.problem import Problem
from gearmesh.model.variants import Variant
from gearmesh.study.schema import Section, quantity, validate

KINDS = {
    "printed": "printed",
    "derived": "derived",
    "assumed": "assumed",
    "run": "setting",
    "solver": "setting",
}
"""Kind of the parameters in each section; a setting says nothing about the gear."""

KG_PER_N_S2_MM = 1000.0
"""1 N s²/mm = 1000 kg: with it stiffnesses in N/mm and masses in kg go together."""


class Printed(Section):
    """Numbers that the paper prints."""

    contact_ratio: float = quantity("1", "ε", "contact ratio (mesh duration)", 1.0, 2.0)
    stiffness_ratio: float = quantity("1", "κ", "stiffness ratio C_min/C_max", 1e-3, 1.0)
    mesh_stiffness_max: float = quantity(
        "N/mm", "C_max", "mesh stiffness in double contact", 1.0, 1e9
    )
    reduced_mass: float = quantity(
        "kg", "m_red", "reduced mass of the wheels on the mesh line", 1e-6, 1e6
    )
    teeth: int = quantity("1", "Z", "number of teeth of each wheel", 3, 1000)
    damping: float = quantity(
        "N*s/mm", "k", "damping, of every term that a variant switches on", 0.0, 1e6
    )


class Derived(Section):
    """Inputs that follow from printed numbers."""

    pressure_angle: float = quantity(
        "rad", "α", "pressure angle, at which a standard pair has the printed ε", 1e-3, 0.8
    )


class Assumed(Section):
    """Inputs on which the paper is silent; the configuration gives a reason for each."""

    static_deflection: float = quantity("mm", "y_st", "static mesh deflection F_st/C_s", 1e-6, 10.0)
    backlash: float = quantity("mm", "s", "backlash on the mesh line", 1e-6, 100.0)
    damping_length: float = quantity(
        "mm", "ℓ", "length in the velocity scale ℓ Ω_s of nonlinear damping", 1e-6, 1e6
    )
    body_mass: float = quantity("kg", "m", "mass of each wheel body in y and z", 1e-6, 1e9)
    bearing_stiffness: float = quantity(
        "N/mm", "c_b", "stiffness of the support of each body in y and z", 1e-3, 1e12
    )
    bearing_damping_ratio: float = quantity(
        "1", "ζ_b", "damping ratio b_b/(2 √(c_b m)) of each support", 0.0, 1.0
    )
    friction_coefficient: float = quantity("1", "f_T", "coefficient of dry friction", 0.0, 1.0)
    eccentricity_3: float = quantity("mm", "e_3", "eccentricity of wheel 3", 0.0, 10.0)
    eccentricity_2: float = quantity("mm", "e_2", "eccentricity of wheel 2", 0.0, 10.0)
    eccentricity_angle: float = quantity(
        "rad", "Δ", "angle between the eccentricities", -2.0 * math.pi, 2.0 * math.pi
    )
    module: float = quantity("mm", "m_n", "module, for the arms of friction", 1e-2, 1000.0)
    profile_deviation: tuple[tuple[float, float], ...] = quantity(
        "mm", "f", "(cos, sin) amplitudes of harmonics 1, 2, … of the mesh frequency", -10.0, 10.0
    )
    stiffness_harmonics: int = quantity(
        "1", "n", "terms of eq. (4) that are kept; 0 is the closed rectangular wave", 0, 100
    )
    initial_phase: float = quantity(
        "1", "p_0", "start within the mesh period; 0 is the middle of the C_max pulse", 0.0, 1.0
    )


class Run(Section):
    """How long a run lasts, and what of it is kept."""

    revolutions: int = quantity("1", "n_r", "revolutions that are run", 1, 10_000)
    kept_revolutions: int = quantity("1", "n_k", "last revolutions that are kept", 1, 10_000)
    samples_per_period: int = quantity("1", "n_s", "samples of a time course", 4, 4096)

    @model_validator(mode="after")
    def _keeps_what_it_runs(self) -> Self:
        if self.kept_revolutions > self.revolutions:
            raise ValueError(
                f"kept_revolutions: found {self.kept_revolutions}; allowed are at most the "
                f"{self.revolutions} that are run"
            )
        return self


class Solver(Section):
    """Settings of the integration."""

    tolerance: float = quantity(
        "1", "tol", "local error tolerance, relative to y_st and y_st Ω_s", 1e-13, 1e-3
    )


class Parameters(Section):
    """All that a case depends on besides its variant and its frequency."""

    printed: Printed
    derived: Derived
    assumed: Assumed
    run: Run
    solver: Solver

    @property
    def stiffness_min(self) -> float:
        """C_min = κ C_max in N/mm."""
        return self.printed.stiffness_ratio * self.printed.mesh_stiffness_max

    @property
    def stiffness_mean(self) -> float:
        """C_s in N/mm, eq. (5)."""
        return stiffness.mean(
            self.printed.contact_ratio, self.printed.mesh_stiffness_max, self.stiffness_min
        )

    @property
    def natural_frequency(self) -> float:
        """Ω_s = √(C_s/m_red) in rad/s."""
        return math.sqrt(self.stiffness_mean * KG_PER_N_S2_MM / self.printed.reduced_mass)

    @property
    def damping_ratio(self) -> float:
        """D = k/(2 √(C_s m_red)), the paper's proportional damping."""
        mass = self.printed.reduced_mass / KG_PER_N_S2_MM
        return self.printed.damping / (2 * math.sqrt(self.stiffness_mean * mass))

    @property
    def static_force(self) -> float:
        """F_st = C_s y_st in N."""
        return self.stiffness_mean * self.assumed.static_deflection

    @property
    def velocity_scale(self) -> float:
        """v_ref = ℓ Ω_s in mm/s, at which all three damping terms are equal."""
        return self.assumed.damping_length * self.natural_frequency

    @property
    def base_radius(self) -> float:
        """R_b = m_n Z cos(α)/2 in mm."""
        pitch_radius = self.assumed.module * self.printed.teeth / 2
        return pitch_radius * math.cos(self.derived.pressure_angle)

    @property
    def tuning_min(self) -> float:
        """ν_min/ν_s = √(C_s/C_min)."""
        return math.sqrt(self.stiffness_mean / self.stiffness_min)

    @property
    def tuning_max(self) -> float:
        """ν_max/ν_s = √(C_s/C_max)."""
        return math.sqrt(self.stiffness_mean / self.printed.mesh_stiffness_max)

    def problem(self, variant: Variant, nu: float) -> Problem:
        """State one run in static deflections, 1/Ω_s and static forces.

        Parameters
        ----------
        variant : Variant
            Which damping terms act, and by what factor.
        nu : float
            Tuning ν_s = ω_c/Ω_s of the mesh frequency.
        """
        a, y_st, c_s = self.assumed, self.assumed.static_deflection, self.stiffness_mean
        return Problem(
            nu=nu,
            contact_ratio=self.printed.contact_ratio,
            stiffness_max=self.printed.mesh_stiffness_max / c_s,
            stiffness_min=self.stiffness_min / c_s,
            material=self._damping_law(variant.material_powers, variant.factor),
            lubricant=self._damping_law(variant.lubricant_powers, variant.factor),
            backlash=a.backlash / y_st,
            body_mass=a.body_mass / self.printed.reduced_mass,
            bearing_stiffness=a.bearing_stiffness / c_s,
            bearing_damping_ratio=a.bearing_damping_ratio,
            friction_coefficient=a.friction_coefficient,
            pressure_angle=self.derived.pressure_angle,
            teeth=self.printed.teeth,
            base_radius=self.base_radius / y_st,
            eccentricity_3=a.eccentricity_3 / y_st,
            eccentricity_2=a.eccentricity_2 / y_st,
            eccentricity_angle=a.eccentricity_angle,
            deviation=tuple((c / y_st, s / y_st) for c, s in a.profile_deviation),
            stiffness_harmonics=a.stiffness_harmonics,
            initial_phase=a.initial_phase,
            revolutions=self.run.revolutions,
            kept_revolutions=self.run.kept_revolutions,
        )

    def _damping_law(
        self, powers: tuple[bool, bool, bool], factor: float
    ) -> tuple[float, float, float]:
        """Return the coefficients of v, |v| v and v³ in eq. (7), in units of C_s y_st."""
        reach = self.assumed.static_deflection / self.assumed.damping_length
        linear, quadratic, cubic = (2.0 * self.damping_ratio * factor * acts for acts in powers)
        return linear, quadratic * reach, cubic * reach**2

    def replace(self, changes: Mapping[str, object]) -> "Parameters":
        """Return a copy with other values, such as ``{"assumed.backlash": "40 um"}``.

        Quantities carry units here too. Raises InputError for an unknown key or a wrong value.
        """
        data = {name: dict(section) for name, section in self.texts().items()}
        for key, value in changes.items():
            section, _, name = key.partition(".")
            data.setdefault(section, {})[name] = value
        return validate(Parameters, data, "", {})

    def texts(self) -> dict[str, dict[str, object]]:
        """Return every value as a configuration writes it, with its unit (`replace` reads it)."""
        return {
            section: {
                row.name: _with_unit(getattr(getattr(self, section), row.name), row.unit)
                for row in rows(section)
            }
            for section in type(self).model_fields
        }

    def canonical(self) -> str:
        """Return all values in the stored units as one line of JSON, the same for equal values."""
        return json.dumps(self.model_dump(mode="json"), sort_keys=True, separators=(",", ":"))

    def digest(self) -> str:
        """Return the SHA-256 of all values: blind to units, order and wording."""
        return hashlib.sha256(self.canonical().encode()).hexdigest()


def _with_unit(value: object, unit: str) -> object:
    if isinstance(value, tuple):
        return [_with_unit(item, unit) for item in value]
    return value if unit == "1" else f"{value!r} {unit}"


@dataclass(frozen=True, slots=True)
class Row:
    """Declaration of one parameter."""

    section: str
    name: str
    symbol: str
    unit: str
    description: str


def rows(section: str) -> Iterator[Row]:
    """List the parameters of a section, as declared."""
    for name, info in Parameters.model_fields[section].annotation.model_fields.items():
        declared = info.json_schema_extra
        yield Row(section, name, declared["symbol"], declared["unit"], info.description)


@dataclass(frozen=True, slots=True)
class Derivation:
    """A number that follows from the parameters: a property of `Parameters`, described."""

    name: str
    symbol: str
    unit: str
    formula: str

    def value(self, parameters: Parameters) -> float:
        """Compute it, in `unit`."""
        return getattr(parameters, self.name)


DERIVATIONS = (
    Derivation("stiffness_min", "C_min", "N/mm", "κ C_max"),
    Derivation("stiffness_mean", "C_s", "N/mm", "C_max (κ + (1 − κ)(ε − 1)), eq. (5)"),
    Derivation("natural_frequency", "Ω_s", "rad/s", "√(C_s/m_red)"),
    Derivation("damping_ratio", "D", "1", "k/(2 √(C_s m_red))"),
    Derivation("tuning_min", "ν_min/ν_s", "1", "√(C_s/C_min)"),
    Derivation("tuning_max", "ν_max/ν_s", "1", "√(C_s/C_max)"),
    Derivation("static_force", "F_st", "N", "C_s y_st"),
    Derivation("velocity_scale", "v_ref", "mm/s", "ℓ Ω_s"),
    Derivation("base_radius", "R_b", "mm", "m_n Z cos(α)/2"),
)
"""What follows from the parameters, in the order of their use."""
