"""The report of a study of one's own: one page that opens from disk, figures included.

It describes and shows what was computed, without a comparison with the paper.
"""

import base64
from collections import Counter
from pathlib import Path

import xarray as xr

from gearmesh.data.datasets import open_dataset
from gearmesh.data.paths import Places
from gearmesh.data.writing import write_text
from gearmesh.report import description
from gearmesh.report.presentation import environment
from gearmesh.solvers.response import STATUSES
from gearmesh.study.cases import Study


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
    figures = {
        name: _embedded(places.figure_files(name)[0]) for name in ("response", "bifurcation")
    }
    write_text(places.report, render(study, open_dataset(places.resonance), figures))


def render(study: Study, resonance: xr.Dataset, figures: dict[str, str]) -> str:
    """Return the page.

    Parameters
    ----------
    study : Study
        Parameters and the plan of cases.
    resonance : xarray.Dataset
        Status of every case.
    figures : dict of str to str
        Address of the pictures ``response`` and ``bifurcation``.
    """
    template = environment().get_template("study.html.j2")
    return template.render(
        study=study,
        figures=figures,
        parameters=list(description.parameters(study)),
        variants=[_row(resonance.sel(variant=name)) for name in resonance["variant"].values],
        computation=list(description.computation(study, resonance)),
    )


def _embedded(picture: Path) -> str:
    """Return a picture as part of the page."""
    content = base64.b64encode(picture.read_bytes()).decode()
    return f"data:image/png;base64,{content}"


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
