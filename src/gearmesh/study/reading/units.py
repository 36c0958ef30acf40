"""Quantities with units: text in, a float in a stated unit out.

Only the plain form "number unit" is read (``"40 um"``, ``"3.123e-3 N s^2/mm"``), so that a
configuration is data: nothing in it is evaluated.
"""

import math
import re
from functools import cache
from numbers import Real
from typing import TYPE_CHECKING, Any, SupportsFloat

if TYPE_CHECKING:
    import pint

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_POWER = r"(?:\s*(?:\^|\*\*)\s*[+-]?\d|[²³])?"
_FACTOR = rf"[A-Za-zµμ°%]+{_POWER}"
_FACTORS = rf"{_FACTOR}(?:(?:\s*[*/·]\s*|\s+){_FACTOR})*"
_UNIT = rf"{_FACTORS}(?:\s*/\s*\(\s*{_FACTORS}\s*\))?"
_QUANTITY = re.compile(rf"\s*(?P<number>{_NUMBER})\s*(?P<unit>{_UNIT})?\s*")
_MULTIPLE = re.compile(rf"\s*(?P<number>{_NUMBER})\s*(?P<scale>[A-Za-z]+_[A-Za-z]+)\s*")
_DECIMAL_COMMA = re.compile(r"[0-9],[0-9]")
_LONGEST = 80  # characters: no quantity needs more, and the patterns above stay fast

SCALES = {"y_st": "mm", "m_red": "kg", "C_s": "N/mm"}
"""Scales of which a quantity may be a multiple, as in ``"8 y_st"``, and their units."""

_NAMES = {
    "1": "a plain number",
    "rad": "an angle",
    "mm": "a length",
    "kg": "a mass",
    "N": "a force",
    "N/mm": "a stiffness",
    "N*s/mm": "a damping coefficient",
    "N*m": "a torque",
    "kg*m^2": "an inertia",
}

COMMON = {
    ("deg", "rad"): 0.017453292519943295,
    ("um", "mm"): 0.001,
    ("N s/mm", "N*s/mm"): 1.0,
    ("N s^2/mm", "kg"): 1000.0,
}
"""Factors between units that most studies state: pint takes as long to load as all else."""


@cache
def registry() -> "pint.UnitRegistry[float]":
    """Return the only registry of units; it is built on first use, because that takes a moment."""
    import pint

    return pint.UnitRegistry()


def parse(value: object, unit: str) -> float:
    """Read a quantity and give it in `unit`.

    Parameters
    ----------
    value : str, int or float
        ``"40 um"``, or a bare number where `unit` is ``"1"``.
    unit : str
        Unit of the result; ``"1"`` for a plain number.

    Returns
    -------
    float
        Value in `unit`, rounded to 15 digits: ``"10 um"`` and ``"0.01 mm"`` are one number.

    Raises
    ------
    ValueError
        If the text is no quantity, not finite, has no unit or one of another dimension; the message
        names what is expected.
    """
    if isinstance(value, bool) or not isinstance(value, str | Real):
        raise ValueError(f"not a quantity; expected: {wanted(unit)}")
    if isinstance(value, str):
        number, given = _split(value, unit)
    else:
        number, given = _finite(value, unit), None
    if given is None and unit != "1":
        raise ValueError(f"unit missing; expected: {wanted(unit)}")
    if given == "%" and unit == "1":
        number /= 100.0
    elif given is not None:
        number = _convert(number, given, unit)
    return float(f"{number:.15g}") + 0.0  # no negative zero


def scaled(value: object, scale: str, size: float, unit: str) -> object:
    """Replace multiples of a scale, such as ``"8 y_st"``, by quantities in `unit`.

    Parameters
    ----------
    value : object
        A text, a (nested) list of texts, or anything else, which is returned as it is.
    scale : str
        Name of the scale.
    size : float
        Its size in `unit`.
    """
    if isinstance(value, list | tuple):
        return [scaled(item, scale, size, unit) for item in value]
    match = _multiple(value)
    if match is None or match["scale"] != scale:
        return value
    return f"{float(match['number']) * size!r} {unit}"


def is_multiple(value: object, scale: str) -> bool:
    """Return whether a text, or one within a (nested) list, is a multiple of a scale."""
    if isinstance(value, list | tuple):
        return any(is_multiple(item, scale) for item in value)
    match = _multiple(value)
    return match is not None and match["scale"] == scale


def _multiple(value: object) -> re.Match[str] | None:
    if not isinstance(value, str) or len(value) > _LONGEST:
        return None
    return _MULTIPLE.fullmatch(value)


def wanted(unit: str) -> str:
    """Describe in words the quantities that `unit` measures, with an example."""
    name = _NAMES.get(unit, "a quantity")
    return name if unit == "1" else f"{name} with its unit, such as '1 {unit}'"


def _split(text: str, unit: str) -> tuple[float, str | None]:
    """Take a text apart into its number and its unit (None if there is none)."""
    if multiple := _multiple(text):
        scale = multiple["scale"]
        known = f"no scale '{scale}', only {', '.join(SCALES)}"
        problem = f"'{scale}' is not allowed here" if scale in SCALES else known
        raise ValueError(f"{problem}; expected: {wanted(unit)}")
    match = _QUANTITY.fullmatch(text) if len(text) <= _LONGEST else None
    if match is None:
        comma = len(text) <= _LONGEST and _DECIMAL_COMMA.search(text)
        hint = "use a decimal point; " if comma else ""
        raise ValueError(f"not a quantity; {hint}expected: {wanted(unit)}")
    return _finite(float(match["number"]), unit), match["unit"]


def _finite(number: SupportsFloat, unit: str) -> float:
    try:
        found = float(number)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found):
        raise ValueError(f"not finite; expected: {wanted(unit)}")
    return found


def _convert(number: float, given: str, unit: str) -> float:
    """Convert between units of the same kind (an angle is no plain number)."""
    if unit == "1":
        raise ValueError(f"unit '{given}' where none belongs; expected: {wanted(unit)}")
    factor = 1.0 if given == unit else COMMON.get((given, unit))
    if factor is None:
        factor = factor_of(given, unit)
    return _finite(number * factor, unit)


def factor_of(given: str, unit: str) -> float:
    """Return the factor between two units, as pint has it."""
    import pint

    units = registry()
    try:
        source = units.parse_units(given.replace("°", "deg").replace("·", "*"))
        target = units.parse_units(unit)
        factor: Any
        factor, root = units.get_base_units(source)
        target_factor, target_root = units.get_base_units(target)
    except pint.UndefinedUnitError:
        raise ValueError(f"unknown unit '{given}'; expected: {wanted(unit)}") from None
    except (pint.PintError, ArithmeticError, ValueError, TypeError, AttributeError):
        raise ValueError(f"unit '{given}' cannot be read; expected: {wanted(unit)}") from None
    if root != target_root:
        raise ValueError(f"unit '{given}' is of another kind; expected: {wanted(unit)}")
    return float(factor / target_factor)
