"""``gearmesh simulate`` and ``gearmesh sweep``."""

import argparse
from collections.abc import Sequence

from gearmesh.commands.output import check_output
from gearmesh.commands.tables import load_pair
from gearmesh.data.writing import replacing
from gearmesh.errors import InputError
from gearmesh.model.variants import variant
from gearmesh.study.frequencies import Frequencies
from gearmesh.study.pair import Pair
from gearmesh.study.reading.schema import validate
from gearmesh.study.speeds import as_nu, read_nu_or_speed

NOT_INTEGRATED = 1


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
    for name in options.variant:
        if options.variant.count(name) > 1:
            raise InputError(f"--variant: found {name} twice; allowed is once")
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
        revolutions=options.revolutions,
        kept_revolutions=options.kept,
    )


def read_start(texts: Sequence[str] | None) -> tuple[object, object] | None:
    """Read an initial condition: two quantities, or numbers of static deflections."""
    if texts is None:
        return None
    displacement, velocity = (_number_or_text(text) for text in texts)
    return displacement, velocity


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
