"""Why it jumps: the section of the report about orbits, stability and attractors."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from gearmesh.data import paths
from gearmesh.data.datasets import open_dataset
from gearmesh.data.paths import Places
from gearmesh.report.presentation import environment
from gearmesh.reproduction.claims import Entry, read_entries
from gearmesh.reproduction.mechanisms.answers import answers, special_table
from gearmesh.reproduction.mechanisms.tables import Row
from gearmesh.study.cases import Study

TITLES = {
    "branches": "Orbits behind the curves",
    "basins": "Basins, and the share of starting phases",
    "sweeps": "Sweeps up and down",
    "special_curves": "Special points over the damping",
    "lyapunov": "Lyapunov exponents",
    "design_map": "A design map",
}
"""Titles of the figures."""


def section(study: Study, places: Places, figures: Mapping[str, object]) -> str:
    """Return the section as HTML.

    Parameters
    ----------
    study : Study
        The study of the paper.
    places : Places
        Where its results are.
    figures : mapping
        The figures of `TITLES`, for the template.
    """
    special = json.loads(places.special_points.read_text(encoding="utf-8"))
    names = ("branches", *paths.MECHANISMS)
    found = answers(
        special,
        {name: open_dataset(places.mechanism(name)) for name in names},
        json.loads(places.thresholds.read_text(encoding="utf-8")),
        study.pair,
    )
    closing = _closing(read_entries(places.ledger))
    template = environment().get_template("why.html.j2")
    return template.render(
        figures=figures,
        pair=study.pair,
        closing=closing,
        points_table=points_table(special),
        **found,
    )


def points_table(special: Sequence[Row]) -> str:
    """Return the table of special points as HTML."""
    template = environment().get_template("points.html.j2")
    return template.render(points=special_table(special))


def _closing(entries: Sequence[Entry]) -> dict[str, Any]:
    """Return the tongue of the third parametric resonance in closed form, claim P8."""
    measured = (entry.measured for entry in entries if entry.id == "P8")
    return next((found for found in measured if found), {})
