"""The open parameters: what they are called, in what scale they are given, how they are drawn."""

from typing import NamedTuple

from gearmesh.study.pair import Pair

KINDS = ("separate", "up", "down")
"""Kinds of run: from rest at each ν_s, or from the end of the run at the next lower or higher ν_s.
"""


class Factor(NamedTuple):
    """An open parameter of the model or of its runs.

    Attributes
    ----------
    symbol : str
        Its symbol as text, divided by its scale.
    label : str
        The same for matplotlib.
    scale : str
        What its values are relative to: ``y_st``, ``m_red``, ``C_s``, or ``1``.
    ticks : tuple of float
        Ticks of its axis in figures.
    periodic : bool
        Whether the two ends of its range are neighbours.
    """

    symbol: str
    label: str
    scale: str = "1"
    ticks: tuple[float, ...] = ()
    periodic: bool = False


FACTORS = {
    "backlash": Factor("s/y_st", "$s/y_{st}$", "y_st", (2, 4, 8, 15)),
    "damping_length": Factor("ℓ/y_st", "$\\ell/y_{st}$", "y_st", (0.1, 0.25, 0.5, 1, 2)),
    "body_mass": Factor("m/m_red", "$m/m_{red}$", "m_red", (1, 10, 100, 1000)),
    "bearing_stiffness": Factor("c_b/C_s", "$c_b/C_s$", "C_s", (0.1, 1, 10, 100)),
    "bearing_damping_ratio": Factor("ζ_b", "$\\zeta_b$", ticks=(0.005, 0.01, 0.03, 0.1)),
    "friction_coefficient": Factor("f_T", "$f_T$", ticks=(0, 0.05, 0.1)),
    "initial_phase": Factor("p_0", "$p_0$", ticks=(0, 0.25, 0.5, 0.75, 1), periodic=True),
    "initial_velocity": Factor("y'(0)/(y_st Ω_s)", "$y$′(0)", "y_st", (-1, 0, 1)),
    "kind": Factor("kind of run", "run", periodic=True),
    "eccentricity_3": Factor("e_3/y_st", "$e_3/y_{st}$", "y_st"),
    "eccentricity_2": Factor("e_2/y_st", "$e_2/y_{st}$", "y_st"),
    "eccentricity_angle": Factor("Δ", "$\\Delta$", periodic=True),
}
"""All open parameters, in the order in which files store them."""

OF_THE_PAIR = tuple(name for name in FACTORS if name not in ("initial_velocity", "kind"))
"""Factors that are parameters of a pair. The other two belong to the runs of a response curve."""


def scales(pair: Pair) -> dict[str, float]:
    """Return the size of each scale, in the units of a pair."""
    return {
        "y_st": pair.static_deflection,
        "m_red": pair.reduced_mass,
        "C_s": pair.stiffness_mean,
        "1": 1.0,
    }
