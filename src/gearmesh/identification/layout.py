"""Files of the identification, and the batches and chains of its designs."""

from pathlib import Path

from gearmesh.data import paths
from gearmesh.identification.settings import Settings

SETTINGS = paths.CONFIG / "identify.yaml"
FOLDER = paths.RESULTS / "identification"
DATASET = paths.DATASETS / "identification.nc"
FOUND = FOLDER / "identified.yaml"
NOTEBOOK = paths.EXECUTED_NOTEBOOKS / "identification.ipynb"
FIGURES = FOLDER / "figures"
FIGURE_NAMES = ("regions", "supports", "sensitivity")

REPORTED = {name: paths.REPORT.parent / name for name in ("regions", "sensitivity")}
"""Figures that the report draws from the committed table, without suffix."""

IDENTIFIED = paths.CONFIG / "identified.yaml"
"""The committed copy of `FOUND`, which the report reads."""


def batch_file(design: str, index: int) -> Path:
    """Return the file of a batch of samples."""
    return FOLDER / design / f"batch-{index:03d}.nc"


def box_file(design: str) -> Path:
    """Return the file with the box that a focused design fills."""
    return FOLDER / design / "box.nc"


def batch_count(settings: Settings, design: str) -> int:
    """Return the number of batches of a design."""
    stated = settings.designs[design]
    return -(-stated.points // stated.points_per_job)


def batch_files(settings: Settings, *designs: str) -> list[str]:
    """Return the files of all batches of some designs."""
    return [
        str(batch_file(design, index))
        for design in designs
        for index in range(batch_count(settings, design))
    ]


def family(settings: Settings, design: str) -> list[str]:
    """Return the even design at the start of a chain of focused ones, and the chain to `design`."""
    around = settings.designs[design].around
    return [design] if around is None else [*family(settings, around), design]
