"""The gear pair: every parameter with its unit, where its value comes from, and what follows.

A `Pair` holds its values in mm, kg, s, N and rad. It stores how each value was stated, so that a
backlash of ``8 y_st`` changes with the static deflection when that is replaced.
"""

import hashlib
import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple, Self

from pydantic import PrivateAttr, model_validator

from gearmesh.model import stiffness
from gearmesh.model.motion import state_at
from gearmesh.model.problem import Problem
from gearmesh.model.variants import Variant
from gearmesh.study import units
from gearmesh.study.provenance import DEFAULT, SETTING, STATED, Statement
from gearmesh.study.schema import Section, quantity, read_quantity, shown, validate

KG_PER_N_S2_MM = 1000.0
"""1 N s²/mm = 1000 kg: it makes stiffnesses in N/mm and masses in kg consistent."""

SETTINGS = frozenset(
    {"initial_phase", "initial_displacement", "initial_velocity"}
    | {"revolutions", "kept_revolutions", "samples_per_period", "tolerance"}
)
"""Parameters of a run. They state nothing about the gear."""


class Parameter(NamedTuple):
    """One parameter of a pair, as `Pair.parameters` lists it.

    Attributes
    ----------
    name, symbol : str
        Its name everywhere, and its symbol in the paper.
    value : float, int, tuple or None
        Value in `unit`; None if the parameter is left open.
    unit : str
        Unit of `value`; ``"1"`` for a plain number.
    description : str
        What it is.
    kind : str
        ``"printed"``, ``"derived"``, ``"assumed"``, ``"stated"``, ``"default"`` or ``"setting"``.
    reason : str
        Why it has this value, or where it was printed; may be empty.
    """

    name: str
    symbol: str
    value: Any
    unit: str
    description: str
    kind: str
    reason: str


