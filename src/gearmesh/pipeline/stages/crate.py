"""Describe where the results come from."""

from pathlib import Path

from gearmesh.data.paths import Places
from gearmesh.study.cases import Study


def crate(study: Study, places: Places) -> list[Path]:
    """Write the provenance of the study as a Workflow Run RO-Crate."""
    from gearmesh.pipeline.crate import write_crate

    return write_crate(study, places)
