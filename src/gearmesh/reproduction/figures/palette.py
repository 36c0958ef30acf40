"""Colours and markers: the regions of the mesh and the response curves of Tab. 1.

Colour-blind readers can distinguish blue and vermilion, and the paper's symbols can be
distinguished in print without colour. The regions have the paper's colours white, yellow and red.
They are pale, because curves are drawn over them, and differ in lightness.
"""

from dataclasses import dataclass

NORMAL_MESH = "#ffffff"
CONTACT_LOSS = "#fff1b0"
INVERSE_MESH = "#f5bcb0"
"""Bands of the regions: y >= 0, -s < y < 0 and y <= -s."""

INK = "#1a1a1a"
GREY = "#6b6b6b"
PALE = "#b5b5b5"
BLUE = "#005b96"
RED = "#d5501a"
GREEN = "#2e7d5b"
VIOLET = "#9a5fc0"
"""The two colours of damping differ in lightness too, for print in grey. Green is for orbits of
twice the mesh period, violet for those of three mesh periods and more."""


@dataclass(frozen=True, slots=True)
class Look:
    """Style of the response curves with damping in one place.

    Attributes
    ----------
    symbol : str
        The paper's symbol, as text.
    meaning : str
        Where the damping acts.
    marker : str
        Matplotlib's marker of the same shape.
    colour : str
        Its colour.
    open : bool
        Whether the marker is drawn as an outline.
    size : float
        Size of the marker in points.
    """

    symbol: str
    meaning: str
    marker: str
    colour: str
    open: bool
    size: float


LOOKS = {
    "conservative": Look("○", "no damping in the mesh", "o", GREY, True, 2.6),
    "material": Look("□", "material damping", "s", BLUE, True, 4.2),
    "both": Look("×", "material and lubricant damping", "x", INK, True, 3.8),
    "lubricant": Look("•", "lubricant damping", "o", RED, False, 1.9),
}
"""Styles by the second word of the variant's name (``c-lubricant``)."""
