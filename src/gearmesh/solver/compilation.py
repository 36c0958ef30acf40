"""Compiled kernels that are kept on disk, and noticed when their sources change."""

import hashlib
from collections.abc import Callable
from functools import lru_cache, wraps
from pathlib import Path
from types import ModuleType


def persistent(build: Callable[[str, bool], Callable], *modules: ModuleType) -> Callable:
    """Return the function that `build` compiles, compiled at its first call and kept on disk.

    numba looks for changes only in the file of the function that it keeps, and not in those of
    the functions that this one calls.

    Parameters
    ----------
    build : callable
        ``build(sources, cache)`` returns a numba function, kept on disk if `cache` is true. The
        function must refer to `sources`: free variables are part of the key of numba's cache.
    *modules : module
        All modules with compiled code that the function calls.
    """

    @lru_cache
    def compiled(cache: bool) -> Callable:
        sources = hashlib.sha256(b"".join(_source(module) for module in modules)).hexdigest()
        try:
            return build(sources, cache)
        except RuntimeError:  # numba found no folder that it may write its cache to
            return build(sources, False)

    @wraps(build)
    def call(*arguments):
        try:
            return compiled(True)(*arguments)
        except OSError:  # the cache cannot be read or written: compile for this process alone
            return compiled(False)(*arguments)

    return call


def _source(module: ModuleType) -> bytes:
    return Path(module.__file__).read_bytes()
