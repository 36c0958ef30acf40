"""The report: one page that opens from disk.

It needs no network: styles are within it, equations are MathML, figures and the pages of the
notebooks are linked by relative paths. `render` makes the page from its arguments; `write_report`
reads the results of a run and writes it.
"""

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from gearmesh.data import paths
from gearmesh.data.datasets import open_dataset
from gearmesh.data.paths import Places
from gearmesh.data.writing import write_text
from gearmesh.identification import layout, table
from gearmesh.identification.settings import load_settings
from gearmesh.report import description, verification
from gearmesh.report.identified import section
from gearmesh.report.presentation import environment
from gearmesh.reproduction.claims import Entry, load_ledger, read_entries, verdict
from gearmesh.reproduction.equations import EQUATIONS
from gearmesh.study.cases import Study


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


def write_report(study: Study, places: Places) -> None:
    """Write the report page from the results of a run.

    Parameters
    ----------
    study : Study
        The study that was run.
    places : Places
        Where its results are.

    Raises
    ------
    InputError
        If a result is missing or damaged.
    """
    captions = {
        name: (paths.CAPTIONS / f"{name}.rst").read_text(encoding="utf-8")
        for name in paths.FIGURE_NAMES
    }
    resonance = open_dataset(places.resonance)
    page = render(
        *(study, read_entries(places.ledger), resonance, captions),
        *(_identified(study), verification.section(places)),
    )
    write_text(places.report, page)


def _identified(study: Study) -> str:
    """Return the findings about the open parameters as HTML."""
    return section(
        table.read(),
        load_ledger(paths.CLAIMS),
        load_settings(layout.SETTINGS),
        study.pair,
        {name: path.name for name, path in layout.reported(Places(study.name)).items()},
    )


def render(
    study: Study,
    entries: Sequence[Entry],
    resonance: xr.Dataset,
    captions: dict[str, str],
    identified: str = "",
    verified: str = "",
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
        HTML of the findings about the open parameters.
    verified : str
        HTML of what `make verify` found.
    """
    return (
        environment()
        .get_template("report.html.j2")
        .render(
            study=study,
            counts=verdict(entries),
            entries=entries,
            figures=[
                _figure(Places(study.name), name, caption, entries)
                for name, caption in captions.items()
            ],
            notebook_of=_notebook_of,
            equations=EQUATIONS,
            stated=list(description.parameters(study)),
            derived=list(description.derived(study)),
            identified=identified,
            verified=verified,
            computation=list(description.computation(study, resonance)),
            sensitivity=list(_sensitivity(resonance)),
        )
    )


def _relative(places: Places, target: Path) -> str:
    return Path(os.path.relpath(target, places.report.parent)).as_posix()


def _notebook_of(figure: str) -> str | None:
    """Return the page of the notebook that checks the claims of `figure`, from the report."""
    return f"notebooks/{figure}.html" if figure in paths.NOTEBOOK_NAMES else None


def _figure(places: Places, name: str, caption: str, entries: Iterable[Entry]) -> Figure:
    png, svg = places.figure_files(name)
    return Figure(
        name=name,
        title=f"Fig. {name.removeprefix('fig')}",
        caption=" ".join(caption.split()),
        svg=_relative(places, svg),
        png=_relative(places, png),
        notebook=_notebook_of(name),
        entries=tuple(entry for entry in entries if entry.figure == name),
    )


def _sensitivity(resonance: xr.Dataset) -> Iterable[tuple[str, int, int, float]]:
    """Yield variants with sensitive cases, their number, all cases, and the others' worst error."""
    for name in resonance["variant"].values:
        course = resonance.sel(variant=name)
        computed = course["status"].values == 0
        sensitive = computed & (course["sensitive"].values == 1)
        if sensitive.any():
            rest = course["y_max_error_rel"].values[computed & ~sensitive]
            worst = float(rest.max()) if rest.size else float("nan")
            yield str(name), int(sensitive.sum()), int(computed.sum()), worst
