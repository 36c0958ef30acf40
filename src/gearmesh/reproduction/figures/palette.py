"""Colours and markers, once: the regions of the mesh and the courses of Tab. 1.

The courses take a blue and a vermilion that stay apart for colour-blind readers, grey and
black, and the paper's symbols, which stay apart in print without colour. The region colours
are the paper's white, yellow and red, pale enough to lie behind a course and unequal in
lightness.
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
"""The two colours of damping differ in lightness too, for print in grey."""


@dataclass(frozen=True, slots=True)
class Course:
    """Look of one course of Tab. 1.

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


COURSES = {
    "conservative": Course("○", "no damping in the mesh", "o", GREY, True, 2.6),
    "material": Course("□", "material damping", "s", BLUE, True, 4.2),
    "both": Course("×", "material and lubricant damping", "x", INK, True, 3.8),
    "lubricant": Course("•", "lubricant damping", "o", RED, False, 1.9),
}
"""Courses by the second word of the variant's name (``c-lubricant``)."""
