"""Batches: the cases of a letter of Tab. 1, and the file from which the datasets are made.

A job computes all cases of a letter and writes them, one after the other, into one batch file. The
datasets are made of these few files. The thousands of case files are for readers; a study with too
many cases leaves them out (``case_files: false``), and its datasets are the same.
"""

import itertools
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearmesh.data import casefile, classic
from gearmesh.data.casefile import Field, Record
from gearmesh.study.cases import Case
from gearmesh.study.pair import Pair


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
            for field, name in _stored(self.columns)
        }
        return Content(self.variants[cases], self.nu[cases], self.counts[cases], columns)


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
    frequency = Field("nu", "", "1", "mesh frequency nu_s")
    count = Field("extremum_count", "", "1", "number of extrema of a case", "i4")
    of_cases = (
        (index, [names.index(case.variant.name) for case in cases]),
        (frequency, [case.nu for case in cases]),
        (count, [record["extremum_kind"].size for record in records]),
    )
    variables = {
        field.name: casefile.variable(field, field.name, np.array(values), ("case",))
        for field, values in of_cases
    }
    for field, name in _stored(records[0]):
        joined = _joined(field, [record[name] for record in records])
        variables[name] = casefile.variable(field, name, joined, _dimensions(field))
    attributes = {
        "Conventions": "CF-1.11",
        "title": f"gear mesh, {len(cases)} cases",
        **casefile.common_attributes(pair),
    }
    classic.write(path, attributes, variables)


def _stored(names: Container[str]) -> list[tuple[Field, str]]:
    """Return fields and names of variables of a batch file: lengths in static deflections only."""
    return [(field, field.relative or field.name) for field in casefile.fields_in(names)]


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
    with classic.opened(path) as file:
        stored = {name: classic.values(found) for name, found in file.variables.items()}
        names = file.variables["variant"].flag_meanings.decode().split()
        return Content(
            variants=[names[i] for i in stored["variant"]],
            nu=stored["nu"],
            counts=stored["extremum_count"],
            columns={name: stored[name] for _, name in _stored(stored)},
        )


def read_counts(path: Path) -> np.ndarray:
    """Read only the number of extrema of each case of a batch file."""
    with classic.opened(path) as file:
        return classic.values(file.variables["extremum_count"])
