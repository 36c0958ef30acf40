"""How claims and numbers are put into words, for the notebooks and for the report."""

import math
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import jinja2

from gearmesh.claims import DEVIATES, NOT_TESTABLE, REPRODUCED, Bound, Claim, Entry

TEMPLATES = Path(__file__).parent / "templates"

STATUS_LABELS = {
    REPRODUCED: "✓ reproduced",
    DEVIATES: "≠ deviates",
    NOT_TESTABLE: "– not testable",
}
"""Status in words, with a sign, so that it does not hang on colour alone."""


def number(value: float, digits: int = 5) -> str:
    """Write a number with a true minus and powers of ten as an engineer reads them."""
    if not math.isfinite(value):
        return "–"
    text = f"{value:.{digits}g}"
    mantissa, exponent, power = text.partition("e")
    if exponent:
        text = f"{mantissa}·10{_superscript(int(power))}"
    return text.replace("-", "−")


def _superscript(power: int) -> str:
    return str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def found(value: Any) -> str:
    """Write what was measured: a number, a yes or no, several of them, or nothing."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, Mapping):
        return "; ".join(f"{name}: {found(item)}" for name, item in value.items()) or "–"
    if isinstance(value, list | tuple):
        return ", ".join(map(found, value)) or "–"
    return number(value) if isinstance(value, int | float) else str(value)


def expected(claim: Claim) -> str:
    """Write what the paper claims, with the tolerance."""
    parts = []
    for name, target, tolerance in claim.targets():
        text = _target(target, tolerance)
        parts.append(f"{name}: {text}" if name else text)
    return "; ".join(parts)


def _target(target: Any, tolerance: float | None) -> str:
    if isinstance(target, Bound):
        low, high = target.at_least, target.at_most
        if low is None:
            return f"≤ {number(high)}"
        return f"≥ {number(low)}" if high is None else f"{number(low)} to {number(high)}"
    if isinstance(target, bool):
        return found(target)
    return f"{number(target)} ± {number(tolerance)}" if tolerance else number(target)


@cache
def environment() -> jinja2.Environment:
    """Return the environment of the templates: everything is escaped, nothing may be missing."""
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters.update(number=number, found=found, expected=expected)
    made.globals["status_labels"] = STATUS_LABELS
    return made


def claims_table(entries: Iterable[Entry]) -> str:
    """Return the HTML table of claims that stands under a figure in its notebook."""
    return environment().get_template("claims.html.j2").render(entries=list(entries))
