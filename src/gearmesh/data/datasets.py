"""All cases of a study in two datasets over (variant, nu): resonance and bifurcation.

`resonance.nc` holds every scalar of a case file, `bifurcation.nc` every extremum and stroboscopic
point. A cell without a case (the more damped variant has a range of its own) is not-a-number, and
its status ``not_computed``. Runs for time courses that are not on the grid are in their case files
only. In the files `variant` is a number with the names beside it, as CF wants it; `open_dataset`
reads either file with the names as the index.
"""

import contextlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

from gearmesh.data import batches, casefile, classic, writing
from gearmesh.data.batches import Content
from gearmesh.data.casefile import FIELDS, LOAD_FIELDS, MISSING, Field
from gearmesh.errors import InputError
from gearmesh.model.variants import Variant
from gearmesh.study.cases import Study

_FLAGS_OF_NO_CASE = {"status": {MISSING: "not_computed"}}
NAMES = "variant_name"
"""The variable with the names of the variants."""

_LABELS = (
    ("name", NAMES, "name of the damping variant"),
    ("letter", "letter", "letter of Tab. 1: which powers of the velocity damp"),
    ("symbol", "symbol", "where the damping acts"),
    ("marker", "marker", "marker of Tab. 1"),
)
"""Attribute of a variant, variable, and what it is."""

_COORDINATES = " ".join(("damping_factor", *(name for _, name, _ in _LABELS)))
_BLOCK = 512
"""Number of frequencies that are written at a time; it limits the memory that is needed."""

_COMPRESSED = {"compression": "zlib", "complevel": 1, "shuffle": True}


def open_dataset(path: Path | str, only: Sequence[str] = ()) -> xr.Dataset:
    """Open a dataset or a case file and load it; variants are selected by name.

    Parameters
    ----------
    path : Path or str
        The file.
    only : sequence of str
        Variables to load; all by default.

    Raises
    ------
    InputError
        If it is missing or damaged.
    """
    try:
        classic.refuse_damage(path)
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            found = (dataset[list(only)] if only else dataset).load()
    except (OSError, ValueError, RuntimeError):
        raise InputError(f"{path}: missing or damaged; delete it and run again") from None
    if NAMES not in found.variables:
        return found
    return found.set_index(variant=NAMES)


def write_datasets(
    study: Study, batch_files: Sequence[Path], resonance: Path, bifurcation: Path
) -> None:
    """Make both datasets from the batches of a study; the same input gives the same bytes.

    Parameters
    ----------
    study : Study
        The study; it sets the variants, the frequencies and y_st.
    batch_files : sequence of Path
        All its batches. In each, the cases of a variant are contiguous, by ascending frequency.
        Only one batch at a time is in memory.
    resonance, bifurcation : Path
        Files to write.
    """
    plan = study.plan.frequencies()
    nu = np.array(sorted({nu for _, nus in plan for nu in nus}))
    longest = max(int(batches.read_counts(file).max()) for file in batch_files)
    sizes = {"variant": len(plan), "nu": nu.size}
    more = {"extremum": max(longest, 1), "boundary": casefile.boundaries(study.pair)}
    with (
        _created(resonance, study, "resonance", sizes) as scalars,
        _created(bifurcation, study, "bifurcation", sizes | more) as sequences,
    ):
        for file in (scalars, sequences):
            _write_coordinates(file, [variant for variant, _ in plan], nu)
        fields = (*FIELDS, *(LOAD_FIELDS if study.plan.loads else ()))
        for field in fields:
            _define(sequences if field.dimension else scalars, field)
        rows = {variant.name: row for row, (variant, _) in enumerate(plan)}
        for name, start, content in _by_block(batch_files, nu):
            block = nu[start : start + _BLOCK]
            place = rows[name], slice(start, start + block.size)
            for field in fields:
                cells = _cells(field, content, block, longest)
                file = sequences if field.dimension else scalars
                _store(file, field, place, cells, study.pair.static_deflection)


@contextlib.contextmanager
def _created(
    path: Path, study: Study, title: str, sizes: Mapping[str, int]
) -> Iterator[netCDF4.Dataset]:
    with writing.replacing(path) as temporary, netCDF4.Dataset(temporary, "w") as file:
        # A chunk may reach beyond the last frequency; the values there must be defined, too.
        file.set_fill_on()
        file.setncatts(
            {
                "Conventions": "CF-1.11",
                "title": f"{study.title}: {title}",
                **casefile.common_attributes(study.pair),
                "history": f"gearmesh: put together from all cases of the study {study.name}",
            }
        )
        for name, size in sizes.items():
            file.createDimension(name, size)
        yield file


