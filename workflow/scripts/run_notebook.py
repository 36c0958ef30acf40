"""Execute a notebook with papermill.

The executed notebook is written also when a cell fails. Times and random identifiers are taken out
of it, so the same inputs give the same bytes. Each run has an IPYTHONDIR of its own: kernels that
start at the same time would get into each other's way.
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path

import nbformat
import papermill
from nbclient.exceptions import DeadKernelError
from papermill.exceptions import PapermillExecutionError

from gearmesh.pipeline.job import job, tell

START_TIMEOUT = 60
"""Seconds that a kernel may take to start: many may start at once."""

ATTEMPTS = 3
"""How often a kernel that does not answer is started: two may have taken the same port."""


def execute(notebook: Path, executed: Path, parameters: dict[str, str]) -> bool:
    """Execute a notebook; returns whether it came to its end."""
    declared = papermill.inspect_notebook(str(notebook))
    parameters = {name: value for name, value in parameters.items() if name in declared}
    temporary = executed.with_name(f".{executed.stem}.{os.getpid()}.ipynb")
    temporary.parent.mkdir(parents=True, exist_ok=True)
    try:
        start(notebook, temporary, parameters)
    except PapermillExecutionError as error:
        tell(f"error: {notebook}: cell {error.cell_index}: {error.ename}: {error.evalue}")
        tell(f"see the executed notebook, {executed}")
        return False
    except (DeadKernelError, RuntimeError) as error:
        tell(f"error: {notebook}: {error}; run again")
        return False
    finally:
        if temporary.exists():
            clean(temporary)
            temporary.replace(executed)
    return True


def start(notebook: Path, executed: Path, parameters: dict[str, str]) -> None:
    """Execute a notebook in a kernel that answers."""
    for attempt in range(1, ATTEMPTS + 1):
        try:
            papermill.execute_notebook(
                str(notebook),
                str(executed),
                parameters,
                kernel_name="python3",
                start_timeout=START_TIMEOUT,
                progress_bar=False,
            )
        except RuntimeError as error:
            silent = "respond" in str(error)
            if not silent or attempt == ATTEMPTS:
                raise
        else:
            return


def silence_kernels(ipython_folder: Path) -> None:
    """Keep what kernels say of themselves, such as that they are told to end, off the screen."""
    profile = ipython_folder / "profile_default"
    profile.mkdir()
    (profile / "ipython_kernel_config.py").write_text("c.IPKernelApp.log_level = 'CRITICAL'\n")


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
    with tempfile.TemporaryDirectory(prefix="ipython-", ignore_cleanup_errors=True) as private:
        os.environ["IPYTHONDIR"] = private
        silence_kernels(Path(private))
        with job("figures"):
            parameters = dict(item.split("=", 1) for item in options.parameters)
            if "figure" in parameters:  # notebooks write a PNG and an SVG of one name
                parameters["figure"] = parameters["figure"].removesuffix(".png")
            if not execute(options.notebook, options.executed, parameters):
                sys.exit(1)


if __name__ == "__main__":
    main()
