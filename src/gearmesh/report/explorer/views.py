"""Views of the explorer: the guided tour, and the view that belongs to a figure or a claim.

A view is the hash of the explorer's address, such as ``variant=c-lubricant&nu=0.66``.
"""

from dataclasses import dataclass
from urllib.parse import urlencode


def view(variant: str, nu: float, **others: object) -> str:
    """Return the hash of a view: a variant, a frequency and changed parameters as shown."""
    return urlencode({"variant": variant, "nu": f"{nu:g}", **others})


@dataclass(frozen=True, slots=True)
class Stop:
    """A stop of the tour: what to look at, and what it shows."""

    title: str
    text: str
    view: str


_LUBRICANT, _MATERIAL = "c-lubricant", "c-material"

TOUR = (
    Stop(
        "Below the jump",
        "c-• at ν_s = 0.75. The teeth touch nearly all the time: y is negative for 3 % of it. In "
        "this variant only the oil damps, and it acts only while the teeth are apart. So hardly "
        "anything takes energy from the motion, the run rings on after its start, and its extrema "
        "form a cloud.",
        view(_LUBRICANT, 0.75),
    ),
    Stop(
        "Above the jump",
        "c-• at ν_s = 0.79. The teeth part in every period, for half of the time (yellow). The "
        "oil damps in every period, so the motion settles on one orbit, and that orbit is larger. "
        "Drag ν_s to and fro across the jump at 0.77.",
        view(_LUBRICANT, 0.79),
    ),
    Stop(
        "Two motions below the jump",
        "c-• at ν_s = 0.75 again, with the same parameters, but this run starts with the teeth "
        "apart (y_0 = −1). It ends on the large orbit: two motions exist here side by side, and "
        "the start decides between them. The dots are runs with this start. They are on the large "
        "orbit as soon as it exists, from its fold at ν_s = 0.706 on.",
        view(_LUBRICANT, 0.75, initial_displacement=-1),
    ),
    Stop(
        "The start moves the jump",
        "Another starting phase, 0 in place of 0.2845, moves the jump from 0.77 to 0.745. The "
        "motion in contact grows towards the resonance with C_min (ν_s = 0.8455). It parts the "
        "teeth at 0.791, and ends at a fold at 0.805 at the latest: every run beyond it is on the "
        "large orbit. Most starts jump earlier.",
        view(_LUBRICANT, 0.75, initial_phase=0),
    ),
    Stop(
        "Damping in contact removes it",
        "c-□ at ν_s = 0.79, with the dots of c-• in pale. The material damps while the teeth "
        "touch. The start is forgotten, the orbit stays small, and the curve has no jump.",
        view(_MATERIAL, 0.79, beside=_LUBRICANT),
    ),
)
"""Why c-• jumps near 0.8, in five views."""

FIGURES = {
    "fig2": view(_LUBRICANT, 0.79, beside=_MATERIAL),
    "fig3": view(_LUBRICANT, 1.1),
    "fig4": view(_LUBRICANT, 1.05, periods=21),
    "fig5": view(_MATERIAL, 0.61),
    "fig6": view(_MATERIAL, 0.61, damping=19.7685),
    "fig7": view(_MATERIAL, 0.61, periods=2),
    "branches": view(_LUBRICANT, 0.75),
    "basins": view(_LUBRICANT, 0.75, initial_displacement=-1),
    "sweeps": view(_LUBRICANT, 0.79),
    "special_curves": view(_MATERIAL, 0.6386),
    "lyapunov": view("a-conservative", 0.7),
    "design_map": view("b-material", 0.81),
}
"""The view of each figure."""

CLAIMS = {
    "P8": view(_LUBRICANT, 0.66),
    "P9": view(_MATERIAL, 0.8, contact_ratio=2),
    "F2.1": view("d-material", 0.8, beside="h-both"),
    "F2.2": view(_MATERIAL, 0.9, beside="c-both"),
    "F2.3": view(_LUBRICANT, 0.775),
    "F2.4": view(_LUBRICANT, 0.75, beside="d-lubricant"),
    "F2.5": view("d-lubricant", 0.82, beside=_LUBRICANT),
    "F2.6": view("h-lubricant", 0.8),
    "F2.7": view("b-material", 0.8),
    "F3.1": view(_LUBRICANT, 1.12),
    "F3.2": view(_MATERIAL, 0.63),
    "F3.3": view("h-lubricant", 0.79),
    "F3.4": view(_LUBRICANT, 0.72),
    "F3.4b": view(_LUBRICANT, 0.62),
    "F3.5": view(_LUBRICANT, 0.66),
    "F3.6": view("h-lubricant", 0.95),
    "F4.1": view(_LUBRICANT, 0.6, periods=21),
    "F4.2": view(_LUBRICANT, 1.05),
    "F4.3": view(_LUBRICANT, 1.2, periods=21),
    "F5.1": view(_MATERIAL, 0.66),
    "F5.2": view(_MATERIAL, 0.64),
    "F6.1": view("c-material-5x", 0.61, beside=_MATERIAL),
    "F6.2": view(_MATERIAL, 0.64, beside="c-material-5x"),
    "F6.3": view("c-material-5x", 0.64),
    "F7.1": view(_MATERIAL, 0.61, periods=2, friction_coefficient=0.1),
    "F7.2": view(_MATERIAL, 0.62, periods=2),
    "F7.3": view("c-material-5x", 0.61, periods=2),
    "F7.4": view("c-material-5x", 0.62, periods=2),
}
"""The view of each claim that a run shows."""
