"""The parameters that the explorer can change, and how its sliders show them."""

import math
from dataclasses import dataclass
from typing import Any

from gearmesh.report.presentation import unit_text
from gearmesh.study.pair import Pair
from gearmesh.study.reading.schema import of_wheels


@dataclass(frozen=True, slots=True)
class Control:
    """A slider with a field for numbers.

    Attributes
    ----------
    name : str
        The parameter.
    low, high, step : float
        Of the slider, in the unit that is shown.
    scale : str
        Parameter that is the unit, ``static_deflection`` or ``reduced_mass``; empty for the
        library's own unit.
    logarithmic : bool
        Whether the slider is logarithmic; `step` is then one of the decimal logarithm.
    most : float
        Greatest number that the field takes; the study may state a greater one.
    """

    name: str
    low: float
    high: float
    step: float
    scale: str = ""
    logarithmic: bool = False
    most: float = math.inf


_LENGTH = "static_deflection"

CONTROLS = (
    Control("damping", 0.0, 40.0, 0.05),
    Control("backlash", 0.5, 20.0, 0.1, _LENGTH),
    Control("damping_length", 0.05, 5.0, 0.01, _LENGTH, logarithmic=True),
    Control("initial_phase", 0.0, 1.0, 0.005),
    Control("initial_displacement", -4.0, 4.0, 0.05, _LENGTH),
    Control("initial_velocity", -3.0, 3.0, 0.05, _LENGTH),
    Control("contact_ratio", 1.0, 2.0, 0.005),
    Control("stiffness_ratio", 0.3, 1.0, 0.005),
    Control("friction_coefficient", 0.0, 0.3, 0.005),
    Control("body_mass", 1.0, 1e4, 0.02, "reduced_mass", logarithmic=True),
    Control("bearing_stiffness", 1e4, 1e8, 0.02, logarithmic=True),
    Control("bearing_damping_ratio", 0.0, 0.5, 0.005),
    Control("revolutions", 1, 40, 1, most=400),  # 400 take some 0.6 s, and the page waits
)
"""In the order of the page."""

_SYMBOLS = {"static_deflection": "y_st", "reduced_mass": "m_red"}


@dataclass(frozen=True, slots=True)
class Shown:
    """A control with all that the page writes beside it; numbers are in the unit that is shown."""

    control: Control
    symbol: str
    description: str
    unit: str
    factor: float
    value: float
    least: float
    greatest: float


def of_one_wheel(pair: Pair) -> dict[str, Any]:
    """Return all parameters; where the wheels differ, those of wheel 3.

    The solver of the page has equal wheels. It says so to a study that has others.
    """
    values = pair.model_dump(mode="json")
    both = [
        name
        for name, stated in Pair.declarations().items()
        if stated["of_wheels"] or stated["may_differ"]
    ]
    return {**values, **{name: of_wheels(getattr(pair, name))[0] for name in both}}


def shown(pair: Pair) -> list[Shown]:
    """Return the controls for the parameters of a pair."""
    declared = Pair.declarations()
    found = []
    for control in CONTROLS:
        stated, factor = declared[control.name], 1.0
        unit = "" if stated["unit"] == "1" else unit_text(stated["unit"])
        if control.scale:
            factor, unit = float(getattr(pair, control.scale)), _SYMBOLS[control.scale]
        value = of_wheels(getattr(pair, control.name))[0]
        # Only the initial displacement may be open: static equilibrium, which is y_st.
        value = factor if value is None else value
        least, greatest = (float(stated[end]) / factor for end in ("low", "high"))
        greatest = min(greatest, max(control.most, value / factor))
        found.append(
            Shown(
                *(control, stated["symbol"], stated["description"], unit),
                *(factor, float(f"{value / factor:.12g}"), least, greatest),
            )
        )
    return found
