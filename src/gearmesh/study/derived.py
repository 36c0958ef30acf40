"""What follows from the parameters of a pair: the properties of `Pair`, described."""

from typing import Any, NamedTuple

from gearmesh.study.pair import Pair


class Quantity(NamedTuple):
    """A number that follows from the parameters: a property of `Pair`, described."""

    name: str
    symbol: str
    unit: str
    formula: str

    def value(self, pair: Pair) -> Any:
        """Compute it, in `unit`."""
        return getattr(pair, self.name)


FOLLOWING = (
    Quantity("stiffness_min", "C_min", "N/mm", "κ C_max"),
    Quantity("stiffness_mean", "C_s", "N/mm", "C_max (κ + (1 − κ)(ε − 1)), eq. (5)"),
    Quantity("natural_frequency", "Ω_s", "rad/s", "√(C_s/m_red)"),
    Quantity("reduced_mass", "m_red", "kg", "1/(R_b3²/J_3 + R_b2²/J_2)"),
    Quantity("mass_ratio", "μ", "1", "(J_3/R_b3²)/(J_2/R_b2²)"),
    Quantity("inertia", "J", "kg*m^2", "(1 + μ) m_red R_b3² and (1 + 1/μ) m_red R_b2²"),
    Quantity("damping", "k", "N*s/mm", "2 D √(C_s m_red)"),
    Quantity("damping_ratio", "D", "1", "k/(2 √(C_s m_red))"),
    Quantity("resonance_speed", "n_1", "rpm", "speed of wheel 3 at ν_s = 1, 60 Ω_s/(2π Z_3)"),
    Quantity("final_nu", "ν_e", "1", "2π n_e Z_3/(60 Ω_s)"),
    Quantity("final_speed", "n_e", "rpm", "60 ν_e Ω_s/(2π Z_3)"),
    Quantity("nu_min_ratio", "ν_min/ν_s", "1", "√(C_s/C_min)"),
    Quantity("nu_max_ratio", "ν_max/ν_s", "1", "√(C_s/C_max)"),
    Quantity("static_deflection", "y_st", "mm", "M_3/(R_b3 C_s)"),
    Quantity("static_force", "F_st", "N", "C_s y_st"),
    Quantity("torque", "M_3", "N*m", "F_st R_b3"),
    Quantity("velocity_scale", "v_ref", "mm/s", "ℓ Ω_s"),
    Quantity("base_radius", "R_b", "mm", "m_n Z cos(α)/2"),
    Quantity("switch_phase", "(ε − 1)/2", "1", "phase at which C(t) falls to C_min"),
    Quantity("standard_contact_ratio", "ε(Z, α)", "1", "contact ratio of standard wheels"),
)
"""What may follow from the parameters, in the order of their use."""


def derived(pair: Pair) -> list[Quantity]:
    """Return what follows from the parameters that a pair states."""
    stated = {parameter.name for parameter in pair.parameters}
    if pair.final_nu is None:
        stated |= {"final_nu", "final_speed"}
    return [quantity for quantity in FOLLOWING if quantity.name not in stated]
