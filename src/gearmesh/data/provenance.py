"""Which source files, and which versions of what they use, stand behind a result.

`sources` follows the imports of a file through this package. The pipeline takes what it returns
as inputs of the rule that runs the file, so an edit reruns what may depend on it, and no list of
files has to be kept by hand.
"""

import ast
import hashlib
import json
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.metadata import version
from pathlib import Path

import gearmesh
from gearmesh.solvers import sources as solver_sources

_PACKAGE = Path(gearmesh.__file__).parent
_MAY_HOLD_IMPORTS = (ast.stmt, ast.ExceptHandler, ast.match_case)


def sources(*files: Path | str) -> list[Path]:
    """Return the modules of this package that some files import, directly or not.

    Parameters
    ----------
    *files : Path or str
        Python files, or notebooks.

    Returns
    -------
    list of Path
        Sorted, without `files` themselves. Imports for type checking alone do not count.
    """
    found: set[Path] = set()
    waiting = [Path(file) for file in files]
    while waiting:
        new = _imported(waiting.pop()) - found
        found |= new
        waiting += new
    return sorted(found)


def module(name: str) -> Path:
    """Return the file of a module of this package, such as ``integrator``."""
    return _PACKAGE / f"{name}.py"


def digest(files: Iterable[Path]) -> str:
    """Return the SHA-256 of the contents of source files, in their order."""
    total = hashlib.sha256()
    for file in files:
        total.update(hashlib.sha256(file.read_bytes()).digest())
    return total.hexdigest()


@cache
def physics_digest() -> str:
    """Return the SHA-256 of all sources that decide what a run gives."""
    return solver_sources.digest()


@cache
def versions() -> dict[str, str]:
    """Return the versions of this package and of the libraries that decide the numbers."""
    return {"gearmesh": gearmesh.__version__} | {
        name: version(name) for name in solver_sources.LIBRARIES
    }


@cache
def _imported(file: Path) -> frozenset[Path]:
    return frozenset(
        found for name in _imported_names(ast.parse(_code(file))) for found in _files(name)
    )


def _code(file: Path) -> str:
    text = file.read_text(encoding="utf-8")
    if file.suffix != ".ipynb":
        return text
    cells = json.loads(text)["cells"]
    lines = "".join(f"{''.join(c['source'])}\n" for c in cells if c["cell_type"] == "code")
    return "".join(
        line for line in lines.splitlines(keepends=True) if not line.lstrip().startswith(("%", "!"))
    )


def _imported_names(node: ast.AST) -> Iterator[str]:
    """Yield the dotted names that may be modules of this package."""
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
        return
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom) and node.module:
        yield node.module
        yield from (f"{node.module}.{alias.name}" for alias in node.names)
    for child in ast.iter_child_nodes(node):
        if isinstance(child, _MAY_HOLD_IMPORTS):
            yield from _imported_names(child)


def _files(name: str) -> Iterator[Path]:
    """Yield the file of a module, and the packages that importing it runs."""
    package, *parts = name.split(".")
    if package != _PACKAGE.name:
        return
    place = _PACKAGE
    for part in parts:
        if (place / "__init__.py").is_file():
            yield place / "__init__.py"
        place /= part
    if place.with_suffix(".py").is_file():
        yield place.with_suffix(".py")
    elif (place / "__init__.py").is_file():
        yield place / "__init__.py"
