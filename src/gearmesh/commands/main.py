"""Read the command line and run the command that it names."""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from gearmesh import __version__
from gearmesh.errors import InputError
from gearmesh.garbage import search_rarely

BAD_INPUT = 2
INTERRUPTED = 130
OUT_OF_MEMORY = 1
_MOST_DIGITS = 18


class _Once(argparse.Action):
    """Store a value, and refuse a second one: argparse would drop the first without a word."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: object,
        option_string: str | None = None,
    ) -> None:
        given = namespace.__dict__.setdefault("given", set())
        if self.dest in given:
            raise InputError(f"{option_string}: found twice; allowed is once")
        given.add(self.dest)
        setattr(namespace, self.dest, values)


def _whole(text: str) -> int:
    if not text.isdecimal() or len(text) > _MOST_DIGITS:
        raise argparse.ArgumentTypeError(f"found '{text:.60}'; allowed is a whole number")
    return int(text)


class _Parser(argparse.ArgumentParser):
    """Parser that reports a wrong command line like all other bad input, and never guesses."""

    def __init__(self, **settings: object) -> None:
        super().__init__(allow_abbrev=False, **settings)  # type: ignore[arg-type]
        self.register("action", None, _Once)

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message} (see {self.prog} --help)")


def _check_options(parser: argparse.ArgumentParser, arguments: Sequence[str]) -> None:
    """Report unknown options by name, before argparse reports the intended option as missing."""
    known = {text for action in _actions(parser) for text in action.option_strings}
    for argument in arguments:
        option = argument.partition("=")[0]
        if option.startswith("--") and option not in (*known, "--"):
            from gearmesh.study.reading.schema import nearest

            raise InputError(f"{option}: unknown option{nearest(option, known)}")


def _actions(parser: argparse.ArgumentParser) -> list[argparse.Action]:
    """Return the actions of a parser and of its commands."""
    found = list(parser._actions)
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                found += _actions(command)
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit status, 2 for bad input."""
    search_rarely()
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # Greek letters on a terminal that has none
    try:
        arguments = sys.argv[1:] if arguments is None else arguments
        parser = _parser()
        _check_options(parser, arguments)
        options = parser.parse_args(arguments)
        status = options.run(options)
        sys.stdout.flush()
        return int(status)
    except InputError as error:
        print(f"gearmesh: error: {' '.join(str(error).split())}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print("gearmesh: interrupted", file=sys.stderr)
        return INTERRUPTED
    except MemoryError:
        print(
            "gearmesh: error: not enough memory; keep fewer revolutions or take fewer samples",
            file=sys.stderr,
        )
        return OUT_OF_MEMORY
    except BrokenPipeError:  # the reader of our output, such as `head`, has closed it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _parser() -> _Parser:
    parser = _Parser(
        prog="gearmesh", description="Nonlinear damping in the mesh of a spur gear pair."
    )
    parser.add_argument("--version", action="version", version=f"gearmesh {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=_Parser)
    pair = _pair_options()
    _add_runs(commands, pair)
    _add_orbits(commands, pair)
    _add_pictures(commands)
    _add_tables(commands, pair)
    return parser


def _pair_options() -> _Parser:
    """Return the options that choose the pair and replace its parameters."""
    options = _Parser(add_help=False)
    options.add_argument(
        "--config", metavar="FILE", type=Path, help="the study (default: the paper's)"
    )
    options.add_argument(
        "--set",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        dest="overrides",
        help="set a parameter, such as backlash='40 um'; may be repeated",
    )
    return options


def _add_runs(commands: "argparse._SubParsersAction[_Parser]", pair: _Parser) -> None:
    run = _Parser(add_help=False, parents=[_start_option()])
    run.add_argument("--revolutions", metavar="N", type=_whole, help="revolutions that are run")
    run.add_argument("--kept", metavar="N", type=_whole, help="last revolutions that are kept")
    run.add_argument(
        "-o", "--output", required=True, metavar="FILE.nc", type=Path, help="file to write"
    )

    simulate = commands.add_parser(
        "simulate", parents=[pair, run], help="integrate one run and write its time course"
    )
    simulate.add_argument("--variant", required=True, help="see 'gearmesh variants'")
    simulate.add_argument("--nu", required=True, help="mesh frequency nu_s, or '3000 rpm'")
    simulate.set_defaults(run=_simulate)

    sweep = commands.add_parser(
        "sweep", parents=[pair, run], help="integrate variants over mesh frequencies"
    )
    sweep.add_argument(
        "--variant",
        required=True,
        nargs="+",
        action="extend",
        help="one or several, see 'gearmesh variants'; may be repeated",
    )
    sweep.add_argument(
        "--nu", required=True, metavar="START:STOP:STEP", help="mesh frequencies nu_s, or speeds"
    )
    sweep.add_argument(
        "--direction",
        choices=("up", "down"),
        help="start each run from the end of the run before it",
    )
    sweep.add_argument(
        "--loads",
        action="store_true",
        help="measure tooth forces, dynamic factors, transmission errors and bearing forces, too",
    )
    sweep.set_defaults(run=_sweep)


def _start_option() -> _Parser:
    option = _Parser(add_help=False)
    option.add_argument(
        "--start",
        metavar=("Y", "V"),
        nargs=2,
        help="initial y and dy/dtau_s, such as '12 um' '0 um'; a bare number is in y_st",
    )
    return option


def _add_orbits(commands: "argparse._SubParsersAction[_Parser]", pair: _Parser) -> None:
    near = _Parser(add_help=False, parents=[_start_option()])
    near.add_argument("--variant", required=True, help="see 'gearmesh variants'")
    near.add_argument("--nu", required=True, help="mesh frequency nu_s, or '3000 rpm'")
    near.add_argument(
        "--periods",
        metavar="N",
        type=_whole,
        default=1,
        help="least period in mesh periods (default: 1)",
    )
    near.add_argument("-o", "--output", metavar="FILE.nc", type=Path, help="file to write")

    orbit = commands.add_parser(
        "orbit", parents=[pair, near], help="find a periodic orbit and its Floquet multipliers"
    )
    orbit.set_defaults(run=_orbit)

    branch = commands.add_parser(
        "branch", parents=[pair, near], help="follow an orbit and list the special points"
    )
    branch.add_argument(
        "--parameter", metavar="NAME", default="nu", help="what to vary (default: nu)"
    )
    branch.add_argument(
        "--range",
        metavar=("LOW", "HIGH"),
        nargs=2,
        required=True,
        help="its range, with units unless it is a plain number",
    )
    branch.set_defaults(run=_branch)


def _add_pictures(commands: "argparse._SubParsersAction[_Parser]") -> None:
    plot = commands.add_parser(
        "plot", help="draw phase plane, time course, tooth force and spectrum of a run"
    )
    plot.add_argument("case", metavar="FILE.nc", type=Path, help="a run with its time course")
    plot.add_argument(
        "-o",
        "--output",
        metavar="PICTURE",
        type=Path,
        help="PNG, SVG or PDF file (default: FILE.png)",
    )
    plot.set_defaults(run=_plot)

    compare = commands.add_parser(
        "compare", help="draw two runs on each other, and list their differences"
    )
    compare.add_argument("first", metavar="A.nc", type=Path)
    compare.add_argument("second", metavar="B.nc", type=Path)
    compare.add_argument(
        "-o",
        "--output",
        metavar="PICTURE",
        type=Path,
        help="PNG, SVG or PDF file (default: A-B.png)",
    )
    compare.set_defaults(run=_compare)


def _add_tables(commands: "argparse._SubParsersAction[_Parser]", pair: _Parser) -> None:
    variants = commands.add_parser("variants", help="list the damping variants of Tab. 1")
    variants.set_defaults(run=_variants)

    parameters = commands.add_parser(
        "parameters", parents=[pair], help="list every parameter with value, unit, kind and reason"
    )
    parameters.set_defaults(run=_parameters)

    geometry = commands.add_parser(
        "geometry", help="contact ratio and stiffness of steel wheels from their drawing"
    )
    geometry.add_argument("--module", required=True, help="such as '3 mm'")
    geometry.add_argument(
        "--teeth", required=True, nargs="+", metavar="Z", help="one number, or those of 3 and 2"
    )
    geometry.add_argument("--face-width", required=True, help="such as '20 mm'")
    geometry.add_argument("--pressure-angle", default="20 deg", help="(default: 20 deg)")
    geometry.add_argument(
        "--profile-shift",
        nargs="+",
        default=["0"],
        metavar="X",
        help="in modules: one for both wheels, or those of 3 and 2 (default: 0)",
    )
    geometry.add_argument("--centre-distance", help="(default: without backlash)")
    geometry.set_defaults(run=_geometry)


def _simulate(options: argparse.Namespace) -> int:
    from gearmesh.commands.runs import simulate

    return simulate(options)


def _sweep(options: argparse.Namespace) -> int:
    from gearmesh.commands.runs import sweep

    return sweep(options)


def _orbit(options: argparse.Namespace) -> int:
    from gearmesh.commands.orbits import orbit

    return orbit(options)


def _branch(options: argparse.Namespace) -> int:
    from gearmesh.commands.orbits import branch

    return branch(options)


def _plot(options: argparse.Namespace) -> int:
    from gearmesh.commands.pictures import plot

    return plot(options)


def _compare(options: argparse.Namespace) -> int:
    from gearmesh.commands.pictures import compare

    return compare(options)


def _variants(options: argparse.Namespace) -> int:
    from gearmesh.commands.tables import variants

    return variants(options)


def _geometry(options: argparse.Namespace) -> int:
    from gearmesh.commands.tables import geometry

    return geometry(options)


def _parameters(options: argparse.Namespace) -> int:
    from gearmesh.commands.tables import parameters

    return parameters(options)
