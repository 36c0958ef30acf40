"""``gearmesh simulate`` and ``gearmesh sweep``."""

import argparse
import os
from collections.abc import Sequence
from pathlib import Path

from gearmesh.commands.tables import load_pair
from gearmesh.data.writing import replacing
from gearmesh.errors import InputError
from gearmesh.model.variants import variant
from gearmesh.study.frequencies import Frequencies
from gearmesh.study.pair import Pair
from gearmesh.study.reading.schema import validate
from gearmesh.study.speeds import as_nu, read_nu_or_speed

NOT_INTEGRATED = 1
_NETCDF = (b"CDF", b"\x89HDF")


def simulate(options: argparse.Namespace) -> int:
    """Integrate one run and write it with its time course."""
    chosen = variant(options.variant)
    pair = _pair(options)
    nu = read_frequency(options.nu, pair)
    replaces = check_output(options.output)

    from gearmesh.data import casefile
    from gearmesh.solvers.simulation import simulate as integrate
    from gearmesh.study.cases import Case

    case = Case(chosen, nu, time_course=True)
    problem = pair.problem(chosen, nu)
    [response] = integrate([problem], pair.tolerance, pair.samples_per_period)
    columns = casefile.record(response, pair, problem)
    casefile.write_case(options.output, casefile.attributes(pair, case), columns)
    if response.status != "ok":
        print(f"gearmesh: {options.output}: not integrated: {response.status}")
        return NOT_INTEGRATED
    y_st = pair.static_deflection
    print(
        f"{options.output}{replaces}: {chosen.name} at nu_s = {nu:g}, "
        f"y from {response.y_min * y_st:.6g} to {response.y_max * y_st:.6g} mm"
    )
    low, high, factor, error = (
        float(columns[name])
        for name in ("force_min", "force_max", "dynamic_factor", "transmission_error_range")
    )
    print(
        f"tooth force from {low:.6g} to {high:.6g} N, K_v = {factor:.4g}, "
        f"transmission error {error:.4g} mm peak to peak"
    )
    if response.sensitive:
        error = max(response.y_max_error, response.y_min_error) * y_st
        print(
            f"sensitive: this motion amplifies small errors; the estimated error of y_max "
            f"and y_min is {error:.1g} mm"
        )
    return 0


def sweep(options: argparse.Namespace) -> int:
    """Integrate variants over mesh frequencies and write one dataset."""
    chosen = [variant(name) for name in options.variant]
    pair = _pair(options)
    nus = _frequencies(options.nu, pair)
    replaces = check_output(options.output)

    from gearmesh.interface.runs import sweep as integrate

    found = integrate(pair, chosen, nus, direction=options.direction, loads=options.loads)
    with replacing(options.output) as temporary:
        found.to_netcdf(temporary, engine="netcdf4")
    failed = int((found["status"] != 0).sum())
    sensitive = int((found["sensitive"] == 1).sum())
    print(
        f"{options.output}{replaces}: {found['status'].size} runs, {failed} not integrated, "
        f"{sensitive} sensitive"
    )
    return NOT_INTEGRATED if failed else 0


def _pair(options: argparse.Namespace) -> Pair:
    """Return the pair with the settings of the run."""
    from gearmesh.interface.statements import with_settings

    return with_settings(
        load_pair(options),
        read_start(options.start),
        revolutions=_whole("--revolutions", options.revolutions),
        kept_revolutions=_whole("--kept", options.kept),
    )


def read_start(texts: Sequence[str] | None) -> tuple[object, object] | None:
    """Read an initial condition: two quantities, or numbers of static deflections."""
    if texts is None:
        return None
    displacement, velocity = (_number_or_text(text) for text in texts)
    return displacement, velocity


def _whole(option: str, text: str | None) -> int | None:
    if text is None:
        return None
    if not text.isdecimal():
        raise InputError(f"{option}: found '{text}'; allowed is a whole number")
    return int(text)


def _number_or_text(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def read_frequency(text: str, pair: Pair) -> float:
    """Read a mesh frequency, or a speed, from the command line."""
    try:
        return read_nu_or_speed(text, pair)
    except ValueError as error:
        raise InputError(f"--nu: found '{text}': {error}") from None


def _frequencies(text: str, pair: Pair) -> list[float]:
    """Read ``START:STOP:STEP``, or one frequency."""
    parts = text.split(":")
    if len(parts) == 1:
        return [read_frequency(text, pair)]
    if len(parts) != 3:
        raise InputError(f"--nu: found '{text}'; allowed is START:STOP:STEP, or one number")
    stated = as_nu(dict(zip(("start", "stop", "step"), parts, strict=True)), pair, "--nu")
    return list(validate(Frequencies, stated, "--nu", {}).all)


def check_output(path: Path) -> str:
    """Refuse an output that could not be written after the run, or that would destroy other files.

    Returns
    -------
    str
        Remark about an earlier run that is replaced; empty if there is none.
    """
    folder = path.parent
    if path.is_dir():
        raise InputError(f"--output: {path} is a folder; allowed is the name of a file")
    if path.suffix != ".nc":
        raise InputError(
            f"--output: found {path.name}; the file is NetCDF, so its name ends in .nc"
        )
    if not folder.is_dir():
        raise InputError(f"--output: {path}: there is no folder {folder}")
    if not os.access(folder, os.W_OK):
        raise InputError(f"--output: {path}: the folder {folder} is not writable")
    if not path.exists():
        return ""
    with path.open("rb") as file:
        start = file.read(4)
    if start and not start.startswith(_NETCDF):
        raise InputError(f"--output: {path} exists and is no NetCDF file; choose another name")
    return " (replaced)"
