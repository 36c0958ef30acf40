"""What a study is and how it was computed, as rows of text for the reports."""

import platform
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import xarray as xr

from gearmesh.data import provenance
from gearmesh.report.presentation import number
from gearmesh.solvers.response import STATUSES
from gearmesh.study.cases import Study
from gearmesh.study.derived import derived as following


@dataclass(frozen=True, slots=True)
class Parameter:
    """A row of the tables of parameters."""

    name: str
    symbol: str
    description: str
    value: str
    kind: str = ""
    reason: str = ""


def parameters(study: Study) -> Iterable[Parameter]:
    """Yield the rows of the parameters that the study states, or leaves at their defaults."""
    for row in study.pair.parameters:
        if row.value is not None:
            value = _quantity(row.value, row.unit)
            yield Parameter(row.name, row.symbol, row.description, value, row.kind, row.reason)


def derived(study: Study) -> Iterable[Parameter]:
    """Yield the rows of the parameters that follow from the given ones."""
    for quantity in following(study.pair):
        value = _quantity(quantity.value(study.pair), quantity.unit)
        yield Parameter(quantity.name, quantity.symbol, quantity.formula, value)


def _quantity(value: float | tuple[float, ...] | tuple[tuple[float, float], ...], unit: str) -> str:
    if isinstance(value, tuple):
        harmonics = [f"({number(c[0])}, {number(c[1])})" for c in value if isinstance(c, tuple)]
        if harmonics:
            return f"{', '.join(harmonics)} {unit}"
        numbers = dict.fromkeys(item for item in value if not isinstance(item, tuple))
        return ", ".join(_quantity(item, unit) for item in numbers) or "none"
    if unit == "rad":
        return f"{number(float(np.degrees(value)))}°"
    return number(value) + ("" if unit == "1" else f" {unit.replace('*', ' ')}")


def computation(study: Study, resonance: xr.Dataset) -> Iterable[tuple[str, str]]:
    """Yield rows on the cases, the solver and the versions of the software."""
    pair, cases, nu = study.pair, study.cases, study.nu
    periods = pair.revolutions * pair.teeth
    kept = pair.kept_revolutions * pair.teeth
    yield "Cases", f"{len(cases)}, of which {sum(c.time_course for c in cases)} with time courses"
    yield "Status", _statuses(resonance)
    yield "Mesh frequency", f"{len(nu)} values of ν_s from {number(nu[0])} to {number(nu[-1])}"
    yield "Length", f"{periods} mesh periods from static equilibrium; the last {kept} are kept"
    yield "Method", "Taylor series of adaptive step; switches, contacts and extrema are located"
    yield "Tolerance", f"{number(pair.tolerance)} in a step, relative to y_st and y_st Ω_s"
    versions = {"Python": platform.python_version(), **provenance.versions()}
    yield "Versions", ", ".join(f"{name} {version}" for name, version in versions.items())
    yield "Parameters", f"SHA-256 {study.pair.digest()}"
    yield "Physics sources", f"SHA-256 {provenance.physics_digest()}"


def _statuses(resonance: xr.Dataset) -> str:
    counts = Counter(int(flag) for flag in resonance["status"].values.flat)
    named = [f"{counts[flag]} {name}" for flag, name in enumerate(STATUSES) if counts[flag]]
    return ", ".join(named).replace("_", " ")
