"""Compiled code: processes that start together compile it once, and an edit is noticed."""

import errno
import math
import multiprocessing
import os
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from numba import njit

import gearmesh
from gearmesh.data import provenance
from gearmesh.solvers import compilation, sources
from gearmesh.solvers.compilation import persistent

PROCESSES = 2
PACKAGE = Path(gearmesh.__file__).parent


def build_square(kept):
    """Return a `build` that also hands the compiled function on, to be asked."""

    def build(key, cache):
        @njit(cache=cache)
        def compiled(x):
            key  # noqa: B018 (see persistent)
            return x * x

        kept.append(compiled)
        return compiled

    return build


def compile_and_count(together, folder, key, counts):
    """Compile when all processes are ready; return how often this one found nothing on disk."""
    import numba

    numba.config.CACHE_DIR = str(folder)
    sources.digest = lambda: key
    kept = []
    square = persistent(build_square(kept))
    together.wait(timeout=60)
    assert math.isclose(square(3.0), 9.0)
    [kernel] = kept
    counts.put(sum(kernel.stats.cache_misses.values()))


def misses(folder, key, processes):
    """Start processes that compile the same; return how many compiled."""
    spawning = multiprocessing.get_context("spawn")
    together, counts = spawning.Barrier(processes), spawning.Queue()
    arguments = (together, folder, key, counts)
    started = [spawning.Process(target=compile_and_count, args=arguments) for _ in range(processes)]
    for process in started:
        process.start()
    found = [counts.get(timeout=120) for _ in started]
    for process in started:
        process.join()
    return sum(found)


@pytest.mark.skipif(compilation.fcntl is None, reason="this system has no file locks")
def test_processes_that_start_together_compile_once_and_the_code_is_kept(tmp_path, monkeypatch):
    assert misses(tmp_path, "one", PROCESSES) == 1
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))
    for key, expected in (("one", 0), ("two", 1), ("two", 0)):
        monkeypatch.setattr(sources, "digest", lambda key=key: key)
        kept = []
        assert persistent(build_square(kept))(3.0) == pytest.approx(9.0)
        assert sum(kept[0].stats.cache_misses.values()) == expected


BUILD = """
from numba import njit
def build(key, cache):
    @njit(cache=cache)
    def compiled(x):
        key
        return x * x
    return compiled
"""


def test_code_compiles_where_no_folder_can_hold_it(tmp_path, monkeypatch):
    """Neither the folder of the source nor the one of the user."""
    for name in ("__pycache__", "numba"):
        (tmp_path / name).write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (tmp_path / "square.py").write_text(BUILD)
    build = runpy.run_path(str(tmp_path / "square.py"))["build"]
    with pytest.raises(RuntimeError, match="no locator"):
        build("one", True)
    assert persistent(build)(3.0) == pytest.approx(9.0)


@pytest.fixture
def copied(tmp_path):
    """Return a copy of the library's sources."""
    return shutil.copytree(
        PACKAGE, tmp_path / "gearmesh", ignore=shutil.ignore_patterns("__pycache__")
    )


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("solvers/compilation.py", "partial(njit,", "partial(njit, fastmath=True,"),
        ("model/contact.py", "y >= 0.0", "y > 0.0"),
        ("solvers/lanes/types.py", "fadd", "fsub"),
        ("solvers/limits.py", "2.0", "3.0"),
    ],
)
def test_every_source_of_the_code_is_part_of_the_key(copied, name, old, new):
    before = sources.digest(copied)
    assert before == sources.digest()
    text = (copied / name).read_text(encoding="utf-8")
    assert old in text
    (copied / name).write_text(text.replace(old, new, 1), encoding="utf-8")
    sources.digest.cache_clear()
    assert sources.digest(copied) != before


def test_a_new_source_is_part_of_the_key(copied):
    before = sources.digest(copied)
    (copied / "solvers" / "new.py").write_text("", encoding="utf-8")
    sources.digest.cache_clear()
    assert sources.digest(copied) != before


@pytest.mark.parametrize("library", ["numba", "llvmlite", "numpy"])
def test_the_libraries_that_compile_are_part_of_the_key(library, monkeypatch):
    before = sources.digest()
    real = sources.version
    monkeypatch.setattr(sources, "version", lambda name: "0" if name == library else real(name))
    sources.digest.cache_clear()
    assert sources.digest() != before
    sources.digest.cache_clear()


def test_results_and_compiled_code_have_the_same_digest():
    assert provenance.physics_digest() == sources.digest()


def refuse(*arguments):
    raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))


@pytest.mark.parametrize("missing", [True, False], ids=["no locks", "locks refused"])
def test_code_compiles_without_locks(missing, monkeypatch, tmp_path):
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))
    if missing:
        monkeypatch.setattr(compilation, "fcntl", None)
    else:
        fake = type("fcntl", (), {"flock": staticmethod(refuse), "LOCK_EX": 2})
        monkeypatch.setattr(compilation, "fcntl", fake)
    assert persistent(build_square([]))(3.0) == pytest.approx(9.0)


def run(script, **environment):
    return subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_library_imports_where_the_system_has_no_fcntl():
    script = "import sys; sys.modules['fcntl'] = None; import gearmesh.solvers.simulation"
    finished = run(script)
    assert finished.returncode == 0, finished.stderr


SWITCHED_OFF = """
from gearmesh.errors import InputError
from gearmesh.model.variants import variant
from gearmesh.solvers.simulation import simulate
from problems import problem
try:
    simulate([problem()])
except InputError as error:
    print(error)
"""


def test_numba_without_its_compiler_is_refused_in_one_line():
    finished = run(
        f"import sys; sys.path.insert(0, {str(Path(__file__).parents[1])!r}){SWITCHED_OFF}",
        NUMBA_DISABLE_JIT="1",
    )
    assert finished.stdout.startswith("NUMBA_DISABLE_JIT: found it set; allowed is")
    assert finished.stdout.count("\n") == 1
    assert finished.returncode == 0, finished.stderr
