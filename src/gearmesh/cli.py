"""The ``gearmesh`` command: one case outside the pipeline, Tab. 1, and all parameters.

Modules that take long to import are imported where they are needed.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from gearmesh import __version__
from gearmesh.data import paths
from gearmesh.errors import InputError

BAD_INPUT = 2
NOT_INTEGRATED = 1
INTERRUPTED = 130


class _Parser(argparse.ArgumentParser):
    """Parser that tells a wrong command line like all other bad input."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message} (see {self.prog} --help)")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit status, 2 for bad input."""
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="replace")  # Greek letters on a terminal that has none
    try:
        options = _parser().parse_args(arguments)
        status = options.run(options)
        sys.stdout.flush()
        return status
    except InputError as error:
        print(f"gearmesh: error: {' '.join(str(error).split())}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print("gearmesh: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # the reader of our output has left, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _parser() -> _Parser:
    parser = _Parser(
        prog="gearmesh", description="Nonlinear damping in the mesh of a spur gear pair."
    )
    parser.add_argument("--version", action="version", version=f"gearmesh {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=_Parser)

    study = _Parser(add_help=False)
    study.add_argument(
        "--config", metavar="FILE", type=Path, help=f"the study (default: {paths.PAPER})"
    )
    study.add_argument(
        "--set",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        dest="overrides",
        help="set a parameter, such as assumed.backlash='40 um'; may be repeated",
    )

    simulate = commands.add_parser(
        "simulate", parents=[study], help="run one case and write it with its time course"
    )
    simulate.add_argument("--variant", required=True, help="see 'gearmesh variants'")
    simulate.add_argument("--nu", required=True, help="tuning nu_s of the mesh frequency")
    simulate.add_argument(
        "-o", "--output", required=True, metavar="FILE.nc", type=Path, help="file to write"
    )
    simulate.set_defaults(run=_simulate)

    variants = commands.add_parser("variants", help="list the damping variants of Tab. 1")
    variants.set_defaults(run=_variants)

    parameters = commands.add_parser(
        "parameters", parents=[study], help="list every parameter with value, unit and kind"
    )
    parameters.set_defaults(run=_parameters)
    return parser


def _load(options: argparse.Namespace):
    from gearmesh.study.loading import load_study

    path = options.config or paths.PAPER
    if options.config is None and not path.exists():
        raise InputError(f"--config: none given, and no {path} here; name the study's file")
    return load_study(path, options.overrides)


def _simulate(options: argparse.Namespace) -> int:
    from gearmesh.model.damping import variant
    from gearmesh.study.cases import Case
    from gearmesh.study.frequencies import read_nu

    try:
        nu = read_nu(options.nu)
    except ValueError as error:
        raise InputError(f"--nu: found '{options.nu}': {error}") from None
    case = Case(variant(options.variant), nu, time_course=True)
    parameters = _load(options).parameters
    _check_output(options.output)

    from gearmesh.data import casefile
    from gearmesh.solvers.simulation import simulate

    [response] = simulate(
        [parameters.problem(case.variant, case.nu)],
        parameters.tolerance,
        parameters.samples_per_period,
    )
    casefile.write_case(
        options.output,
        casefile.attributes(parameters, case),
        casefile.record(response, parameters),
    )
    if response.status != "ok":
        print(f"gearmesh: {options.output}: not integrated: {response.status}", file=sys.stderr)
        return NOT_INTEGRATED
    deflection = parameters.static_deflection
    print(
        f"{options.output}: {case.variant.name} at nu_s = {case.nu:g}, "
        f"y from {response.y_min * deflection:.6g} to {response.y_max * deflection:.6g} mm"
    )
    return 0


def _check_output(path: Path) -> None:
    """Refuse, before the run, an output that cannot be written after it."""
    folder = path.parent
    if path.is_dir():
        raise InputError(f"--output: {path} is a folder; allowed is the name of a file")
    if not folder.is_dir():
        raise InputError(f"--output: {path}: there is no folder {folder}")
    if not os.access(folder, os.W_OK):
        raise InputError(f"--output: {path}: the folder {folder} is not writable")


def _variants(options: argparse.Namespace) -> int:
    from gearmesh.model.damping import VARIANTS

    head = ("name", "mark", "k1", "k2", "k3", "k1m", "k2m", "k3m", "damping")
    rows = [
        (
            variant.name,
            variant.marker,
            *("×" if acts else "0" for acts in variant.material_powers),
            *("×" if acts else "0" for acts in variant.lubricant_powers),
            variant.description,
        )
        for variant in VARIANTS.values()
    ]
    _print_table([head, *rows])
    print("\n'-5x' behind a name multiplies its damping, here by 5.")
    return 0


def _parameters(options: argparse.Namespace) -> int:
    from gearmesh.study.pair import DERIVATIONS, KINDS, rows

    study = _load(options)
    table = [("parameter", "symbol", "value", "unit", "kind", "meaning, or reason")]
    for section, kind in KINDS.items():
        for row in rows(section):
            value = getattr(getattr(study, section), row.name)
            reason = study.reasons[row.name] if kind == "assumed" else row.description
            key = f"{section}.{row.name}"
            table.append((key, row.symbol, _text(value), row.unit, kind, reason))
    for item in DERIVATIONS:
        value = _text(item.value(study.pair))
        table.append((item.name, item.symbol, value, item.unit, "derived", item.formula))
    _print_table(table)
    return 0


def _text(value: object) -> str:
    return f"{value:.10g}" if isinstance(value, int | float) else str([list(v) for v in value])


def _print_table(rows: Sequence[Sequence[str]]) -> None:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        print("  ".join(cells).rstrip())
