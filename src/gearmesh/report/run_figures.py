"""Figures of one run or of two runs together, for ``gearmesh plot`` and ``gearmesh compare``."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearmesh.data import classic
from gearmesh.data.writing import replacing
from gearmesh.errors import InputError
from gearmesh.interface.spectra import spectrum
from gearmesh.report.ramp_figures import draw_ramps, is_ramp
from gearmesh.report.run_names import suffixes
from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import STYLE, WIDTH, V, shade_regions, styled
from gearmesh.reproduction.figures.orbit import last_periods, scale, switches

PERIODS_SHOWN = 5
HIGHEST_ORDER = 6.0
FORMATS = (".png", ".svg", ".pdf")

_LOOKS = ((palette.BLUE, "-"), (palette.RED, "--"))


@styled
def draw(runs: Sequence[xr.Dataset]) -> Figure:
    """Draw runs: phase plane, time course and, where they are known, forces and spectrum.

    Parameters
    ----------
    runs : sequence of Dataset
        One or two case files with their time courses.

    Returns
    -------
    Figure
        Left: the phase plane of the kept revolution with its stroboscopic points. Right: y and
        C(t) over the last mesh periods. Below, if all runs hold the tooth force: its spectrum, and
        its time course. Speed ramps are drawn over the speed (`gearmesh.report.ramp_figures`).
    """
    if all(is_ramp(run) for run in runs):
        return draw_ramps(runs)
    loaded = all("force_normal" in run for run in runs)
    figure = Figure(figsize=(WIDTH, 6.4 if loaded else 3.6), layout="constrained")
    axes = figure.subplots(2 if loaded else 1, 2, width_ratios=(1.0, 1.4), squeeze=False)
    plane, times = axes[0]
    letters = ("",) if len(runs) == 1 else ("A: ", "B: ")
    endings = suffixes(runs)
    for run, letter, ending, (colour, line) in zip(runs, letters, endings, _LOOKS, strict=False):
        name = f"{letter}{run.attrs['variant']}, $\\nu_s$ = {run.attrs['nu_s']:g}{ending}"
        if loaded:
            name += f", $K_v$ = {float(run['dynamic_factor']):.3g}"
        _draw_plane(plane, run, colour, line)
        _draw_times(times, run, name, colour, line)
        if loaded:
            _draw_loads(axes[1, 0], axes[1, 1], run, colour, line)
    for each in (plane, times):  # shading the regions must not change the limits
        each.set(xlim=each.get_xlim(), ylim=each.get_ylim())
    backlash = scale(runs[0]).backlash
    shade_regions(plane, backlash, along="x")
    shade_regions(times, backlash)
    plane.set_title("phase plane and stroboscopic points")
    plane.set_xlabel("$y$ in $y_{st}$")
    plane.set_ylabel(f"{V} in $y_{{st}}$")
    times.set_title(f"last {PERIODS_SHOWN} mesh periods; $C(t)$ rises at ▲ (A), falls at ▼ (B)")
    times.set_xlabel("time $t/T$ in mesh periods")
    times.set_ylabel("$y$ in $y_{st}$")
    if loaded:
        _label_loads(axes[1, 0], axes[1, 1])
    figure.legend(*times.get_legend_handles_labels(), loc="outside upper center")
    return figure


def _draw_plane(axes: Axes, run: xr.Dataset, colour: str, line: str) -> None:
    axes.plot(run["y_rel"], run["v_rel"], color=colour, ls=line, lw=0.7)
    kept = scale(run).kept_periods + 1
    points = run["strobe_y_rel"].values[-kept:], run["strobe_v_rel"].values[-kept:]
    axes.plot(*points, ls="none", marker="o", ms=3.5, mec=colour, mfc="white", zorder=3)
    axes.margins(0.07)


def _draw_times(axes: Axes, run: xr.Dataset, name: str, colour: str, line: str) -> None:
    course = last_periods(run, min(PERIODS_SHOWN, scale(run).kept_periods))
    axes.plot(course["period"], course["y_rel"], color=colour, ls=line, label=name)
    for letter, where in zip("AB", switches(course), strict=True):
        places = course["period"].values[where]
        marker = "^" if letter == "A" else "v"
        axes.plot(places, course["y_rel"].values[where], ls="none", marker=marker, ms=3.5, c=colour)
    axes.margins(x=0.0, y=0.1)


def _draw_loads(orders: Axes, forces: Axes, run: xr.Dataset, colour: str, line: str) -> None:
    """Draw the spectrum of the tooth force, and its time course."""
    found = spectrum(run, "force_normal").sel(order=slice(0.0, HIGHEST_ORDER))
    orders.plot(found["order"][1:], found["force_normal"][1:], color=colour, ls=line, lw=0.8)
    course = last_periods(run, min(PERIODS_SHOWN, scale(run).kept_periods))
    forces.plot(course["period"], course["force_normal"], color=colour, ls=line)
    forces.margins(x=0.0, y=0.1)


def _label_loads(orders: Axes, forces: Axes) -> None:
    orders.set_title("spectrum of the tooth force")
    orders.set_xlabel("order of the mesh frequency")
    orders.set_ylabel("amplitude in N")
    orders.set(yscale="log", xlim=(0.0, HIGHEST_ORDER + 0.2))
    low, high = orders.get_ylim()
    orders.set_ylim(max(low, high * 1e-6), high)
    forces.set_title("tooth force: elastic and damping force")
    forces.set_xlabel("time $t/T$ in mesh periods")
    forces.set_ylabel("tooth force in N")
    forces.axhline(0.0, color="0.6", lw=0.6)


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format that its name ends in, one of `FORMATS`."""
    with replacing(path) as temporary, style.context(["default", STYLE]):
        figure.savefig(temporary, format=path.suffix[1:])


def read_run(path: Path) -> xr.Dataset:
    """Read a case file that has a time course.

    Raises
    ------
    InputError
        If it is no such file.
    """
    try:
        classic.refuse_damage(path)
        with xr.open_dataset(path) as file:
            run = file.load()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except ValueError:
        raise InputError(f"{path}: cannot be read: not a NetCDF file") from None
    if "parameters" not in run.attrs or "strobe_y_rel" not in run:
        raise InputError(f"{path}: not a run of gearmesh; 'gearmesh simulate' writes one")
    if not run["strobe_y_rel"].ndim:
        raise InputError(f"{path}: an orbit, which is no run; 'gearmesh simulate' writes one")
    if "y_rel" not in run or not run["y_rel"].size:
        raise InputError(f"{path}: a run without its time course; 'gearmesh simulate' writes one")
    return run.set_coords("time")


def differences(first: xr.Dataset, second: xr.Dataset) -> list[tuple[str, str, str, str]]:
    """List the scalars of two runs and how far they differ, in rows of text.

    Returns
    -------
    list of tuple
        Name, both values and the relative difference.
    """
    rows = [("quantity", "A", "B", "(B − A)/A")]
    for name, variable in first.data_vars.items():
        if variable.ndim or name not in second or str(name).endswith("_rel"):
            continue
        if variable.dtype.kind not in "fiu":
            continue
        one, other = float(variable), float(second[name])
        difference = (other - one) / one if one else np.nan
        unit = variable.attrs.get("units", "1")
        label = str(name) if unit == "1" else f"{name} in {unit}"
        shown = "0" if one == other else f"{difference:.1e}" if np.isfinite(difference) else "–"
        rows.append((label, f"{one:.6g}", f"{other:.6g}", shown))
    return rows
