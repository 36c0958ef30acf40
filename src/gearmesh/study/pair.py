"""The gear pair: how its parameters were stated, and what follows from them.

A `Pair` holds its values in mm, kg, s, N and rad. It stores how each value was stated, so that a
backlash of ``8 y_st`` changes with the static deflection when that is replaced.
"""

import hashlib
import json
import math
from collections.abc import Mapping
from typing import Any, NamedTuple, Self

from pydantic import PrivateAttr, model_validator

from gearmesh.errors import InputError
from gearmesh.model import stiffness
from gearmesh.model.involute import Involute
from gearmesh.model.problem import Problem
from gearmesh.model.variants import Variant
from gearmesh.study.alternatives import (
    ALTERNATIVES,
    DECLARED,
    KG_PER_N_S2_MM,
    NAMES,
    excluded_by,
    with_stored,
)
from gearmesh.study.parameters import SETTINGS, Parameters
from gearmesh.study.problem import problem_of
from gearmesh.study.reading.provenance import DEFAULT, DERIVED, SETTING, STATED, Statement
from gearmesh.study.reading.schema import nearest, of_wheels, read_declared, validate
from gearmesh.study.relative import (
    LEVELS,
    MM_PER_M,
    TABLES,
    mean_stiffness,
    resolved,
    with_levels,
)


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


