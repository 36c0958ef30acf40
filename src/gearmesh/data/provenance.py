"""The source files, and the versions of the packages they use, that a result depends on.

`sources` follows the imports of a file through this package, so no list of files has to be kept by
hand. `code_digest` combines all code of a function in one digest; the pipeline runs a job again
when the digest changes.
"""

import ast
import hashlib
import json
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from gearmesh import __version__
from gearmesh.solvers import sources as solver_sources

PACKAGE = Path(__file__).parents[1]
_MAY_HOLD_IMPORTS = (ast.stmt, ast.ExceptHandler, ast.match_case)
_DISTRIBUTIONS = {"yaml": "PyYAML", "mpl_toolkits": "matplotlib"}
"""Distributions whose modules have another name."""


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
    return _followed(name for file in files for name in _imports(Path(file)))


def _followed(names: Iterable[str]) -> list[Path]:
    found: set[Path] = set()
    waiting = {file for name in names for file in _files(name)}
    while waiting:
        found |= waiting
        waiting = {new for file in waiting for new in _imported(file)} - found
    return sorted(found)


@cache
def _imported(file: Path) -> frozenset[Path]:
    return frozenset(found for name in _imports(file) for found in _files(name))


def module(name: str) -> Path:
    """Return the file of a module of this package, such as ``solvers/simulation``."""
    return PACKAGE / f"{name}.py"


def digest(files: Iterable[Path]) -> str:
    """Return the SHA-256 of the contents of files, in their order."""
    total = hashlib.sha256()
    for file in files:
        total.update(_file_digest(file))
    return total.hexdigest()


@cache
def _file_digest(file: Path) -> bytes:
    return hashlib.sha256(file.read_bytes()).digest()


def code_digest(file: Path, function: str, *others: Path, leaving_out: Iterable[Path] = ()) -> str:
    """Return the SHA-256 of all code that a function of a module is made of.

    These are its module without the other public functions, all that is imported there or in
    `others`, of this package by content and of other packages by version, and Python's version.

    Parameters
    ----------
    file : Path
        The module.
    function : str
        A public function in it.
    *others : Path
        Files that it uses, such as a notebook or a template.
    leaving_out : iterable of Path
        Modules that are imported but do not matter to this function.
    """
    code = _without_others(file, function)
    names = {*_imported_names(ast.parse(code), file)}
    names |= {name for other in others for name in _imports(other)}
    files = [found for found in _followed(names) if found not in {*leaving_out}]
    for found in files:
        names |= _imports(found)
    stated = [code, digest([*others, *files]), sys.version_info[:2], *_versions(names)]
    return hashlib.sha256(repr(stated).encode()).hexdigest()


def _without_others(file: Path, function: str) -> str:
    """Return a module without its public functions, all but one."""
    text = file.read_text(encoding="utf-8")
    lines = text.splitlines()
    for node in ast.parse(text).body:
        if not isinstance(node, ast.FunctionDef) or node.name == function:
            continue
        if not node.name.startswith("_"):
            first, last = node.lineno - 1, node.end_lineno or node.lineno
            lines[first:last] = [""] * (last - first)
    return "\n".join(lines)


def _versions(names: Iterable[str]) -> list[tuple[str, str]]:
    """Return the versions of the packages of others that are imported."""
    packages = {name.partition(".")[0] for name in names} - {PACKAGE.name, *sys.stdlib_module_names}
    return [(name, found) for name in sorted(packages) if (found := _version(name))]


@cache
def _version(package: str) -> str | None:
    try:
        return version(_DISTRIBUTIONS.get(package, package))
    except PackageNotFoundError:
        return None


@cache
def physics_digest() -> str:
    """Return the SHA-256 of all sources that decide what a run gives."""
    return solver_sources.digest()


@cache
def versions() -> dict[str, str]:
    """Return the versions of this package and of the libraries that decide the numbers."""
    return {"gearmesh": __version__} | {name: version(name) for name in solver_sources.LIBRARIES}


@cache
def _imports(file: Path) -> frozenset[str]:
    if file.suffix not in (".py", ".ipynb"):
        return frozenset()
    return frozenset(_imported_names(ast.parse(_code(file)), file))


def _code(file: Path) -> str:
    text = file.read_text(encoding="utf-8")
    if file.suffix != ".ipynb":
        return text
    cells = json.loads(text)["cells"]
    lines = "".join(f"{''.join(c['source'])}\n" for c in cells if c["cell_type"] == "code")
    return "".join(
        line for line in lines.splitlines(keepends=True) if not line.lstrip().startswith(("%", "!"))
    )


def _imported_names(node: ast.AST, file: Path) -> Iterator[str]:
    """Yield the dotted names that may be modules."""
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
        return
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        package = ".".join(filter(None, (_package(file, node.level), node.module)))
        if package != PACKAGE.name:
            yield package
        yield from (f"{package}.{alias.name}" for alias in node.names)
    for child in ast.iter_child_nodes(node):
        if isinstance(child, _MAY_HOLD_IMPORTS):
            yield from _imported_names(child, file)


def _package(file: Path, level: int) -> str:
    """Return the package that a relative import of some level starts from."""
    if not level:
        return ""
    folders = file.relative_to(PACKAGE.parent).parent.parts
    return ".".join(folders[: len(folders) - level + 1])


@cache
def _files(name: str) -> tuple[Path, ...]:
    """Return the file of a module, and the packages that importing it runs.

    The package itself offers names of all its modules, so code that uses one of them depends on
    all.
    """
    package, *parts = name.split(".")
    if package != PACKAGE.name or parts == ["__version__"]:
        return ()
    folders = (PACKAGE.joinpath(*parts[:depth]) for depth in range(1, len(parts)))
    packages = (folder / "__init__.py" for folder in folders)
    place = PACKAGE.joinpath(*parts)
    modules = (place.with_suffix(".py"), place / "__init__.py")
    found = [file for file in (*packages, *modules) if file.is_file()]
    return tuple(found) if found or len(parts) > 1 else tuple(PACKAGE.rglob("*.py"))
