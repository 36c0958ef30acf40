"""Files of the identification, and the batches and chains of its designs."""

from pathlib import Path

from gearmesh.data import paths
from gearmesh.data.paths import Places
from gearmesh.identification.settings import Settings

SETTINGS = paths.CONFIG / "identify.yaml"
FIGURE_NAMES = ("regions", "supports", "sensitivity")

IDENTIFIED = paths.CONFIG / "identified.yaml"
"""The committed copy of `found`, which the report reads."""


def folder(places: Places) -> Path:
    """Return the folder of the identification."""
    return places.folder / "identification"


def dataset(places: Places) -> Path:
    """Return the file with all samples."""
    return places.folder / "datasets" / "identification.nc"


def found(places: Places) -> Path:
    """Return the file with the findings."""
    return folder(places) / "identified.yaml"


def figures(places: Places) -> Path:
    """Return the folder of the figures that the notebook draws."""
    return folder(places) / "figures"


def figure_files(places: Places) -> list[Path]:
    """Return the figures that the notebook draws."""
    return [figures(places) / f"{name}{end}" for name in FIGURE_NAMES for end in (".png", ".svg")]


def reported(places: Places) -> dict[str, Path]:
    """Return figures that the report draws from the committed table, without suffix."""
    return {name: places.report.parent / name for name in ("regions", "sensitivity")}


def batch_file(places: Places, design: str, index: int | str) -> Path:
    """Return the file of a batch of samples; names may be wildcards."""
    number = index if isinstance(index, str) else f"{index:03d}"
    return folder(places) / design / f"batch-{number}.nc"


def box_file(places: Places, design: str) -> Path:
    """Return the file with the box that a focused design fills."""
    return folder(places) / design / "box.nc"


def batch_count(settings: Settings, design: str) -> int:
    """Return the number of batches of a design."""
    stated = settings.designs[design]
    return -(-stated.points // stated.points_per_job)


def batch_files(places: Places, settings: Settings, *designs: str) -> list[Path]:
    """Return the files of all batches of some designs."""
    return [
        batch_file(places, design, index)
        for design in designs
        for index in range(batch_count(settings, design))
    ]


def family(settings: Settings, design: str) -> list[str]:
    """Return the even design at the start of a chain of focused ones, and the chain to `design`."""
    around = settings.designs[design].around
    return [design] if around is None else [*family(settings, around), design]
