"""The file that ``--output`` names, checked before anything is computed or printed."""

import os
from collections.abc import Sequence
from pathlib import Path

from gearmesh.errors import InputError

NETCDF = (".nc",)
_STARTS = (b"CDF", b"\x89HDF")
"""First bytes of a NetCDF file."""


def check_output(path: Path, endings: Sequence[str] = NETCDF) -> str:
    """Refuse an output that could not be written after the run, or that would destroy other files.

    Parameters
    ----------
    path : Path
        The file that is to be written.
    endings : sequence of str
        The endings that its name may have.

    Returns
    -------
    str
        Remark about an earlier file that is replaced; empty if there is none.
    """
    folder = path.parent
    if os.path.isdir(path):
        raise InputError(f"--output: {path} is a folder; allowed is the name of a file")
    if path.suffix not in endings:
        allowed = ", ".join(endings)
        raise InputError(f"--output: found {path.name}; allowed is a name that ends in {allowed}")
    if not os.path.isdir(folder):
        raise InputError(f"--output: {path}: there is no folder {folder}")
    if not os.access(folder, os.W_OK):
        raise InputError(f"--output: {path}: the folder {folder} is not writable")
    try:
        path.lstat()
    except FileNotFoundError:
        return ""
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"--output: {path.name:.60}: cannot be written ({reason})") from None
    if endings == NETCDF:
        _check_is_netcdf(path)
    return " (replaced)"


def _check_is_netcdf(path: Path) -> None:
    try:
        with path.open("rb") as file:
            start = file.read(4)
    except FileNotFoundError:  # a link to nothing
        return
    except OSError as error:
        raise InputError(f"--output: {path}: cannot be read ({error.strerror})") from None
    if start and not start.startswith(_STARTS):
        raise InputError(f"--output: {path} exists and is no NetCDF file; choose another name")
