"""The report: one page that opens from disk.

Nothing on it comes from a network: styles are within it, equations are MathML, figures and the
pages of the notebooks are linked by relative paths. `render` makes the page from what it is given;
`write_report` reads the results of a run and writes it.
"""

import os
import platform
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from gearmesh.data import paths, provenance
from gearmesh.data.casefile import STATUSES
from gearmesh.data.datasets import open_dataset
from gearmesh.data.writing import write_text
from gearmesh.identification import layout, table
from gearmesh.identification.settings import load_settings
from gearmesh.report.identified import section
from gearmesh.report.presentation import environment, number
from gearmesh.reproduction.claims import Entry, load_ledger, read_entries, verdict
from gearmesh.reproduction.equations import EQUATIONS
from gearmesh.study.cases import Study
from gearmesh.study.pair import DERIVED

CAPTIONS = Path("workflow/report")
"""Where the captions stand: plain text, one file a figure."""


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure on the page; places are relative to it."""

    name: str
    title: str
    caption: str
    svg: str
    png: str
    notebook: str | None
    entries: tuple[Entry, ...]


@dataclass(frozen=True, slots=True)
class Parameter:
    """A row of the tables of parameters."""

    name: str
    symbol: str
    description: str
    value: str
    kind: str = ""
    reason: str = ""


def write_report(study: Study) -> None:
    """Write `results/report/index.html` from the results of a run.

    Parameters
    ----------
    study : Study
        The study that was run.

    Raises
    ------
    InputError
        If a result is missing or damaged.
    """
    captions = {
        name: (CAPTIONS / f"{name}.rst").read_text(encoding="utf-8") for name in paths.FIGURE_NAMES
    }
    resonance = open_dataset(paths.RESONANCE)
    page = render(study, read_entries(paths.LEDGER), resonance, captions, _identified(study))
    write_text(paths.REPORT, page)


def _identified(study: Study) -> str:
    """Return as HTML what the claims tell about the open parameters."""
    return section(
        table.read(),
        load_ledger(paths.CLAIMS),
        load_settings(layout.SETTINGS),
        study.pair,
        {name: _relative(path) for name, path in layout.REPORTED.items()},
    )


def render(
    study: Study,
    entries: Sequence[Entry],
    resonance: xr.Dataset,
    captions: dict[str, str],
    identified: str = "",
) -> str:
    """Return the page.

    Parameters
    ----------
    study : Study
        Parameters, their reasons, and the plan of cases.
    entries : sequence of Entry
        The ledger with what was found.
    resonance : xarray.Dataset
        Status and sensitivity of every case.
    captions : dict of str to str
        Caption of each figure.
    identified : str
        HTML of what the claims tell about the open parameters.
    """
    return (
        environment()
        .get_template("report.html.j2")
        .render(
            study=study,
            counts=verdict(entries),
            entries=entries,
            figures=[_figure(name, caption, entries) for name, caption in captions.items()],
            notebook_of=_notebook_of,
            equations=EQUATIONS,
            stated=list(_given(study)),
            derived=list(_following(study)),
            identified=identified,
            computation=list(_computation(study, resonance)),
            sensitivity=list(_sensitivity(resonance)),
        )
    )


def _relative(target: Path) -> str:
    return Path(os.path.relpath(target, paths.REPORT.parent)).as_posix()


def _notebook_of(figure: str) -> str | None:
    """Return the page of the notebook that checks the claims of `figure`, from the report."""
    known = figure in paths.NOTEBOOK_NAMES
    return _relative(paths.notebook_page(figure)) if known else None


def _figure(name: str, caption: str, entries: Iterable[Entry]) -> Figure:
    png, svg = paths.figure_files(name)
    return Figure(
        name=name,
        title=f"Fig. {name.removeprefix('fig')}",
        caption=" ".join(caption.split()),
        svg=_relative(svg),
        png=_relative(png),
        notebook=_notebook_of(name),
        entries=tuple(entry for entry in entries if entry.figure == name),
    )


def _given(study: Study) -> Iterable[Parameter]:
    """Yield the rows of the parameters that the study states, or leaves at their defaults."""
    for row in study.pair.parameters:
        if row.value is not None:
            value = _quantity(row.value, row.unit)
            yield Parameter(row.name, row.symbol, row.description, value, row.kind, row.reason)


def _following(study: Study) -> Iterable[Parameter]:
    """Yield the rows of the parameters that follow from the given ones."""
    for quantity in DERIVED:
        value = _quantity(quantity.value(study.pair), quantity.unit)
        yield Parameter(quantity.name, quantity.symbol, quantity.formula, value)


def _quantity(value: object, unit: str) -> str:
    if isinstance(value, tuple) and value and not isinstance(value[0], tuple):
        return ", ".join(_quantity(item, unit) for item in dict.fromkeys(value))
    if isinstance(value, tuple):
        harmonics = (f"({number(c)}, {number(s)})" for c, s in value)
        return f"{', '.join(harmonics)} {unit}" if value else "none"
    if unit == "rad":
        return f"{number(float(np.degrees(value)))}°"
    return number(value) + ("" if unit == "1" else f" {unit.replace('*', ' ')}")


def _computation(study: Study, resonance: xr.Dataset) -> Iterable[tuple[str, str]]:
    """Yield what was run, and with what."""
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


def _sensitivity(resonance: xr.Dataset) -> Iterable[tuple[str, int, int, float]]:
    """Yield variants with sensitive cases, how many, of how many, and the others' worst error."""
    for name in resonance["variant"].values:
        course = resonance.sel(variant=name)
        computed = course["status"].values == 0
        sensitive = computed & (course["sensitive"].values == 1)
        if sensitive.any():
            rest = course["y_max_error_rel"].values[computed & ~sensitive]
            worst = float(rest.max()) if rest.size else float("nan")
            yield str(name), int(sensitive.sum()), int(computed.sum()), worst
