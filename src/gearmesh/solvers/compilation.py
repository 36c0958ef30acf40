"""Compiled kernels that are kept on disk, and noticed when their sources change."""

import contextlib
import fcntl
import hashlib
from collections.abc import Callable, Iterator
from functools import lru_cache, partial, wraps
from pathlib import Path
from types import ModuleType

from numba import njit

inner = partial(njit, no_cpython_wrapper=True, no_cfunc_wrapper=True)
"""As `njit`, for functions that compiled code alone calls: a quarter less to compile."""


def persistent(build: Callable[[str, bool], Callable], *modules: ModuleType) -> Callable:
    """Return the function that `build` compiles, compiled at its first call and kept on disk.

    numba looks for changes only in the file of the function that it keeps, and not in those of
    the functions that this one calls. Nor does it keep processes that start together from doing
    the same work: here one compiles, and the others wait for what it keeps.

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
            kernel = compiled(True)
            if kernel.signatures:
                return kernel(*arguments)
            with _alone(kernel.stats.cache_path, build.__name__):
                return kernel(*arguments)
        except OSError:  # the cache cannot be read or written: compile for this process alone
            return compiled(False)(*arguments)

    return call


def _source(module: ModuleType) -> bytes:
    return Path(module.__file__).read_bytes()


@contextlib.contextmanager
def _alone(cache: str | None, name: str) -> Iterator[None]:
    """Let one process at a time go on; where nothing is kept, or no file can be locked, all."""
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError):
            if cache:
                lock = stack.enter_context((Path(cache) / f"{name}.lock").open("a"))
                fcntl.flock(lock, fcntl.LOCK_EX)
        yield
