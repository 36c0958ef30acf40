"""Which sources decide what the solvers compute: one digest for every cache and result.

The digest covers every file of the packages `model` and `solvers`, and the versions of the
libraries that compile and run them, so no list of modules has to be kept.
"""

import hashlib
from functools import cache
from importlib.metadata import version
from pathlib import Path

PACKAGES = ("model", "solvers")
LIBRARIES = ("numba", "llvmlite", "numpy")
"""Libraries that decide the machine code, and the numbers."""


def files(root: Path) -> list[Path]:
    """Return the source files below `root`, the folder of this library, that decide the code."""
    return sorted(file for package in PACKAGES for file in (root / package).rglob("*.py"))


@cache
def digest(root: Path = Path(__file__).parents[1]) -> str:
    """Return the SHA-256 of the sources below `root` and of the versions of the libraries."""
    total = hashlib.sha256()
    for file in files(root):
        total.update(f"{file.relative_to(root).as_posix()}\0".encode())
        total.update(hashlib.sha256(file.read_bytes()).digest())
    for library in LIBRARIES:
        total.update(f"{library} {version(library)}\0".encode())
    return total.hexdigest()
