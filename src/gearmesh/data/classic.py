"""Classic NetCDF files (64-bit offset), which every reader of NetCDF opens.

SciPy writes one in a fifth of the time that the NetCDF library needs, and in half the space. The
format has no compression, no strings and no 64-bit integers; `gearmesh.data.datasets` needs these.
"""

import contextlib
import io
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.data import writing
from gearmesh.errors import InputError

if TYPE_CHECKING:
    from scipy.io import netcdf_file

_64_BIT_OFFSET = 2


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable of a file.

    Attributes
    ----------
    values : ndarray
        Its values: floats, or integers of at most 32 bits.
    dimensions : tuple of str
        Names of its dimensions.
    attributes : mapping
        Strings and NumPy values.
    """

    values: np.ndarray
    dimensions: tuple[str, ...]
    attributes: Mapping[str, Any]


def write(
    path: Path, attributes: Mapping[str, str | float], variables: Mapping[str, Variable]
) -> None:
    """Write a file, whole or not at all; the same input gives the same bytes.

    Parameters
    ----------
    path : Path
        The file; its folder is made if it is missing.
    attributes : mapping
        Global attributes.
    variables : mapping of str to Variable
        The variables by their names.

    Raises
    ------
    InputError
        If it cannot be written; the message is one line with the reason.
    """
    from scipy.io import netcdf_file  # here, because few of the jobs need it

    content = io.BytesIO()
    file = netcdf_file(content, "w", version=_64_BIT_OFFSET)
    _state(file, attributes)
    for name, variable in variables.items():
        for dimension, size in zip(variable.dimensions, variable.values.shape, strict=True):
            if dimension not in file.dimensions:
                file.createDimension(dimension, size)
        created = file.createVariable(name, variable.values.dtype, variable.dimensions)
        created.data[...] = variable.values
        _state(created, variable.attributes)
    file.flush()
    with writing.replacing(path) as temporary, content.getbuffer() as whole:
        temporary.write_bytes(whole)
    content.close()  # or closing `file` would write everything once more


def _state(place: Any, attributes: Mapping[str, Any]) -> None:
    """Give attributes to a file or a variable; SciPy would make a float single."""
    for name, value in attributes.items():
        setattr(place, name, value.encode() if isinstance(value, str) else np.asarray(value))


@contextlib.contextmanager
def opened(path: Path | str) -> Iterator["netcdf_file"]:
    """Open a file and read it whole.

    Raises
    ------
    InputError
        If there is no such file, or it is not classic NetCDF.
    """
    from scipy.io import netcdf_file

    try:
        with netcdf_file(path, mmap=False) as file:
            yield file
    except (OSError, TypeError, ValueError, LookupError):
        raise InputError(f"{path}: missing or damaged; delete it and run again") from None


def refuse_damage(path: Path | str) -> None:
    """Read a classic file whole; a file of another format passes.

    The NetCDF library reads zeros beyond the end of a file that was cut off.

    Raises
    ------
    InputError
        If the file is cut off.
    OSError
        If there is no such file.
    """
    with Path(path).open("rb") as file:
        is_classic = file.read(3) == b"CDF"
    if is_classic:
        with opened(path):
            pass


def values(variable: Any) -> np.ndarray:
    """Return the values of a variable in the byte order of this machine."""
    return variable.data.astype(variable.data.dtype.newbyteorder("="))


def attributes(file: "netcdf_file") -> dict[str, Any]:
    """Return the global attributes of a file."""
    return {
        name: value.decode() if isinstance(value, bytes) else value
        for name, value in file._attributes.items()
    }
