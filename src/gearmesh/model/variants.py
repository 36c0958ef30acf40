"""Tab. 1: which powers of the velocity act in the damping, and where.

Damping acts through the material of the teeth while flanks touch (normal and inverse mesh) and
through the lubricant while they do not (contact loss), each with powers 1, 2 and 3 of the
relative velocity. Tab. 1 names eight combinations of powers by the letters a to h, and draws each
with a marker that shows where it acts.
"""

import difflib
import math
import re
from dataclasses import dataclass, replace

from gearmesh.errors import InputError

_POWERS = {
    "a": (False, False, False),
    "b": (True, False, False),
    "c": (False, True, False),
    "d": (False, False, True),
    "e": (True, True, False),
    "f": (True, False, True),
    "g": (True, True, True),
    "h": (False, True, True),
}
_NO_POWERS = _POWERS["a"]
_SYMBOLS = {"conservative": "○", "material": "□", "lubricant": "•", "both": "×"}
_WHERE = {"material": "material", "lubricant": "lubricant", "both": "material and lubricant"}


@dataclass(frozen=True, slots=True)
class Variant:
    """One column of Tab. 1.

    Attributes
    ----------
    letter : str
        ``"a"`` to ``"h"``: which powers of the velocity act.
    symbol : str
        ``"conservative"``, ``"material"``, ``"lubricant"`` or ``"both"``: where they act.
    factor : float
        Multiple of the printed damping (Figs. 6 and 7 use 5).
    """

    letter: str
    symbol: str
    factor: float = 1.0

    @property
    def name(self) -> str:
        """Name in files and on the command line, such as ``c-material-5x``."""
        multiple = "" if self.factor == 1.0 else f"-{self.factor:g}x"
        return f"{self.letter}-{self.symbol}{multiple}"

    @property
    def marker(self) -> str:
        """Marker of Tab. 1."""
        return _SYMBOLS[self.symbol]

    @property
    def material_powers(self) -> tuple[bool, bool, bool]:
        """Whether k1, k2, k3 act in normal and inverse mesh."""
        return _POWERS[self.letter] if self.symbol in ("material", "both") else _NO_POWERS

    @property
    def lubricant_powers(self) -> tuple[bool, bool, bool]:
        """Whether k1m, k2m, k3m act in contact loss."""
        return _POWERS[self.letter] if self.symbol in ("lubricant", "both") else _NO_POWERS

    @property
    def powers_label(self) -> str:
        """Powers as Tab. 1 writes them: L, Kv and Ku; empty for the conservative system."""
        acting = zip(("L", "Kv", "Ku"), _POWERS[self.letter], strict=True)
        return " + ".join(label for label, acts in acting if acts)

    @property
    def description(self) -> str:
        """Powers and place in words, such as ``L + Kv, lubricant``."""
        if self.symbol == "conservative":
            return "conservative in the mesh"
        multiple = "" if self.factor == 1.0 else f", {self.factor:g} times the damping"
        return f"{self.powers_label}, {_WHERE[self.symbol]}{multiple}"


def _table() -> dict[str, Variant]:
    columns = [Variant("a", "conservative")]
    columns += [Variant(letter, symbol) for letter in "bcdefgh" for symbol in _WHERE]
    return {column.name: column for column in columns}


_MULTIPLE = re.compile(r"(.+)-(\d+(?:\.\d+)?)x")

VARIANTS: dict[str, Variant] = _table()
"""The 22 columns of Tab. 1 by name, in its order."""


def variant(name: str) -> Variant:
    """Return the variant called `name`: one of Tab. 1, or a multiple such as ``c-material-5x``.

    Raises
    ------
    InputError
        If there is no such variant; the message suggests the nearest names.
    """
    base, multiple = name, None
    found = _MULTIPLE.fullmatch(name)
    if found:
        base, multiple = found.groups()
    if base not in VARIANTS:
        suffix = "" if multiple is None else f"-{multiple}x"
        suggested = " or ".join(repr(near + suffix) for near in _nearest(base))
        raise InputError(
            f"variant: unknown name {name!r}; did you mean {suggested}? "
            "(gearmesh variants lists all, and '-5x' behind a name multiplies its damping)"
        )
    if multiple is None:
        return VARIANTS[base]
    factor = float(multiple)
    if not 0.0 < factor < math.inf or base == "a-conservative":
        raise InputError(
            f"variant: no multiple {multiple!r} of the damping of {base!r} in {name!r}; "
            "allowed is a positive number, and a variant that has damping"
        )
    return replace(VARIANTS[base], factor=factor)


def _nearest(name: str) -> list[str]:
    """Return the names that `name` may stand for: by letter, by letter and marker, by spelling."""
    lowered = name.strip().lower()
    matching = [
        column.name
        for column in VARIANTS.values()
        if lowered == column.letter
        or re.fullmatch(rf"{column.letter}[-_ ]?{column.marker}", lowered)
    ]
    return matching or difflib.get_close_matches(lowered, VARIANTS, n=1, cutoff=0.0)
