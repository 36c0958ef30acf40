"""Compiled code: processes that start together compile it once, and an edit is noticed."""

import math
import multiprocessing
import types

from numba import njit

from gearmesh.solvers.compilation import persistent

PROCESSES = 4


def build_square(kept):
    """Return a `build` that also hands the compiled function on, to be asked."""

    def build(sources, cache):
        @njit(cache=cache)
        def compiled(x):
            sources  # noqa: B018 (see persistent)
            return x * x

        kept.append(compiled)
        return compiled

    return build


def compile_and_count(together, folder, module_file, counts):
    """Compile when all processes are ready; tell how often this one found nothing on disk."""
    import numba

    numba.config.CACHE_DIR = str(folder)
    module = types.ModuleType("called")
    module.__file__ = str(module_file)
    kept = []
    square = persistent(build_square(kept), module)
    together.wait(timeout=60)
    assert math.isclose(square(3.0), 9.0)
    [kernel] = kept
    counts.put(sum(kernel.stats.cache_misses.values()))


def misses(folder, module_file, processes):
    """Start processes that compile the same; return how many compiled."""
    spawning = multiprocessing.get_context("spawn")
    together, counts = spawning.Barrier(processes), spawning.Queue()
    arguments = (together, folder, module_file, counts)
    started = [spawning.Process(target=compile_and_count, args=arguments) for _ in range(processes)]
    for process in started:
        process.start()
    found = [counts.get(timeout=120) for _ in started]
    for process in started:
        process.join()
    return sum(found)


def test_processes_that_start_together_compile_once(tmp_path):
    module = tmp_path / "called.py"
    module.write_text("one = 1\n")
    assert misses(tmp_path / "cache", module, PROCESSES) == 1


def test_kept_code_serves_until_a_called_module_changes(tmp_path):
    module = tmp_path / "called.py"
    module.write_text("one = 1\n")
    assert misses(tmp_path / "cache", module, 1) == 1
    assert misses(tmp_path / "cache", module, 1) == 0
    module.write_text("one = 2\n")
    assert misses(tmp_path / "cache", module, 1) == 1
