"""``gearmesh plot`` and ``gearmesh compare``."""

import argparse
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from gearmesh.commands.output import check_output
from gearmesh.commands.tables import print_table
from gearmesh.errors import InputError


def plot(options: argparse.Namespace) -> int:
    """Draw one run."""
    figures = _figures()
    run = figures.read_run(options.case)
    output = options.output or options.case.with_suffix(".png")
    replaces = check_output(output, figures.FORMATS)
    figures.save(figures.draw([run]), output)
    shown = "phase plane, stroboscopic points and time course"
    if figures.is_ramp(run):
        shown = "response over the speed"
    print(f"{output}{replaces}: {shown} of {_label(run)}")
    return 0


def compare(options: argparse.Namespace) -> int:
    """Draw two runs on each other and list what differs."""
    figures = _figures()
    runs = [figures.read_run(path) for path in (options.first, options.second)]
    output = options.output or Path(f"{options.first.stem}-{options.second.stem}.png")
    replaces = check_output(output, figures.FORMATS)
    for row in _parameter_rows(*runs):
        print(row)
    print_table(figures.differences(*runs))
    figures.save(figures.draw(runs), output)
    print(f"{output}{replaces}: both runs")
    return 0


def _figures() -> Any:
    """Import the figures, which need matplotlib."""
    if find_spec("matplotlib") is None:
        raise InputError("pictures need matplotlib: pip install 'gearmesh[study]'")
    from gearmesh.report import run_figures

    return run_figures


def _label(run: Any) -> str:
    return f"{run.attrs['variant']}, nu_s = {run.attrs['nu_s']:g}"


def _parameter_rows(first: Any, second: Any) -> list[str]:
    """List the variant, frequency and parameters in which two runs differ."""
    from gearmesh.report.run_names import differing

    found = differing(first, second)
    if not found:
        return ["A and B state the same run"]
    return [f"{name}: A {one}, B {other}" for name, (one, other) in found.items()]
