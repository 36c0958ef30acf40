"""Manifests: the SHA-256 of all files that a job wrote and read.

The first line of a manifest holds digests of everything else that the job was made of. Then come
the files, relative to the folder of the study, as ``sha256sum -c`` reads them::

    # made of 5e0c…
    8e7f…  batches/c.nc
    41aa…  cases/c-material/nu-0.6600.nc
    # read
    …

While its manifest holds, a job need not run again: the times of files do not matter. When it runs
again, the manifest shows which files are still as they were written.
"""

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from gearmesh.data.writing import write_text

_MADE_OF, _READ = "# made of ", "# read"


@dataclass(frozen=True)
class Manifest:
    """What a job was made of, and what it wrote and read.

    Attributes
    ----------
    made_of : str
        Digest of everything besides files of results.
    written, read : dict of str to str
        File, relative to the folder of the study -> SHA-256.
    """

    made_of: str
    written: dict[str, str] = field(default_factory=dict)
    read: dict[str, str] = field(default_factory=dict)


class Hashes:
    """The SHA-256 of files below a folder; each file is read once.

    Parameters
    ----------
    folder : Path
        The folder.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._known: dict[str, str | None] = {}

    def of(self, names: Iterable[str]) -> dict[str, str | None]:
        """Return the hash of each file, None for one that cannot be read."""
        for name in (names := list(names)):
            if name not in self._known:
                self._known[name] = self._hash(name)
        return {name: self._known[name] for name in names}

    def _hash(self, name: str) -> str | None:
        try:
            return hashlib.sha256((self._folder / name).read_bytes()).hexdigest()
        except OSError:
            return None


def write(
    path: Path, folder: Path, made_of: str, written: Iterable[Path], read: Iterable[Path]
) -> None:
    """Write the manifest of a job.

    Parameters
    ----------
    path : Path
        The manifest.
    folder : Path
        Folder of the study.
    made_of : str
        Digest of everything besides files of results.
    written, read : iterable of Path
        Files below `folder`.
    """
    hashes = Hashes(folder)
    sections = [
        hashes.of(sorted(file.relative_to(folder).as_posix() for file in files))
        for files in (written, read)
    ]
    lines = [f"{_MADE_OF}{made_of}"]
    for heading, section in zip(([], [_READ]), sections, strict=True):
        lines += heading * bool(section)
        lines += [f"{digest}  {name}" for name, digest in section.items()]
    write_text(path, "\n".join(lines) + "\n")


def read(path: Path) -> Manifest | None:
    """Read a manifest; None if it is missing or is not one."""
    try:
        first, *lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return None
    if not first.startswith(_MADE_OF):
        return None
    found = Manifest(first.removeprefix(_MADE_OF))
    section = found.written
    for line in lines:
        if line == _READ:
            section = found.read
            continue
        digest, _, name = line.partition("  ")
        section[name] = digest
    return found
