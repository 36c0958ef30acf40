"""Samples in files: batches, and all of them as one dataset."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from gearmesh.errors import InputError
from gearmesh.identification.factors import FACTORS, KINDS
from gearmesh.identification.sampling.design import Sample
from gearmesh.identification.settings import Design


@dataclass(frozen=True)
class Samples:
    """Samples with what was measured on them.

    Attributes
    ----------
    design : ndarray of str, shape (n,)
        Design that each belongs to.
    values : dict of str to ndarray, shape (n,)
        Factor -> values; the kind of run as its place in `KINDS`.
    places : dict of str to ndarray, shape (n,)
        Factor -> place in the unit cube of its design, NaN where the design does not vary it.
    measured : dict of str to ndarray, shape (n,)
        Column -> what was measured, see `gearmesh.identification.sampling.survey`.
    """

    design: np.ndarray
    values: Mapping[str, np.ndarray]
    places: Mapping[str, np.ndarray]
    measured: Mapping[str, np.ndarray]

    def of(self, *designs: str) -> "Samples":
        """Return the samples of some designs."""
        wanted = np.isin(self.design, designs)
        return Samples(
            self.design[wanted],
            *(
                {name: array[wanted] for name, array in part.items()}
                for part in (self.values, self.places, self.measured)
            ),
        )

    def unit(self, factors: Sequence[str]) -> np.ndarray:
        """Return the places along some factors, shape (n, n_factors)."""
        return np.column_stack([self.places[name] for name in factors])


def dataset(
    name: str,
    design: Design,
    places: np.ndarray,
    samples: Sequence[Sample],
    rows: Sequence[Mapping[str, float]],
) -> xr.Dataset:
    """Return samples of one design as a dataset."""
    columns = sorted({column for row in rows for column in row})
    varied = dict(zip(design.vary, places.T, strict=True))
    nothing = np.full(len(samples), np.nan)
    made = xr.Dataset(
        {
            "place": (
                ("factor", "sample"),
                np.array([varied.get(factor, nothing) for factor in FACTORS]),
                {"long_name": "place in the unit cube of the design", "units": "1"},
            ),
            "value": (
                ("factor", "sample"),
                np.array([[_number(s[factor]) for s in samples] for factor in FACTORS]),
                {
                    "long_name": "value of an open parameter, in y_st, m_red, C_s or y_st Omega_s; "
                    f"kind of run: {', '.join(f'{i} {kind}' for i, kind in enumerate(KINDS))}",
                    "units": "1",
                },
            ),
            "measured": (
                ("column", "sample"),
                np.array([[row.get(column, np.nan) for row in rows] for column in columns]),
                {
                    "long_name": "what a claim measures: claim, quantity, variant; nu_s or y_st",
                    "units": "1",
                },
            ),
        },
        {"factor": list(FACTORS), "column": columns, "design": ("sample", [name] * len(samples))},
    )
    return made


def _number(value: float | str) -> float:
    return float(KINDS.index(value)) if isinstance(value, str) else float(value)


def write(path: Path, content: xr.Dataset, title: str) -> None:
    """Write a dataset; if this fails, no partial file is left."""
    content = content.assign_attrs(Conventions="CF-1.11", title=title)
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        content.to_netcdf(temporary, engine="netcdf4")
        temporary.replace(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error}") from None
    finally:
        temporary.unlink(missing_ok=True)


def read(*files: Path | str) -> Samples:
    """Read samples from batches, or from the dataset of all.

    Raises
    ------
    InputError
        If a file is missing or damaged.
    """
    content = join([open_file(Path(file)) for file in files])
    arrays = {
        part: dict(zip(content[axis].values.tolist(), content[part].values, strict=True))
        for part, axis in (("value", "factor"), ("place", "factor"), ("measured", "column"))
    }
    design = content["design"].values.astype(str)
    return Samples(design, arrays["value"], arrays["place"], arrays["measured"])


def write_all(path: Path, files: Sequence[Path]) -> None:
    """Write the samples of all batches as one dataset."""
    write(
        path, join([open_file(file) for file in files]), "claims on samples of the open parameters"
    )


def join(contents: Sequence[xr.Dataset]) -> xr.Dataset:
    """Concatenate samples; a column that is missing in some of them is NaN there."""
    return xr.concat(contents, "sample", join="outer", coords="minimal", compat="override")


def open_file(path: Path) -> xr.Dataset:
    """Read a file into memory; raises InputError if it is missing or damaged."""
    try:
        with xr.open_dataset(path, engine="netcdf4") as content:
            # The stored length of texts would truncate longer ones that are concatenated to them.
            return content.load().drop_encoding()
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: missing or damaged ({error}); run make identify") from None
