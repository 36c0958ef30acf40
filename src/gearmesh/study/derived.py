"""What follows from the parameters of a pair: the properties of `Pair`, described."""

from typing import NamedTuple

from gearmesh.study.pair import Pair


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
