"""What engineers state in place of a stored parameter: torque, inertias, damping ratio, speed.

A pair stores one parameter of each two, and the other follows from it (`gearmesh.study.pair`).
"""

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, NamedTuple

from gearmesh.study.frequencies import read_nu
from gearmesh.study.parameters import Parameters
from gearmesh.study.reading.schema import Section, of_wheels, quantity
from gearmesh.study.relative import MM_PER_M, read_parameter, stated_mean_stiffness

KG_PER_N_S2_MM = 1000.0
"""1 N s²/mm = 1000 kg: it makes stiffnesses in N/mm and masses in kg consistent."""


class Alternatives(Section):
    """The alternatives, declared as the parameters are."""

    torque: float = quantity("N*m", "M_3", "static torque on wheel 3", 1e-9, 1e12)
    inertia: tuple[float, float] = quantity(
        *("kg*m^2", "J", "moment of inertia of the wheels: one value, or two for wheels 3 and 2"),
        *(1e-12, 1e12),
        of_wheels=True,
    )
    damping_ratio: float = quantity(
        "1", "D", "damping ratio k/(2 √(C_s m_red)) of every term that acts", 0.0, 10.0
    )
    final_speed: float = quantity(
        "rpm", "n_e", "speed of wheel 3 at the end of a speed ramp, linear in time", 1e-6, 1e6
    )


class Alternative(NamedTuple):
    """What may be stated in place of stored parameters.

    Attributes
    ----------
    replaces : tuple of str
        The stored parameters; the first is required if the alternative is not stated.
    formula : str
        How the first of them follows.
    """

    replaces: tuple[str, ...]
    formula: str


ALTERNATIVES = {
    "torque": Alternative(("static_deflection",), "M_3/(R_b3 C_s)"),
    "inertia": Alternative(("reduced_mass", "mass_ratio"), "1/(R_b3²/J_3 + R_b2²/J_2)"),
    "damping_ratio": Alternative(("damping",), "2 D √(C_s m_red)"),
    "final_speed": Alternative(("final_nu",), "2π n_e Z_3/(60 Ω_s)"),
}

NAMES = (*Parameters.model_fields, *ALTERNATIVES)
"""Names of all parameters that a study may state."""

DECLARED = {**Parameters.declarations(), **Alternatives.declarations()}
"""Their declarations: unit, symbol, range."""

Read = Callable[[str], Any]
"""Returns a parameter by its name, in its unit."""


def excluded_by(names: Mapping[str, object]) -> set[str]:
    """Return the parameters that must not be stated beside the ones that `names` gives values."""
    found: set[str] = set()
    for name, alternative in ALTERNATIVES.items():
        if names.get(name) is not None:
            found |= {*alternative.replaces}
        if any(names.get(other) is not None for other in alternative.replaces):
            found.add(name)
    return found


def with_stored(data: Mapping[str, Any]) -> dict[str, Any]:
    """Replace the alternatives in `data` by the parameters that are stored.

    Raises
    ------
    ValueError
        If one is stated beside a parameter that it replaces, or cannot be read; the message begins
        with its name.
    """
    found = dict(data)
    for name, alternative in ALTERNATIVES.items():
        if found.get(name) is None:
            found.pop(name, None)
            continue
        for other in alternative.replaces:
            if data.get(other) is not None:
                raise ValueError(f"{name}: stated beside {other}; allowed is one of the two")
        reason = f"{name} is stated"
        read = partial(read_parameter, data=found, declared=DECLARED, reason=reason)
        found |= _STORED[name](read)
        del found[name]
    return found


def _static_deflection(read: Read) -> dict[str, str]:
    force = read("torque") * MM_PER_M / _base_radii(read)[0]
    return {"static_deflection": f"{force / stated_mean_stiffness(read)!r} mm"}


def _reduced_mass(read: Read) -> dict[str, object]:
    mass_3, mass_2 = (
        inertia * (MM_PER_M / radius) ** 2
        for inertia, radius in zip(read("inertia"), _base_radii(read), strict=True)
    )
    return {
        "reduced_mass": f"{1.0 / (1.0 / mass_3 + 1.0 / mass_2)!r} kg",
        "mass_ratio": mass_3 / mass_2,
    }


def _damping(read: Read) -> dict[str, str]:
    mass = read("reduced_mass") / KG_PER_N_S2_MM
    critical = 2.0 * math.sqrt(stated_mean_stiffness(read) * mass)
    return {"damping": f"{read('damping_ratio') * critical!r} N*s/mm"}


def _final_nu(read: Read) -> dict[str, float]:
    mass = read("reduced_mass") / KG_PER_N_S2_MM
    rate = 2.0 * math.pi / 60.0 * read("final_speed") * of_wheels(read("teeth"))[0]
    nu = rate * math.sqrt(mass / stated_mean_stiffness(read))
    try:
        return {"final_nu": read_nu(nu)}
    except ValueError as error:
        raise ValueError(f"final_speed: ν_s = {nu:.6g} is {error}") from None


_STORED: dict[str, Callable[[Read], dict[str, Any]]] = {
    "torque": _static_deflection,
    "inertia": _reduced_mass,
    "damping_ratio": _damping,
    "final_speed": _final_nu,
}


def _base_radii(read: Read) -> tuple[float, float]:
    """Return R_b3 and R_b2 in mm."""
    pitch = read("module") / 2.0 * math.cos(read("pressure_angle"))
    teeth_3, teeth_2 = of_wheels(read("teeth"))
    return pitch * teeth_3, pitch * teeth_2