class Pair(Section):
    """A spur gear pair of equal wheels, with the settings of its runs.

    The docstring of each field is its description; `Pair.parameters` lists them with units.
    Equation numbers are those of the paper.
    """

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

    _statements: dict[str, Statement] = PrivateAttr(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _resolve_relative_values(cls, data: object) -> object:
        return _resolved(data) if isinstance(data, dict) else data

    @model_validator(mode="after")
    def _keeps_what_it_runs(self) -> Self:
        if self.kept_revolutions > self.revolutions:
            raise ValueError(
                f"kept_revolutions: found {self.kept_revolutions}; allowed are at most the "
                f"{self.revolutions} that are run"
            )
        return self

    @classmethod
    def from_statements(
        cls,
        statements: Mapping[str, Statement],
        where: str = "",
        changed: Mapping[str, str] | None = None,
    ) -> "Pair":
        """Build a pair from what is stated of each parameter.

        Parameters
        ----------
        statements : mapping of str to Statement
            By the names of the parameters.
        where : str
            The file that they come from, for messages.
        changed : mapping of str to str
            Names whose value came from elsewhere, and from where.

        Raises
        ------
        InputError
            One line: which parameter, what was found, what is allowed.
        """
        values = {name: statement.value for name, statement in statements.items()}
        pair = validate(cls, values, where, changed or {})
        pair._statements = dict(statements)
        return pair

    def replace(self, **changes: object) -> "Pair":
        """Return a pair with other values, such as ``replace(backlash="40 um", teeth=24)``.

        Quantities carry units. Values that are stated relative to a replaced one follow it.

        Raises
        ------
        InputError
            One line: which parameter, what was found, what is allowed.
        """
        new = {name: Statement(value) for name, value in changes.items()}
        return Pair.from_statements({**self._all_statements(), **new})

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy without validation; the copy holds the values, but not how they were stated."""
        copy = super().model_copy(update=update, deep=deep)
        copy._statements = {}
        return copy

    def _all_statements(self) -> dict[str, Statement]:
        """Return the statements; a pair that was built from bare values has none."""
        if self._statements:
            return self._statements
        return {
            name: Statement(_with_unit(getattr(self, name), declared["unit"]))
            for name, declared in _declarations()
            if name in self.model_fields_set
        }

    @property
    def parameters(self) -> list[Parameter]:
        """Every parameter with its value, unit, symbol, kind and reason, in a fixed order."""
        statements = self._all_statements()
        listed = []
        for name, declared in _declarations():
            statement = statements.get(name, Statement(None, DEFAULT))
            kind = statement.kind
            if name in SETTINGS and kind in (DEFAULT, STATED):
                kind = SETTING
            description = type(self).model_fields[name].description or ""
            value = getattr(self, name)
            listed.append(
                Parameter(
                    *(name, declared["symbol"], value, declared["unit"]),
                    *(description, kind, statement.reason),
                )
            )
        return listed

    @property
    def stiffness_min(self) -> float:
        """C_min = κ C_max in N/mm."""
        return self.stiffness_ratio * self.mesh_stiffness_max

    @property
    def stiffness_mean(self) -> float:
        """C_s in N/mm, eq. (5)."""
        return stiffness.mean(self.contact_ratio, self.mesh_stiffness_max, self.stiffness_min)

    @property
    def natural_frequency(self) -> float:
        """Ω_s = √(C_s/m_red) in rad/s."""
        return math.sqrt(self.stiffness_mean * KG_PER_N_S2_MM / self.reduced_mass)

    @property
    def damping_ratio(self) -> float:
        """D = k/(2 √(C_s m_red)), the paper's proportional damping."""
        return self._damping_ratio(self.damping)

    def _damping_ratio(self, damping: float) -> float:
        mass = self.reduced_mass / KG_PER_N_S2_MM
        return damping / (2 * math.sqrt(self.stiffness_mean * mass))

    @property
    def static_force(self) -> float:
        """F_st = C_s y_st in N."""
        return self.stiffness_mean * self.static_deflection

    @property
    def velocity_scale(self) -> float:
        """v_ref = ℓ Ω_s in mm/s, at which all three damping terms are equal."""
        return self.damping_length * self.natural_frequency

    @property
    def base_radius(self) -> float:
        """R_b = m_n Z cos(α)/2 in mm."""
        return self.module * self.teeth / 2 * math.cos(self.pressure_angle)

    @property
    def nu_min_ratio(self) -> float:
        """ν_min/ν_s = √(C_s/C_min)."""
        return math.sqrt(self.stiffness_mean / self.stiffness_min)

    @property
    def nu_max_ratio(self) -> float:
        """ν_max/ν_s = √(C_s/C_max)."""
        return math.sqrt(self.stiffness_mean / self.mesh_stiffness_max)

    @property
    def switch_phase(self) -> float:
        """(ε − 1)/2, the phase of the mesh period at which C(t) falls to C_min."""
        return stiffness.switch_phases(self.contact_ratio)[0]

    @property
    def standard_contact_ratio(self) -> float:
        """Contact ratio of two standard wheels (addendum m_n) with Z teeth and angle α.

        The path of contact over the base pitch: ε = 2 (√(r_a² − r_b²) − r sin α)/(π m_n cos α).
        """
        pitch_radius, angle = self.teeth / 2, self.pressure_angle
        tip_radius, base_radius = pitch_radius + 1, pitch_radius * math.cos(angle)
        path = 2 * (math.sqrt(tip_radius**2 - base_radius**2) - pitch_radius * math.sin(angle))
        return path / (math.pi * math.cos(angle))

    def problem(self, variant: Variant, nu: float) -> Problem:
        """State one run in static deflections, 1/Ω_s and static forces.

        Parameters
        ----------
        variant : Variant
            Which damping terms act, and by what factor.
        nu : float
            Mesh frequency ν_s = ω_c/Ω_s.
        """
        y_st, c_s = self.static_deflection, self.stiffness_mean
        eccentricity_3, eccentricity_2 = self.eccentricity
        problem = Problem(
            nu=nu,
            contact_ratio=self.contact_ratio,
            stiffness_max=self.mesh_stiffness_max / c_s,
            stiffness_min=self.stiffness_min / c_s,
            material=self._damping_law(
                variant.material_powers, (self.damping_1, self.damping_2, self.damping_3), variant
            ),
            lubricant=self._damping_law(
                *(variant.lubricant_powers, (self.damping_1m, self.damping_2m, self.damping_3m)),
                variant,
            ),
            backlash=self.backlash / y_st,
            body_mass=self.body_mass / self.reduced_mass,
            bearing_stiffness=self.bearing_stiffness / c_s,
            bearing_damping_ratio=self.bearing_damping_ratio,
            friction_coefficient=self.friction_coefficient,
            pressure_angle=self.pressure_angle,
            teeth=self.teeth,
            base_radius=self.base_radius / y_st,
            eccentricity_3=eccentricity_3 / y_st,
            eccentricity_2=eccentricity_2 / y_st,
            eccentricity_angle=self.eccentricity_angle,
            deviation=tuple((c / y_st, s / y_st) for c, s in self.profile_deviation),
            stiffness_harmonics=self.stiffness_harmonics,
            initial_phase=self.initial_phase,
            revolutions=self.revolutions,
            kept_revolutions=self.kept_revolutions,
        )
        if self.initial_displacement is None and self.initial_velocity == 0.0:
            return problem  # at rest in static equilibrium
        y = 1.0 if self.initial_displacement is None else self.initial_displacement / y_st
        return replace(problem, initial_state=state_at(problem, y, self.initial_velocity / y_st))

    def _damping_law(
        self,
        powers: tuple[bool, bool, bool],
        stated: Iterable[float | None],
        variant: Variant,
    ) -> tuple[float, float, float]:
        """Return the coefficients of v, |v| v and v³ in eq. (7), in units of C_s y_st."""
        reach = self.static_deflection / self.damping_length
        linear, quadratic, cubic = (
            2.0 * self._damping_ratio(self.damping if k is None else k) * variant.factor * acts
            for acts, k in zip(powers, stated, strict=True)
        )
        return linear, quadratic * reach, cubic * reach**2

    def canonical(self) -> str:
        """Return all values in the stored units as one line of JSON, the same for equal values."""
        return json.dumps(self.model_dump(mode="json"), sort_keys=True, separators=(",", ":"))

    def digest(self) -> str:
        """Return the SHA-256 of all values; the stated units, order and wording have no effect."""
        return hashlib.sha256(self.canonical().encode()).hexdigest()


def _declarations() -> list[tuple[str, dict[str, Any]]]:
    """Return the name and the declaration (unit, symbol, range) of each parameter."""
    declared = []
    for name, info in Pair.model_fields.items():
        assert isinstance(info.json_schema_extra, dict)
        declared.append((name, dict(info.json_schema_extra)))
    return declared


def _with_unit(value: object, unit: str) -> object:
    if isinstance(value, tuple):
        return [_with_unit(item, unit) for item in value]
    return value if unit == "1" or value is None else f"{value!r} {unit}"


def _resolved(data: dict[str, Any]) -> dict[str, Any]:
    """Replace values such as ``8 y_st`` by quantities."""
    found = dict(data)
    for scale, unit in units.SCALES.items():
        relative = [name for name, value in data.items() if units.is_multiple(value, scale)]
        size = _scale(scale, data, relative[0]) if relative else 0.0
        for name in relative:
            found[name] = units.scaled(found[name], scale, size, unit)
    return found


def _scale(scale: str, data: Mapping[str, Any], user: str) -> float:
    """Return the size of a scale, for `user` and other parameters that are stated in it.

    A mistake in the scale itself is reported here, once, and not for each of them.
    """
    declared = dict(_declarations())

    def read(parameter: str) -> float:
        if data.get(parameter) is None:
            raise ValueError(f"{parameter}: missing; {user} is stated in {scale}")
        try:
            return float(read_quantity(data[parameter], declared[parameter]))  # type: ignore[arg-type]
        except (ValueError, TypeError) as error:
            raise ValueError(f"{parameter}: found {shown(data[parameter])}; {error}") from None

    if scale == "y_st":
        return read("static_deflection")
    if scale == "m_red":
        return read("reduced_mass")
    highest = read("mesh_stiffness_max")
    return stiffness.mean(read("contact_ratio"), highest, read("stiffness_ratio") * highest)


class Quantity(NamedTuple):
    """A number that follows from the parameters: a property of `Pair`, described."""

    name: str
    symbol: str
    unit: str
    formula: str

    def value(self, pair: Pair) -> float:
        """Compute it, in `unit`."""
        return float(getattr(pair, self.name))


DERIVED = (
    Quantity("stiffness_min", "C_min", "N/mm", "κ C_max"),
    Quantity("stiffness_mean", "C_s", "N/mm", "C_max (κ + (1 − κ)(ε − 1)), eq. (5)"),
    Quantity("natural_frequency", "Ω_s", "rad/s", "√(C_s/m_red)"),
    Quantity("damping_ratio", "D", "1", "k/(2 √(C_s m_red))"),
    Quantity("nu_min_ratio", "ν_min/ν_s", "1", "√(C_s/C_min)"),
    Quantity("nu_max_ratio", "ν_max/ν_s", "1", "√(C_s/C_max)"),
    Quantity("static_force", "F_st", "N", "C_s y_st"),
    Quantity("velocity_scale", "v_ref", "mm/s", "ℓ Ω_s"),
    Quantity("base_radius", "R_b", "mm", "m_n Z cos(α)/2"),
    Quantity("switch_phase", "(ε − 1)/2", "1", "phase at which C(t) falls to C_min"),
    Quantity("standard_contact_ratio", "ε(Z, α)", "1", "contact ratio of standard wheels"),
)
"""What follows from the parameters, in the order of their use."""