class Pair(Parameters):
    """A spur gear pair, with the settings of its runs.

    `gearmesh.study.parameters` declares the fields; `Pair.parameters` lists them with units.
    Equation numbers are those of the paper.
    """

    _statements: dict[str, Statement] = PrivateAttr(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _resolve_values(cls, data: object) -> object:
        return resolved(with_stored(with_levels(data))) if isinstance(data, dict) else data

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

        Quantities carry units. Values that are stated relative to a replaced one follow it. A
        torque takes the place of the static deflection, and so on (`ALTERNATIVES`).

        Raises
        ------
        InputError
            One line: which parameter, what was found, what is allowed.
        """
        for name in changes:
            if name not in NAMES:
                hint = nearest(name, NAMES) or "; 'gearmesh parameters' lists all parameters"
                raise InputError(f"{name}: unknown key{hint}")
        new = {name: Statement(value) for name, value in changes.items()}
        kept = self._all_statements()
        for name in excluded_by(changes):
            kept.pop(name, None)
        return Pair.from_statements({**kept, **new})

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy without validation; the copy holds the values, but not how they were stated."""
        copy = super().model_copy(update=update, deep=deep)
        copy._statements = {}
        return copy

    def _all_statements(self) -> dict[str, Statement]:
        """Return the statements; a pair that was built from bare values has none."""
        if self._statements:
            return dict(self._statements)
        return {
            name: Statement(_with_unit(getattr(self, name), declared["unit"]))
            for name, declared in self.declarations().items()
            if name in self.model_fields_set
        }

    @property
    def parameters(self) -> list[Parameter]:
        """Every parameter with its value, unit, symbol, kind and reason, in a fixed order.

        Of a parameter and its alternative, such as static deflection and torque, the one that was
        stated is listed; the other one follows (`gearmesh.study.derived`).
        """
        statements = self._all_statements()
        names = list(self.declarations())
        for name, alternative in ALTERNATIVES.items():
            if name in statements and statements[name].value is not None:
                names[names.index(alternative.replaces[0])] = name
                names = [other for other in names if other not in alternative.replaces]
        if any(getattr(self, table) for table in TABLES):
            follows = Statement(
                None, DERIVED, "of the table: greatest value, and least over greatest"
            )
            statements = {**dict.fromkeys(LEVELS, follows), **statements}
        missing = Statement(None, DEFAULT)
        return [self._listed(name, statements.get(name, missing)) for name in names]

    def _listed(self, name: str, statement: Statement) -> Parameter:
        kind = statement.kind
        if name in SETTINGS and kind in (DEFAULT, STATED):
            kind = SETTING
        declared = DECLARED[name]
        return Parameter(
            *(name, declared["symbol"], getattr(self, name), declared["unit"]),
            *(declared["description"], kind, statement.reason),
        )

    @property
    def stiffness_min(self) -> float:
        """C_min = κ C_max in N/mm."""
        return self.stiffness_ratio * self.mesh_stiffness_max

    @property
    def stiffness_mean(self) -> float:
        """C_s in N/mm: eq. (5), or the mean of a stiffness that is stated as a table."""
        return mean_stiffness(
            *(self.contact_ratio, self.mesh_stiffness_max, self.stiffness_ratio),
            *(self.stiffness_table, self.tooth_pair_stiffness),
        )

    @property
    def natural_frequency(self) -> float:
        """Ω_s = √(C_s/m_red) in rad/s."""
        return math.sqrt(self.stiffness_mean * KG_PER_N_S2_MM / self.reduced_mass)

    @property
    def resonance_speed(self) -> float:
        """Speed of wheel 3 in rpm at which ν_s = 1: 60 Ω_s/(2π Z_3)."""
        return 60.0 * self.natural_frequency / (2.0 * math.pi * self.teeth_3)

    @property
    def final_speed(self) -> float | None:
        """Speed of wheel 3 in rpm at the end of a run whose speed changes; None if it does not."""
        if self.final_nu is None:
            return None
        return self._as_stated("final_speed", self.final_nu * self.resonance_speed)

    @property
    def damping_ratio(self) -> float:
        """D = k/(2 √(C_s m_red)), the paper's proportional damping."""
        return self._as_stated("damping_ratio", self.damping_ratio_of(self.damping))

    def damping_ratio_of(self, damping: float) -> float:
        """Return k/(2 √(C_s m_red)) of a damping coefficient k in N·s/mm."""
        mass = self.reduced_mass / KG_PER_N_S2_MM
        return damping / (2 * math.sqrt(self.stiffness_mean * mass))

    @property
    def static_force(self) -> float:
        """F_st = C_s y_st in N."""
        return self.stiffness_mean * self.static_deflection

    @property
    def torque(self) -> float:
        """M_3 = F_st R_b3 in N·m."""
        return self._as_stated("torque", self.static_force * self.base_radius / MM_PER_M)

    @property
    def inertia(self) -> tuple[float, float]:
        """J_3 and J_2 in kg·m², with m_red = 1/(R_b3²/J_3 + R_b2²/J_2)."""
        masses = 1.0 + self.mass_ratio, 1.0 + 1.0 / self.mass_ratio
        inertias = (
            mass * self.reduced_mass * (radius / MM_PER_M) ** 2
            for mass, radius in zip(masses, self.base_radii, strict=True)
        )
        return self._as_stated("inertia", tuple(inertias))

    def _as_stated(self, name: str, computed: Any) -> Any:
        """Return an alternative as it was stated; converting it back would round it."""
        statement = self._statements.get(name)
        if statement is None or statement.value is None:
            return computed
        return read_declared(statement.value, DECLARED[name])

    @property
    def velocity_scale(self) -> float:
        """v_ref = ℓ Ω_s in mm/s, at which all three damping terms are equal."""
        return self.damping_length * self.natural_frequency

    @property
    def teeth_3(self) -> int:
        """Z_3, the mesh periods in a revolution of wheel 3, which is what revolutions count."""
        return int(of_wheels(self.teeth)[0])

    @property
    def base_radii(self) -> tuple[float, float]:
        """R_b3 and R_b2 in mm."""
        teeth_3, teeth_2 = of_wheels(self.teeth)
        return (
            self.module * teeth_3 / 2 * math.cos(self.pressure_angle),
            self.module * teeth_2 / 2 * math.cos(self.pressure_angle),
        )

    @property
    def base_radius(self) -> float:
        """R_b3 = m_n Z_3 cos(α)/2 in mm."""
        return self.base_radii[0]

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
        """Contact ratio of two standard wheels (addendum m_n) with Z_3 and Z_2 teeth, angle α."""
        wheels = Involute(self.module, of_wheels(self.teeth), self.pressure_angle)
        return wheels.contact_ratio

    def problem(self, variant: Variant, nu: float) -> Problem:
        """State one run in static deflections, 1/Ω_s and static forces.

        Parameters
        ----------
        variant : Variant
            Which damping terms act, and by what factor.
        nu : float
            Mesh frequency ν_s = ω_c/Ω_s.
        """
        return problem_of(self, variant, nu)

    def canonical(self) -> str:
        """Return all values in the stored units as one line of JSON, the same for equal values."""
        return json.dumps(self.model_dump(mode="json"), sort_keys=True, separators=(",", ":"))

    def digest(self) -> str:
        """Return the SHA-256 of all values; the stated units, order and wording have no effect."""
        return hashlib.sha256(self.canonical().encode()).hexdigest()


def _with_unit(value: object, unit: str) -> object:
    if isinstance(value, tuple):
        return [_with_unit(item, unit) for item in value]
    return value if unit == "1" or value is None else f"{value!r} {unit}"
