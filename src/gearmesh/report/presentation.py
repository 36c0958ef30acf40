"""Claims and numbers as text, for the notebooks and the report."""

import math
import re
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup, escape

from gearmesh.reproduction.claims import DEVIATES, NOT_TESTABLE, REPRODUCED, Bound, Claim, Entry
from gearmesh.reproduction.figures.palette import LOOKS

TEMPLATES = Path(__file__).parent / "templates"

STATUS_LABELS = {
    REPRODUCED: "✓ reproduced",
    DEVIATES: "≠ deviates",
    NOT_TESTABLE: "– not testable",
}
"""Status in words with a sign, so that it can be read without colour."""


_VARIANT = re.compile(r"\b([a-h])-(conservative|material|lubricant|both)(?:-([\d.]+)x)?\b")


def number(value: float | None, digits: int = 6) -> str:
    """Write a number with a true minus, powers of ten, and a space in long whole numbers."""
    if value is None or not math.isfinite(value):
        return "–"
    if 1e4 <= abs(value) < 1e9:
        return f"{value:,.0f}".replace(",", "\u202f").replace("-", "−")
    mantissa, exponent, power = f"{value:.{digits}g}".partition("e")
    if 0 < abs(value) < 1e-3:
        mantissa, exponent, power = f"{value:.{digits - 1}e}".partition("e")
        mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
    if exponent and 1.0 <= abs(value) < 1e4:
        mantissa = f"{float(f'{value:.{digits}g}'):.0f}"
    elif exponent:
        mantissa += f"·10{str(int(power)).translate(_RAISED)}"
    return mantissa.replace("-", "−")


_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def found(value: Any) -> list[str]:
    """Write what was measured, in lines: one for each quantity.

    Numbers get four decimals: a threshold is located to half of the last one. Values of several
    variants stand in one line.
    """
    if isinstance(value, Mapping) and value:
        if all(map(_VARIANT.fullmatch, value)):
            return [_line(value)]
        return [f"{_quantity_name(name)}: {_line(item)}" for name, item in value.items()]
    return [_line(value)]


def _line(value: Any) -> str:
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, Mapping):
        return ", ".join(_named(name, _line(item)) for name, item in value.items()) or "–"
    if isinstance(value, list | tuple):
        return ", ".join(map(_line, value)) or "–"
    if isinstance(value, int | float):
        return number(round(value, 4)) if abs(value) >= 1e-3 else number(value, 3)
    return str(value)


def _named(name: str, text: str) -> str:
    return f"{name}\u00a0{text}" if _VARIANT.fullmatch(name) else f"{text}\u00a0({name})"


def _quantity_name(name: str) -> str:
    return name.replace("nu_", "ν_")


def expected(claim: Claim) -> list[str]:
    """Write what the paper claims, with the tolerance, in lines: one for each quantity."""
    return [
        f"{_quantity_name(name)}: {_target(target, tolerance)}"
        if name
        else _target(target, tolerance)
        for name, target, tolerance in claim.targets()
    ]


def _target(target: Any, tolerance: float | None) -> str:
    if isinstance(target, Bound):
        low, high = target.at_least, target.at_most
        if low is not None and high is not None:
            return f"{number(low)} to {number(high)}"
        return f"≥ {number(low)}" if low is not None else f"≤ {number(high)}"
    return f"{number(target)} ± {number(tolerance)}" if tolerance else number(target)


def typeset(text: str) -> Markup:
    """Write symbols as the paper does: ν_s with a subscript, c-material as c-□."""
    text = _VARIANT.sub(_symbol, str(escape(text)))
    return Markup(re.sub(r"(?<=[\w;])_([A-Za-z0-9α-ω]+)", r"<sub>\1</sub>", text))


def _symbol(match: re.Match[str]) -> str:
    letter, where, factor = match.groups()
    multiple = f"\u00a0({factor}k)" if factor else ""
    return f'<span style="white-space: nowrap">{letter}-{LOOKS[where].symbol}{multiple}</span>'


def quantity(value: Any, unit: str) -> str:
    """Write the value of a parameter with its unit; values of two equal wheels are written once."""
    if isinstance(value, bool) or not isinstance(value, int | float | tuple):
        return _line(value)
    if isinstance(value, tuple):
        if any(isinstance(item, tuple) for item in value):
            rows = (f"({', '.join(quantity(part, '1') for part in item)})" for item in value)
            return ", ".join(rows) + ("" if unit == "1" else f" {unit}")
        shown = value[:1] if len(set(value)) == 1 else value
        return ", ".join(quantity(item, unit) for item in shown) or "none"
    if unit == "rad":
        return f"{number(math.degrees(value))}°"
    return number(value) + ("" if unit == "1" else f" {unit_text(unit)}")


def unit_text(unit: str) -> str:
    """Write a unit with spaces for products and raised powers: kg*m^2 as kg m²."""
    raised = re.sub(r"\^(-?\d+)", lambda power: power[1].translate(_RAISED), unit)
    return raised.replace("*", " ")


@cache
def environment() -> jinja2.Environment:
    """Return the environment of the templates: it escapes all values and refuses missing ones."""
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters.update(number=number, found=found, expected=expected, typeset=typeset)
    made.filters.update(quantity=quantity, log10=math.log10)
    made.globals["status_labels"] = STATUS_LABELS
    return made


def claims_table(entries: Iterable[Entry]) -> str:
    """Return the HTML table of claims that stands under a figure in its notebook."""
    return environment().get_template("claims.html.j2").render(entries=list(entries))
