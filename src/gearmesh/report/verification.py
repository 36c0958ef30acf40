"""The section of the report about `make verify`, if it was run on the results that are there."""

import json
from typing import Any

from gearmesh.data import manifest
from gearmesh.data.paths import Places
from gearmesh.report.presentation import environment

SHOWN = {
    "strobe_y": "stroboscopic y",
    "strobe_v": "stroboscopic y'",
    "extremum_y": "extrema of y",
    "extremum_time": "their times",
    "y_max": "y_max",
    "y_rms": "y_rms",
    "contact_loss_fraction": "time of contact loss",
}
"""Observables with a column of their own, and its heading; lengths in y_st, times in T."""


def section(places: Places) -> str:
    """Return the HTML of the section; empty if these results have not been verified."""
    found = _read(places)
    if found is None:
        return ""
    rest = {name for entry in found["variants"].values() for name in entry["differences"]}
    return (
        environment()
        .get_template("verification.html.j2")
        .render(found=found, shown=SHOWN, others=len(rest - SHOWN.keys()), greatest=_greatest)
    )


def _read(places: Places) -> dict[str, Any] | None:
    try:
        found: dict[str, Any] = json.loads(places.verification.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    verified = found["datasets"]
    return found if manifest.Hashes(places.folder).of(verified) == verified else None


def _greatest(entry: dict[str, Any]) -> float:
    """Return the greatest difference of the observables without a column of their own."""
    others = [value for name, value in entry["differences"].items() if name not in SHOWN]
    return max(others, default=0.0)