def _write_coordinates(file: netCDF4.Dataset, variants: Sequence[Variant], nu: np.ndarray) -> None:
    numbers = {row: variant.name for row, variant in enumerate(variants)}
    index = Field("variant", "", "1", "number of the damping variant", "i4", numbers)
    _create(file, index, index.name, ("variant",))[:] = list(numbers)
    for attribute, name, long_name in _LABELS:
        labels = file.createVariable(name, str, ("variant",))
        labels.setncatts({"long_name": long_name})
        labels[:] = np.array([getattr(variant, attribute) for variant in variants], object)
    factor = Field("damping_factor", "", "1", "multiple of the printed damping")
    factors = _create(file, factor, factor.name, ("variant",))
    factors[:] = [variant.factor for variant in variants]
    frequency = Field("nu", "", "1", "mesh frequency nu_s, in units of Omega_s")
    _create(file, frequency, frequency.name, ("nu",))[:] = nu


def _create(
    file: netCDF4.Dataset, field: Field, name: str, dimensions: tuple[str, ...], **storage: Any
) -> "netCDF4.Variable[Any]":
    """Create the variable of a field, or of its twin, with its attributes."""
    variable = file.createVariable(name, field.kind, dimensions, fill_value=field.fill, **storage)
    variable.setncatts(casefile.variable_attributes(field, relative=name != field.name))
    variable.set_auto_maskandscale(False)
    return variable


def _define(file: netCDF4.Dataset, field: Field) -> None:
    """Create a variable over (variant, nu), and its twin."""
    dimensions = ("variant", "nu", *([field.dimension] if field.dimension else []))
    sizes = [file.dimensions[name].size for name in dimensions]
    chunk = (1, min(sizes[1], _BLOCK), *sizes[2:])
    flags = {**(field.flags or {}), **_FLAGS_OF_NO_CASE.get(field.name, {})}
    field = replace(field, flags=flags, fill=np.nan if field.kind == "f8" else field.fill)
    for name in filter(None, (field.name, field.relative)):
        variable = _create(file, field, name, dimensions, chunksizes=chunk, **_COMPRESSED)
        variable.coordinates = _COORDINATES
        # Every chunk is written once, as a whole. A cache would keep megabytes for each variable.
        variable.set_var_chunk_cache(size=1)


def _store(
    file: netCDF4.Dataset,
    field: Field,
    place: tuple[int, slice],
    cells: np.ndarray,
    static_deflection: float,
) -> None:
    """Write some frequencies of a variant, in static deflections and in mm."""
    if field.relative:
        file[field.relative][place] = cells
        cells = cells * static_deflection
    file[field.name][place] = cells


def _by_block(batch_files: Iterable[Path], nu: np.ndarray) -> Iterator[tuple[str, int, Content]]:
    """Yield variant, start of a block of frequencies, and the cases in it.

    A block is a chunk of the files, so that each chunk is written once.
    """
    for file in batch_files:
        for content in batches.read_batch(file).split():
            for start in range(0, nu.size, _BLOCK):
                block = nu[start : start + _BLOCK]
                first = int(np.searchsorted(content.nu, block[0]))
                last = int(np.searchsorted(content.nu, block[-1], side="right"))
                yield content.variants[0], start, content.part(first, last)


def _cells(field: Field, content: Content, nu: np.ndarray, longest: int) -> np.ndarray:
    """Spread the values of a variant over all frequencies."""
    stored = content.columns[field.relative or field.name]
    if field.dimension == "extremum":
        rectangle = np.full((content.nu.size, max(longest, 1)), casefile.absent(field), field.kind)
        rectangle[np.arange(rectangle.shape[1]) < content.counts[:, None]] = stored
        stored = rectangle
    cells = np.full((nu.size, *stored.shape[1:]), casefile.absent(field), field.kind)
    on_grid = np.isin(content.nu, nu)
    cells[np.searchsorted(nu, content.nu[on_grid])] = stored[on_grid]
    return cells
