"""Files that come into being whole, or not at all."""

import contextlib
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

from gearmesh.errors import InputError

PARTIAL = ".part"
"""Ending of the names of files that are being written; these names begin with a dot."""

_LITTLE_SPACE = 2**20


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary file beside `path`, which takes its place when the context ends.

    If anything fails, the temporary file is removed and `path` stays as it was.

    Raises
    ------
    InputError
        If the file cannot be written; the message is one line with the reason.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}{PARTIAL}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        temporary.replace(path)
    except (OSError, RuntimeError) as error:  # netCDF4 reports a full disk as RuntimeError
        raise unwritable(path, error) from None
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink()


def remove_partial(folder: Path) -> None:
    """Remove the half-written files of killed processes below a folder."""
    for file in folder.rglob(f".*{PARTIAL}"):
        file.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text file."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def unwritable(path: Path, error: Exception) -> InputError:
    """Return the error with the reason, in one line, why a file cannot be written."""
    why = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    with contextlib.suppress(OSError):
        if shutil.disk_usage(path.parent).free < _LITTLE_SPACE:
            why = "the disk is full; free some space and run again"
    return InputError(f"{path}: cannot be written: {why}")
