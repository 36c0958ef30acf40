"""Batches: the cases of a letter of Tab. 1, and the file from which the datasets are made.

A job computes all cases of a letter and writes them, one after the other, into one batch file. The
datasets are made of these few files. The thousands of case files are for readers; a study with too
many cases leaves them out (``case_files: false``), and its datasets are the same.
"""

import contextlib
import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from gearmesh.data import casefile
from gearmesh.data.casefile import FIELDS, Field, Record
from gearmesh.errors import InputError
from gearmesh.study.cases import Case
from gearmesh.study.pair import Pair

STORED = tuple((field, field.relative or field.name) for field in FIELDS)
"""Fields and names of the variables of a batch file: lengths in static deflections only."""


@dataclass(slots=True)
class Content:
    """What a batch file holds.

    Attributes
    ----------
    variants : list of str, one for each case
        Names of the variants.
    nu : ndarray, shape (n_cases,)
        Mesh frequencies nu_s.
    counts : ndarray, shape (n_cases,)
        Numbers of extrema.
    columns : dict of str to ndarray
        Scalars (n_cases,), stroboscopic points (n_cases, n_boundaries), and the extrema of all
        cases one after the other.
    """

    variants: list[str]
    nu: np.ndarray
    counts: np.ndarray
    columns: dict[str, np.ndarray]

    def split(self) -> Iterator["Content"]:
        """Yield the cases of one variant after the other."""
        first = 0
        for _, group in itertools.groupby(self.variants):
            last = first + len(list(group))
            yield self.part(first, last)
            first = last

    def part(self, first: int, last: int) -> "Content":
        """Return the cases from `first` up to, but not including, `last`."""
        ends = np.concatenate([[0], np.cumsum(self.counts)])
        cases, extrema = slice(first, last), slice(ends[first], ends[last])
        columns = {
            name: self.columns[name][extrema if field.dimension == "extremum" else cases]
            for field, name in STORED
        }
        return Content(self.variants[cases], self.nu[cases], self.counts[cases], columns)


def by_letter(cases: Iterable[Case]) -> dict[str, list[Case]]:
    """Return the cases of each letter of Tab. 1, in their order."""
    found: dict[str, list[Case]] = {}
    for case in cases:
        found.setdefault(case.variant.letter, []).append(case)
    return found


def write_batch(path: Path, pair: Pair, cases: Sequence[Case], records: Sequence[Record]) -> None:
    """Write a batch file, whole or not at all.

    Parameters
    ----------
    path : Path
        File.
    pair : Pair
        What all cases share.
    cases : sequence of Case
        The cases.
    records : sequence of Record
        What was computed, in the order of the cases.
    """
    names = list(dict.fromkeys(case.variant.name for case in cases))
    index = Field("variant", "", "1", "damping variant", "i2", dict(enumerate(names)))
    with casefile.created(path) as file:
        file.setncatts(
            {
                "Conventions": "CF-1.11",
                "title": f"gear mesh, {len(cases)} cases",
                **casefile.common_attributes(pair),
            }
        )
        file.createDimension("case", len(records))
        values: dict[str, Any] = {
            "variant": [names.index(case.variant.name) for case in cases],
            "nu": [case.nu for case in cases],
            "extremum_count": [record["extremum_kind"].size for record in records],
        }
        casefile.define(file, index, "variant", ("case",))
        casefile.define(file, Field("nu", "", "1", "mesh frequency nu_s"), "nu", ("case",))
        count = Field("extremum_count", "", "1", "number of extrema of a case", "i4")
        rows = casefile.define(file, count, "extremum_count", ("case",))
        rows.sample_dimension = "extremum"
        for field, name in STORED:
            values[name] = _joined(field, [record[name] for record in records])
            dimensions = _dimensions(field)
            for dimension, size in zip(dimensions, values[name].shape, strict=True):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, size)
            casefile.define(file, field, name, dimensions)
        for name, array in values.items():
            file[name][...] = array


def _dimensions(field: Field) -> tuple[str, ...]:
    return {"extremum": ("extremum",), "": ("case",)}.get(field.dimension, ("case", "boundary"))


def _joined(field: Field, arrays: Sequence[np.ndarray]) -> np.ndarray:
    return np.concatenate(arrays) if field.dimension == "extremum" else np.stack(arrays)


def read_batch(path: Path) -> Content:
    """Read a batch file.

    Raises
    ------
    InputError
        If it is missing or damaged.
    """
    with _opened(path) as file:
        names = file["variant"].flag_meanings.split()
        return Content(
            variants=[names[i] for i in file["variant"][:]],
            nu=file["nu"][:],
            counts=file["extremum_count"][:],
            columns={name: file[name][:] for _, name in STORED},
        )


def read_counts(path: Path) -> np.ndarray:
    """Read only the number of extrema of each case of a batch file."""
    with _opened(path) as file:
        return file["extremum_count"][:]


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[netCDF4.Dataset]:
    try:
        with netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            yield file
    except (OSError, IndexError, RuntimeError):
        raise InputError(f"{path}: missing or damaged; delete it and run again") from None
