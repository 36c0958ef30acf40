"""The explorer page: one file without a network, whose scripts hold the solver."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import xarray as xr

from gearmesh.data.datasets import open_dataset
from gearmesh.data.paths import Places
from gearmesh.data.writing import write_text
from gearmesh.dynamics.continuation.kinds import KINDS
from gearmesh.model.variants import variant
from gearmesh.report.explorer import controls, numbers, views
from gearmesh.report.presentation import environment
from gearmesh.solvers.reduced.runs import is_reducible
from gearmesh.solvers.response import STATUSES
from gearmesh.study.cases import Study

SCRIPTS = tuple(
    Path(__file__).parent / "scripts" / f"{name}.js"
    for name in (
        *("solver/model", "solver/series", "solver/events", "solver/run"),
        *("page/numbers", "page/view", "page/pens", "page/axes", "page/diagram"),
        *("page/orbit", "page/sweep", "page/readout", "page/export", "page/pointer", "page/main"),
    )
)
"""The scripts in the order in which they are joined; each may use those before it."""


def write_explorer(study: Study, places: Places) -> None:
    """Write the explorer from the datasets of a run.

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
    orbits = None
    if study.plan.mechanisms is not None:
        points = json.loads(places.special_points.read_text(encoding="utf-8"))
        orbits = open_dataset(places.branches), points
    extrema = open_dataset(places.bifurcation, ("extremum_y_rel", "extremum_kind"))
    page = render(study, open_dataset(places.resonance), extrema, orbits)
    write_text(places.explorer, page)


Orbits = tuple[xr.Dataset, list[dict[str, Any]]]
"""Branches of orbits, and their special points."""


def render(
    study: Study, resonance: xr.Dataset, bifurcation: xr.Dataset, orbits: Orbits | None = None
) -> str:
    """Return the page.

    Parameters
    ----------
    study : Study
        Parameters and variants.
    resonance, bifurcation : xarray.Dataset
        Its datasets.
    orbits : tuple, optional
        Its branches of orbits with their special points, if the study has them.
    """
    names = [str(name) for name in bifurcation["variant"].values]
    arrays = numbers.diagram(resonance, bifurcation)
    if orbits is not None:
        arrays |= numbers.orbits(*orbits, names)
    packed = numbers.pack(arrays)
    pair = study.pair
    described = {
        "study": study.name,
        "title": study.title,
        "pair": controls.of_one_wheel(pair),
        "variants": names,
        "statuses": list(STATUSES),
        "kinds": list(KINDS),
        "arrays": packed.index,
    }
    return (
        environment()
        .get_template("explorer.html.j2")
        .render(
            study=study,
            variants=[(name, variant(name).description) for name in names],
            controls=controls.shown(pair),
            nu=(float(resonance["nu"].min()), float(resonance["nu"].max())),
            reducible=is_reducible(pair.problem(variant(names[0]), float(resonance["nu"][0]))),
            tour=views.TOUR if study.claims else (),
            orbits=orbits is not None,
            described=_for_script(described),
            numbers=packed.text,
            scripts=_joined(SCRIPTS),
        )
    )


def _joined(files: Iterable[Path]) -> str:
    return "\n".join(file.read_text(encoding="utf-8") for file in files)


def _for_script(value: object) -> str:
    """Return JSON that can stand within a script element."""
    return json.dumps(value, ensure_ascii=False).replace("<", "\\u003c")
