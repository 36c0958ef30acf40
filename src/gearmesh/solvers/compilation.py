"""Compiled kernels that are kept on disk, and compiled again when a source changes."""

import contextlib
from collections.abc import Callable, Iterator
from functools import lru_cache, partial, wraps
from pathlib import Path
from typing import Any

from numba import config, njit

from gearmesh.errors import InputError
from gearmesh.solvers import sources

try:
    import fcntl
except ImportError:  # Windows has no such locks
    fcntl = None  # type: ignore[assignment]

inner = partial(njit, no_cpython_wrapper=True, no_cfunc_wrapper=True)
"""As `njit`, for functions that compiled code alone calls: a quarter less to compile."""


def persistent(build: Callable[[str, bool], Any]) -> Callable[..., Any]:
    """Return the function that `build` compiles, compiled at its first call and kept on disk.

    numba checks only the file of the function that it caches for changes, not those of the
    functions that it calls; `gearmesh.solvers.sources` covers them all. Processes that start
    together would also all compile the same code. Here one compiles and the others wait for its
    result, if the system has file locks.

    Parameters
    ----------
    build : callable
        ``build(key, cache)`` returns a numba function, kept on disk if `cache` is true. The
        function must refer to `key`: free variables are part of the key of numba's cache.

    Raises
    ------
    InputError
        From the function that is returned, if numba's compiler is switched off.
    """

    @lru_cache
    def compiled(cache: bool) -> Any:
        if config.DISABLE_JIT:  # type: ignore[attr-defined]
            raise InputError(
                "NUMBA_DISABLE_JIT: found it set; allowed is unset or 0, because the solvers "
                "run as compiled code only"
            )
        key = sources.digest()
        try:
            return build(key, cache)
        except RuntimeError:  # numba found no folder that it may write its cache to
            return build(key, False)

    @wraps(build)
    def call(*arguments: object) -> object:
        try:
            kernel = compiled(True)
            if kernel.overloads:
                return kernel(*arguments)
            with _alone(kernel.stats.cache_path, build.__name__):
                return kernel(*arguments)
        except OSError:  # the cache cannot be read or written: compile for this process alone
            return compiled(False)(*arguments)

    return call


@contextlib.contextmanager
def _alone(cache: str | None, name: str) -> Iterator[None]:
    """Let one process at a time continue; all of them if there is no cache or no file lock."""
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError):
            if cache and fcntl:
                lock = stack.enter_context((Path(cache) / f"{name}.lock").open("a"))
                fcntl.flock(lock, fcntl.LOCK_EX)
        yield
