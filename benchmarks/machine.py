"""One core for everybody, and what the machine is.

Import this before NumPy and numba, which count the cores when they are imported.
"""

import importlib.metadata
import os
import platform
from pathlib import Path

ONE_THREAD = dict.fromkeys(("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
os.environ.update(ONE_THREAD)

_PACKAGES = ("gearmesh", "heyoka", "numba", "numbalsoda", "numpy", "scipy")


def keep_one_core() -> None:
    """Pin the process to one core, where the system can."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def described() -> dict[str, object]:
    """Describe the machine and the versions, without naming either."""
    model = platform.machine()
    cpus = Path("/proc/cpuinfo")
    if cpus.exists():
        lines = [line for line in cpus.read_text().splitlines() if line.startswith("model name")]
        model = lines[0].split(":")[1].strip() if lines else model
    versions = {}
    for package in _PACKAGES:
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            continue
    return {"processor": model, "python": platform.python_version(), "packages": versions}
