"""Runs of Python, each in its own process, without a new import of Snakemake and other packages.

Importing them takes longer than planning a study, or than a run of one case. A server has imported
them, and nothing of gearmesh. Each run is a fork of that server with its own folder, environment
and process group. It imports gearmesh from the copied project.
"""

import contextlib
import multiprocessing
import os
import runpy
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from multiprocessing.forkserver import ensure_running
from pathlib import Path
from unittest.mock import patch

SERVER = multiprocessing.get_context("forkserver")
SERVER.set_forkserver_preload(
    [
        *("snakemake.cli", "snakemake.report.html_reporter", "snakemake.storage"),
        *("docutils.core", "jinja2", "pydantic", "requests", "scipy.io", "smart_open", "yte"),
        *("matplotlib.pyplot", "netCDF4", "numba", "pint", "scipy.optimize", "xarray"),
        "snakemake_ready",
    ]
)
PATIENCE = 280
"""Seconds after which a run hangs."""


class Run:
    """A run of Python.

    Parameters
    ----------
    folder : Path
        Where it runs.
    environment : mapping
        Its environment variables; `PYTHONPATH` is where its modules come from.
    arguments : sequence of str
        What stands behind `python`: `-m` and a module, or a file, and their arguments.
    """

    def __init__(
        self, folder: Path, environment: Mapping[str, str], arguments: Sequence[str]
    ) -> None:
        self._output = tempfile.NamedTemporaryFile("r", encoding="utf-8")  # noqa: SIM115
        with patch.dict(os.environ, PYTHONPATH=str(Path(__file__).parent), MPLBACKEND="Agg"):
            ensure_running()
        given = (folder, dict(environment), arguments, self._output.name)
        self._process = SERVER.Process(target=_python, args=given)
        self._process.start()

    def wait_for(self, condition: Callable[[], object]) -> object:
        """Wait until something is there, or the run is over; return what is there."""
        while self._process.is_alive():
            if found := condition():
                return found
            time.sleep(0.01)
        return condition()

    def send(self, how: signal.Signals, to_all: bool = True) -> None:
        """Send a signal to the run, and to all that it started; it may be over already."""
        send = os.killpg if to_all else os.kill
        with contextlib.suppress(ProcessLookupError):
            send(self._process.pid, how)

    def wait(self) -> subprocess.CompletedProcess[str]:
        """Wait for the end of the run, and return its status with what it printed."""
        self._process.join(PATIENCE)
        if self._process.exitcode is None:
            self.send(signal.SIGKILL)
            raise TimeoutError(self._output.read())
        return subprocess.CompletedProcess(
            self._process.name, self._process.exitcode, self._output.read()
        )


def _python(
    folder: Path, environment: Mapping[str, str], arguments: Sequence[str], output: str
) -> None:
    os.setsid()
    # What runs the tests in the background ignores SIGINT, and its children would too.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    printed = os.open(output, os.O_WRONLY | os.O_APPEND)
    for stream in (sys.stdout, sys.stderr):
        os.dup2(printed, stream.fileno())
    sys.path[:0] = [str(folder), *environment["PYTHONPATH"].split(os.pathsep)]
    sys.dont_write_bytecode = False  # the server has it from whoever runs the tests
    if arguments[0] == "-m":
        sys.argv = [*arguments[1:]]
        runpy.run_module(arguments[1], run_name="__main__")
    else:
        sys.argv = [*arguments]
        runpy.run_path(arguments[0], run_name="__main__")
