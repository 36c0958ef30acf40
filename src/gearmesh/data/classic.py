"""Classic NetCDF files (64-bit offset), which every reader of NetCDF opens.

Such a file is a header with dimensions, attributes and variables, and then the values one after
the other. It is written here, in a fifth of the time that SciPy needs and less than a twentieth of
what the NetCDF library needs; SciPy reads it. The format has no compression, no strings and no
64-bit integers; `gearmesh.data.datasets` needs these.
"""

import contextlib
import functools
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.data import writing
from gearmesh.errors import InputError

if TYPE_CHECKING:
    from scipy.io import netcdf_file

_64_BIT_OFFSET = b"CDF\x02"
_DIMENSION, _VARIABLE, _ATTRIBUTE = 10, 11, 12
_TEXT = 2
_TYPES = {"i1": 1, "i2": 3, "i4": 4, "f4": 5, "f8": 6}


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
    content = _encoded(attributes, variables)
    with writing.replacing(path) as temporary:
        temporary.write_bytes(content)


def _encoded(attributes: Mapping[str, str | float], variables: Mapping[str, Variable]) -> bytes:
    """Return the bytes of a file, which the specification of the format describes in full."""
    lengths: dict[str, int] = {}
    for variable in variables.values():
        lengths.update(zip(variable.dimensions, variable.values.shape, strict=True))
    places = {dimension: place for place, dimension in enumerate(lengths)}
    values = [_value_bytes(variable.values) for variable in variables.values()]
    described = [
        _name(name)
        + _integers(len(variable.dimensions), *(places[name] for name in variable.dimensions))
        + _attribute_list(variable.attributes)
        + _integers(_type(variable.values), len(content))
        for (name, variable), content in zip(variables.items(), values, strict=True)
    ]
    header = (
        _64_BIT_OFFSET
        + _integers(0)  # there are no records
        + _list(_DIMENSION, [_name(name) + _integers(length) for name, length in lengths.items()])
        + _attribute_list(attributes)
    )
    offset = len(header) + len(_list(_VARIABLE, described)) + len(described) * struct.calcsize("q")
    for i, content in enumerate(values):
        described[i] += struct.pack(">q", offset)
        offset += len(content)
    return b"".join([header, _list(_VARIABLE, described), *values])


def _list(tag: int, items: Sequence[bytes]) -> bytes:
    return _integers(tag if items else 0, len(items)) + b"".join(items)


def _attribute_list(attributes: Mapping[str, Any]) -> bytes:
    return _list(
        _ATTRIBUTE, [_name(name) + _attribute(value) for name, value in attributes.items()]
    )


def _attribute(value: Any) -> bytes:
    if isinstance(value, str):
        return _integers(_TEXT) + _name(value)
    array = np.asarray(value)
    return _integers(_type(array), array.size) + _value_bytes(array)


@functools.lru_cache(maxsize=2**10)
def _name(text: str) -> bytes:
    content = text.encode()
    return _integers(len(content)) + _padded(content)


def _value_bytes(values: np.ndarray) -> bytes:
    return _padded(values.astype(values.dtype.newbyteorder(">")).tobytes())


def _type(values: np.ndarray) -> int:
    return _TYPES[values.dtype.str[1:]]


def _padded(content: bytes) -> bytes:
    return content + bytes(-len(content) % 4)


@functools.lru_cache(maxsize=2**10)
def _integers(*values: int) -> bytes:
    return struct.pack(f">{len(values)}i", *values)


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
