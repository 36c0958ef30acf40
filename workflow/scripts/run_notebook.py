"""Execute a notebook with papermill.

The executed notebook is written also when a cell fails. Times and random identifiers are taken out
of it, so the same inputs give the same bytes. Each run has an IPYTHONDIR of its own: kernels that
start at the same time would get into each other's way.
"""

import argparse
import os
import shutil
import sys
import tempfile
from pathlib import Path

import nbformat
import papermill
from nbclient.exceptions import DeadKernelError
from papermill.exceptions import PapermillExecutionError
from traitlets.config import Config

from gearmesh.job import job, tell

START_TIMEOUT = 300
"""Seconds that a kernel may take to start: many may start at once."""


def execute(notebook: Path, executed: Path, parameters: dict[str, str]) -> bool:
    """Execute a notebook; returns whether it came to its end."""
    declared = papermill.inspect_notebook(str(notebook))
    temporary = executed.with_name(f".{executed.stem}.{os.getpid()}.ipynb")
    temporary.parent.mkdir(parents=True, exist_ok=True)
    try:
        papermill.execute_notebook(
            str(notebook),
            str(temporary),
            {name: value for name, value in parameters.items() if name in declared},
            kernel_name="python3",
            start_timeout=START_TIMEOUT,
            progress_bar=False,
            # Sockets in a private folder: no ports that kernels could quarrel about.
            config=Config(KernelManager={"transport": "ipc"}),
        )
    except PapermillExecutionError as error:
        tell(f"error: {notebook}: cell {error.cell_index}: {error.ename}: {error.evalue}")
        tell(f"see the executed notebook, {executed}")
        return False
    except (DeadKernelError, RuntimeError) as error:
        tell(f"error: {notebook}: the kernel died: {error}; run again")
        return False
    finally:
        if temporary.exists():
            clean(temporary)
            temporary.replace(executed)
    return True


def clean(path: Path) -> None:
    """Take out of an executed notebook what differs from run to run."""
    notebook = nbformat.read(path, as_version=4)
    notebook.metadata.pop("papermill", None)
    for number, cell in enumerate(notebook.cells):
        cell.metadata.pop("papermill", None)
        cell.metadata.pop("execution", None)
        cell.id = f"cell-{number}"
    nbformat.write(notebook, path)


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("notebook", type=Path)
    parser.add_argument("executed", type=Path)
    parser.add_argument("parameters", nargs="*", metavar="NAME=VALUE")
    options = parser.parse_args()
    private = tempfile.mkdtemp(prefix="ipython-")
    os.environ["IPYTHONDIR"] = private
    try:
        with job("figures"):
            parameters = dict(item.split("=", 1) for item in options.parameters)
            if not execute(options.notebook, options.executed, parameters):
                sys.exit(1)
    finally:
        shutil.rmtree(private, ignore_errors=True)


if __name__ == "__main__":
    main()
