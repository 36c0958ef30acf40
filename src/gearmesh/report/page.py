"""The report: one page that opens from disk.

It needs no network and no other file: styles and figures are within it, equations are MathML. It
links to the explorer and the pages of the notebooks beside it, and to the files of its figures.
`render` makes the page of the paper's study and `render_study` that of a study of one's own, from
their arguments; `write_report` reads the results of a run and writes either.
"""

import base64
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from gearmesh.data import paths
from gearmesh.data.datasets import open_dataset
from gearmesh.data.paths import Places
from gearmesh.data.writing import write_text
from gearmesh.identification import layout, table
from gearmesh.identification.settings import load_settings
from gearmesh.report import description, glossary, verification, why
from gearmesh.report.explorer import views
from gearmesh.report.identified import section
from gearmesh.report.presentation import environment
from gearmesh.reproduction.claims import Entry, load_ledger, read_entries, verdict
from gearmesh.reproduction.equations import EQUATIONS
from gearmesh.solvers.response import STATUSES
from gearmesh.study.cases import Study


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure on the page.

    Attributes
    ----------
    name, title, caption : str
        Its id, its number and what it shows.
    picture : str
        The picture as the address of an image.
    notebook : str, optional
        Page of the notebook that draws it.
    view : str, optional
        The view of the explorer that belongs to it.
    entries : tuple of Entry
        The claims that it shows.
    """

    name: str
    title: str
    caption: str
    picture: str
    notebook: str | None = None
    view: str | None = None
    entries: tuple[Entry, ...] = ()


STUDY_FIGURES = {
    "response": (
        "Response curves",
        "Greatest and least relative motion y in the mesh over the kept revolutions, against the "
        "mesh frequency ν_s. White is normal mesh, yellow contact loss, red inverse mesh.",
    ),
    "bifurcation": (
        "Bifurcation diagrams",
        "Every local extremum of y in the kept revolutions: few points at a frequency mean a "
        "periodic motion, a cloud one that does not repeat.",
    ),
}
"""Titles and captions of the figures of a study of one's own."""


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
    resonance = open_dataset(places.resonance)
    if not study.claims:
        pictures = {name: embedded(places.figure_files(name)[0]) for name in STUDY_FIGURES}
        write_text(places.report, render_study(study, resonance, pictures))
        return
    captions = {
        name: (paths.CAPTIONS / f"{name}.rst").read_text(encoding="utf-8")
        for name in paths.FIGURE_NAMES
    }
    pictures = {name: embedded(places.figure_files(name)[1]) for name in captions}
    page = render(
        *(study, read_entries(places.ledger), resonance, captions, pictures),
        *(_identified(study), verification.section(places), _why(study, places)),
    )
    write_text(places.report, page)


def _why(study: Study, places: Places) -> str:
    """Return the section about orbits and attractors; nothing if the study follows none."""
    if study.plan.mechanisms is None:
        return ""
    figures = {
        name: Figure(
            name,
            title,
            " ".join((paths.CAPTIONS / f"{name}.rst").read_text(encoding="utf-8").split()),
            embedded(places.figure_files(name)[1]),
            f"notebooks/{paths.WHY}.html",
            views.FIGURES[name],
        )
        for name, title in why.TITLES.items()
    }
    return why.section(study, places, figures)


def embedded(picture: Path) -> str:
    """Return a picture as an address that holds it."""
    kind = "svg+xml" if picture.suffix == ".svg" else "png"
    return f"data:image/{kind};base64,{base64.b64encode(picture.read_bytes()).decode()}"


def _identified(study: Study) -> str:
    """Return the findings about the open parameters as HTML."""
    drawn = layout.reported(Places(study.name))
    return section(
        table.read(),
        load_ledger(paths.CLAIMS),
        load_settings(layout.SETTINGS),
        study.pair,
        {name: embedded(path.with_suffix(".svg")) for name, path in drawn.items()},
    )


def render(
    study: Study,
    entries: Sequence[Entry],
    resonance: xr.Dataset,
    captions: Mapping[str, str],
    pictures: Mapping[str, str],
    identified: str = "",
    verified: str = "",
    orbits: str = "",
) -> str:
    """Return the page of the paper's study.

    Parameters
    ----------
    study : Study
        Parameters, their reasons, and the plan of cases.
    entries : sequence of Entry
        The ledger with what was found.
    resonance : xarray.Dataset
        Status and sensitivity of every case.
    captions, pictures : mapping of str to str
        Caption of each figure, and its picture as the address of an image.
    identified : str
        HTML of the findings about the open parameters.
    verified : str
        HTML of what `make verify` found.
    orbits : str
        HTML of the section about orbits and attractors.
    """
    figures = [_figure(name, captions[name], pictures[name], entries) for name in captions]
    template = environment().get_template("report.html.j2")
    return template.render(
        study=study,
        counts=verdict(entries),
        entries=entries,
        figures=figures,
        titles={figure.name: figure.title for figure in figures if figure.notebook},
        views=views.CLAIMS,
        equations=EQUATIONS,
        stated=description.parameters(study),
        derived=description.derived(study),
        identified=identified,
        verified=verified,
        orbits=orbits,
        glossary=list(glossary.parts(paths.GLOSSARY.read_text(encoding="utf-8"))),
        computation=list(description.computation(study, resonance)),
        sensitivity=list(_sensitivity(resonance)),
    )


def render_study(study: Study, resonance: xr.Dataset, pictures: Mapping[str, str]) -> str:
    """Return the page of a study of one's own; it does not speak of the paper.

    Parameters
    ----------
    study : Study
        Parameters and the plan of cases.
    resonance : xarray.Dataset
        Status of every case.
    pictures : mapping of str to str
        The pictures of `STUDY_FIGURES`, as addresses of images.
    """
    template = environment().get_template("study.html.j2")
    return template.render(
        study=study,
        figures=[Figure(name, *STUDY_FIGURES[name], picture) for name, picture in pictures.items()],
        parameters=description.parameters(study),
        variants=[_row(resonance.sel(variant=name)) for name in resonance["variant"].values],
        computation=list(description.computation(study, resonance)),
    )


def _figure(name: str, caption: str, picture: str, entries: Iterable[Entry]) -> Figure:
    return Figure(
        name=name,
        title=f"Fig. {name.removeprefix('fig')}",
        caption=" ".join(caption.split()),
        picture=picture,
        notebook=f"notebooks/{name}.html" if name in paths.NOTEBOOK_NAMES else None,
        view=views.FIGURES.get(name),
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


def _row(curve: xr.Dataset) -> dict[str, object]:
    """Return the results of one variant."""
    counts = Counter(int(flag) for flag in curve["status"].values)
    failed = {STATUSES[flag]: number for flag, number in sorted(counts.items()) if flag > 0}
    return {
        "name": str(curve["variant"].item()),
        "computed": sum(number for flag, number in counts.items() if flag >= 0),
        "failed": failed,
        "sensitive": int((curve["sensitive"].values == 1).sum()),
        "y_max": float(curve["y_max_rel"].max()),
        "y_min": float(curve["y_min_rel"].min()),
    }
