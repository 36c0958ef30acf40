"""Changed code, put in place in a process."""

import gc
import importlib.abc
import importlib.util
import inspect
import sys
from collections.abc import Iterable
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

Name = tuple[str, str, int]
"""File, qualified name and first line of a function."""

Functions = dict[Name, list[FunctionType]]


def functions(files: Iterable[Path]) -> Functions:
    """Return the functions of some files that exist in this process."""
    names = {str(file) for file in files}
    found: Functions = {}
    for one in gc.get_objects():
        if isinstance(one, FunctionType) and one.__code__.co_filename in names:
            found.setdefault(_name(one.__code__), []).append(one)
    return found


def swaps(
    before: CodeType, after: CodeType, known: Functions
) -> list[tuple[list[FunctionType], CodeType]] | None:
    """Return which functions take which code, so that a module changes.

    None if what an import runs changes, or if the functions cannot take the code.
    """
    changed = _changed(before, after)
    if changed is None:
        return None
    if any(_name(old) not in known or old.co_freevars != new.co_freevars for old, new in changed):
        return None
    return [(known[_name(old)], new) for old, new in changed]


def _changed(before: CodeType, after: CodeType) -> list[tuple[CodeType, CodeType]] | None:
    """Return the outermost functions that differ, before and after; None if other code does."""
    if before == after:
        return []
    if before.co_flags & inspect.CO_NEWLOCALS:  # a function, neither a module nor a class
        return [(before, after)]
    if _without_inner(before) != _without_inner(after):
        return None
    found = []
    for old, new in zip(_inner(before), _inner(after), strict=True):
        inner = _changed(old, new)
        if inner is None:
            return None
        found += inner
    return found


def _name(code: CodeType) -> Name:
    return code.co_filename, code.co_qualname, code.co_firstlineno


def _inner(code: CodeType) -> list[CodeType]:
    return [part for part in code.co_consts if isinstance(part, CodeType)]


def _without_inner(code: CodeType) -> CodeType:
    constants = (None if isinstance(part, CodeType) else part for part in code.co_consts)
    return code.replace(co_consts=tuple(constants))


class ChangedModule(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports one module with other code.

    Parameters
    ----------
    source : Path
        The folder of the package.
    file : Path
        The module.
    code : CodeType
        What runs in its place.
    """

    def __init__(self, source: Path, file: Path, code: CodeType) -> None:
        parts = file.relative_to(source).with_suffix("").parts
        self._package = parts[-1] == "__init__"
        self._module = ".".join(parts[:-1] if self._package else parts)
        self._file, self._code = file, code

    def install(self) -> None:
        """Use it for all imports from now on."""
        sys.meta_path.insert(0, self)

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
        """Return how the module is imported."""
        if name != self._module:
            return None
        places = [str(self._file.parent)] if self._package else None
        return importlib.util.spec_from_file_location(
            name, self._file, loader=self, submodule_search_locations=places
        )

    def create_module(self, spec: Any) -> None:
        """Leave that to Python."""

    def exec_module(self, module: ModuleType) -> None:
        """Run the changed code."""
        exec(self._code, module.__dict__)
