"""``gearmesh orbit`` and ``gearmesh branch``."""

import argparse
from pathlib import Path

import numpy as np
import xarray as xr

from gearmesh.commands.output import check_output
from gearmesh.commands.runs import read_frequency, read_start
from gearmesh.commands.tables import load_pair, print_table
from gearmesh.data.writing import replacing
from gearmesh.errors import NoOrbit
from gearmesh.interface.branches import follow
from gearmesh.interface.orbits import Orbit, find_orbit
from gearmesh.model.variants import variant

NO_ORBIT = 1


def orbit(options: argparse.Namespace) -> int:
    """Find a periodic orbit and print its Floquet multipliers."""
    replaces = check_output(options.output) if options.output else ""
    try:
        found = _find(options)
    except NoOrbit as error:
        print(f"gearmesh: {error}")
        return NO_ORBIT
    heights = found.to_dataset()
    print(
        f"{found.variant.name} at nu_s = {found.nu:.10g}: period {found.periods}, "
        f"{_stability(found)}, y from {float(heights.y_min):.6g} to {float(heights.y_max):.6g} mm"
    )
    print(f"regimes: {', '.join(found.signature).replace('_', ' ')}")
    rows = [("multiplier", "modulus", "argument in deg")]
    for value in found.multipliers:
        angle = f"{np.degrees(np.angle(value)):.4f}"
        rows.append((f"{value.real:+.10f} {value.imag:+.10f}i", f"{abs(value):.10f}", angle))
    print_table(rows)
    if options.output:
        _write(heights, options.output)
        print(f"{options.output}{replaces}: the orbit with its time course")
    return 0


def branch(options: argparse.Namespace) -> int:
    """Follow an orbit and print the special points of its branch."""
    replaces = check_output(options.output) if options.output else ""
    try:
        found = follow(_find(options), options.parameter, tuple(options.range))
    except NoOrbit as error:
        print(f"gearmesh: {error}")
        return NO_ORBIT
    dataset = found.to_dataset()
    print(f"{dataset.sizes['point']} orbits; the ends: {', '.join(found.ends)}")
    rows = [("special point", options.parameter, "y_max/y_st", "period")]
    for point in found.special:
        there = point.orbit.found
        value = point.parameters[options.parameter]
        rows.append((point.kind, f"{value:.10f}", f"{there.y_max:.8f}", f"{there.periods}"))
    print_table(rows)
    if options.output:
        _write(dataset, options.output)
        print(f"{options.output}{replaces}: the branch")
    return 0


def _find(options: argparse.Namespace) -> Orbit:
    pair = load_pair(options)
    return find_orbit(
        pair,
        variant(options.variant),
        read_frequency(options.nu, pair),
        periods=options.periods,
        start=read_start(options.start),
    )


def _stability(found: Orbit) -> str:
    if found.neutral:
        return "neutral (no damping acts)"
    return "stable" if found.stable else "unstable"


def _write(dataset: xr.Dataset, path: Path) -> None:
    """Write a dataset; NetCDF has no complex numbers, so multipliers are written in two parts."""
    values = dataset["multipliers"]
    parts = {
        f"multipliers_{part}": (values.dims, getattr(values.values, part), values.attrs)
        for part in ("real", "imag")
    }
    with replacing(path) as temporary:
        dataset.drop_vars("multipliers").assign(parts).to_netcdf(temporary, engine="netcdf4")
