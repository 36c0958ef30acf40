"""Execute notebooks with papermill.

The executed notebook is written even if a cell fails. Times and random identifiers are taken out
of it, so the same inputs give the same bytes. Everything that kernels read and leave behind is in
a folder of their own: they run in the interpreter of the pipeline whatever kernels are installed,
need no home folder, and do not get into each other's way.
"""

import json
import os
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

import nbformat
import papermill
from nbclient.exceptions import DeadKernelError
from papermill.engines import NBClientEngine, NotebookExecutionManager, papermill_engines
from papermill.exceptions import PapermillExecutionError
from traitlets.config import Config

from gearmesh.data.writing import replacing
from gearmesh.errors import InputError
from gearmesh.pipeline.messages import say

START_TIMEOUT = 60
"""Seconds that a kernel may take to start; it is long because many may start at once."""

ATTEMPTS = 3
"""Number of attempts to start a kernel; one fails if two kernels have taken the same port."""

KERNEL = "python3"

_KERNEL_SETTINGS = """\
from gearmesh.garbage import search_rarely
search_rarely()
c.IPKernelApp.log_level = 'CRITICAL'
"""

LONGEST = 90
"""Length of a folder in which sockets may be; a name of a socket has 104 characters at most."""


class _SavedAtTheEnd(NBClientEngine):  # type: ignore[misc]
    """Run a notebook and save it when it ends, however it ends.

    papermill would save it twice for each cell, with all pictures in it.
    """

    @classmethod
    def execute_managed_notebook(
        cls, nb_man: NotebookExecutionManager, *arguments: object, **settings: object
    ) -> None:
        path, nb_man.output_path = nb_man.output_path, None
        try:
            super().execute_managed_notebook(nb_man, *arguments, **settings)
        finally:
            nb_man.output_path = path


papermill_engines.register(_SavedAtTheEnd.__name__, _SavedAtTheEnd)


def run_notebook(
    notebook: Path, executed: Path, parameters: Mapping[str, Path | str], scratch: Path
) -> None:
    """Execute a notebook.

    Parameters
    ----------
    notebook : Path
        The notebook, without outputs.
    executed : Path
        Where its executed copy is written, also if it fails.
    parameters : mapping
        Values for its parameters; those that it does not have are left out.
    scratch : Path
        Folder for temporary files.

    Raises
    ------
    InputError
        If a cell fails, or the kernel dies.
    """
    declared = papermill.inspect_notebook(str(notebook))
    given = {name: str(value) for name, value in parameters.items() if name in declared}
    try:
        scratch.mkdir(parents=True, exist_ok=True)
        with (
            tempfile.TemporaryDirectory(dir=scratch, ignore_cleanup_errors=True) as private,
            tempfile.TemporaryDirectory(prefix="gearmesh-", ignore_cleanup_errors=True) as sockets,
        ):
            folder = Path(private).resolve()
            _prepare_kernel(folder)
            copy = folder / "executed.ipynb"
            try:
                _execute(notebook, copy, given, _local(sockets))
            except PapermillExecutionError as error:
                say(f"see the executed notebook, {executed}")
                reason = f"cell {error.cell_index}: {error.ename}: {error.evalue}"
                raise InputError(f"{notebook}: {reason}") from None
            except (DeadKernelError, RuntimeError) as error:
                raise InputError(f"{notebook}: {error}; run again") from None
            finally:
                if copy.exists():
                    _clean(copy, executed)
    except OSError as error:
        raise InputError(f"{scratch}: cannot be written: {error.strerror}") from None


def _local(folder: str) -> Config:
    """Return settings for sockets in a folder: they need neither a network nor free ports.

    The system limits the length of their names, so the folder is one of the system's temporary
    folders, whose names are short. Where it is not (TMPDIR may be long), kernels use the network.
    """
    if len(folder) > LONGEST:
        return Config()
    return Config(KernelManager={"transport": "ipc", "ip": f"{folder}/socket"})


def _execute(
    notebook: Path, executed: Path, parameters: Mapping[str, str], sockets: Config
) -> None:
    """Execute a notebook in a kernel that answers."""
    for attempt in range(1, ATTEMPTS + 1):
        try:
            papermill.execute_notebook(
                str(notebook),
                str(executed),
                parameters,
                engine_name=_SavedAtTheEnd.__name__,
                kernel_name=KERNEL,
                start_timeout=START_TIMEOUT,
                progress_bar=False,
                config=sockets,
            )
        except RuntimeError as error:
            silent = "respond" in str(error)
            if not silent or attempt == ATTEMPTS:
                raise
        else:
            return


def _prepare_kernel(folder: Path) -> None:
    """Describe the only kernel, and keep its own messages off the screen."""
    kernel = folder / "kernels" / KERNEL
    kernel.mkdir(parents=True)
    start = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    described = {"argv": start, "display_name": "Python 3 (ipykernel)", "language": "python"}
    (kernel / "kernel.json").write_text(json.dumps(described))
    profile = folder / "profile_default"
    profile.mkdir()
    (profile / "ipython_kernel_config.py").write_text(_KERNEL_SETTINGS)
    os.environ |= {
        "JUPYTER_PATH": str(folder),
        "JUPYTER_DATA_DIR": str(folder),
        "JUPYTER_CONFIG_DIR": str(folder),
        "JUPYTER_RUNTIME_DIR": str(folder / "runtime"),
        "JUPYTER_PLATFORM_DIRS": "1",
        "IPYTHONDIR": str(folder),
    }


def _clean(path: Path, executed: Path) -> None:
    """Write an executed notebook without what differs from run to run."""
    notebook = nbformat.read(path, as_version=4)
    notebook.metadata.pop("papermill", None)
    for number, cell in enumerate(notebook.cells):
        cell.metadata.pop("papermill", None)
        cell.metadata.pop("execution", None)
        cell.id = f"cell-{number}"
    with replacing(executed) as temporary:
        nbformat.write(notebook, temporary)
