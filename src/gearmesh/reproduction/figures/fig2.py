"""Fig. 2: response curves, the extremes of y in the fifth revolution against ν_s."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import (
    NOT_IN_STUDY,
    WIDTH,
    curve_handle,
    marker_look,
    micrometre_axis,
    note,
    region_handles,
    shade_regions,
    styled,
)
from gearmesh.reproduction.figures.orbit import present, scale

PANELS = (
    ("a + b", "conservative, and linear damping", ("a-conservative",), "b"),
    ("a + c", "conservative, and quadratic damping", ("a-conservative",), "c"),
    ("a + d", "conservative, and cubic damping", ("a-conservative",), "d"),
    ("h", "quadratic and cubic damping together", (), "h"),
)
DAMPED = ("material", "both", "lubricant")

LINEAR_TO = 4.0
"""Panels with the conservative curve have an ordinate that is linear up to here (in y_st) and
logarithmic beyond, because that curve extends five times farther than the others."""

SYMBOLS = {"material": 20, "both": 20, "conservative": 120}
"""Number of symbols along a curve. All frequencies have a dot. No line joins the points, so a jump
is visible as a gap."""


@styled
def draw(resonance: xr.Dataset) -> Figure:
    """Draw y_max and y_min of variants a, b, c, d and h.

    Parameters
    ----------
    resonance : xarray.Dataset
        ``y_max_rel`` and ``y_min_rel`` over (variant, nu).

    Returns
    -------
    Figure
        Four panels; left ordinates in static deflections, right ones in micrometres.
    """
    figure = Figure(figsize=(WIDTH, 6.6), layout="constrained")
    grid = figure.subplots(2, 2, sharex=True)
    scales = scale(resonance)
    for axes, (tag, title, undamped, letter) in zip(grid.flat, PANELS, strict=True):
        names = [*undamped, *(f"{letter}-{kind}" for kind in DAMPED)]
        axes.set_title(f"({tag})  {title}")
        names = present(resonance, names, "y_max_rel")
        if not names:
            note(axes, NOT_IN_STUDY)
            continue
        for name in names:
            plot_curve(axes, resonance.sel(variant=name), name.partition("-")[2])
        _set_ordinate(axes, resonance.sel(variant=names), bool(undamped))
        shade_regions(axes, scales.backlash)
        micrometre_axis(axes, scales.static_deflection, label=axes in grid[:, 1])
    nu = resonance["nu"].values
    for axes in grid[:, 0]:
        axes.set_ylabel("$y_{\\max},\\ y_{\\min}$  in static deflections $y_{st}$")
    for axes in grid[1]:
        axes.set_xlim(nu.min(), nu.max())
        axes.set_xlabel("mesh frequency $\\nu_s=\\omega_c/\\Omega_s$")
    curves = [curve_handle(name) for name in ("conservative", *DAMPED)]
    figure.legend(handles=curves, loc="outside upper center", ncols=4)
    figure.legend(handles=region_handles(), loc="outside lower center", ncols=3)
    return figure


def plot_curve(axes: Axes, curve: xr.Dataset, kind: str) -> None:
    """Plot y_max and y_min of one variant with the symbol of `kind`, such as ``lubricant``."""
    look = palette.LOOKS[kind]
    nu = curve["nu"].values
    step = max(1, nu.size // SYMBOLS.get(kind, nu.size))
    first = step // 2 if kind == "both" else 0  # between the symbols of the material curve
    for name in ("y_max_rel", "y_min_rel"):
        y = curve[name].values
        if step > 1:
            axes.plot(nu, y, ls="none", marker=".", ms=1.6, mew=0, color=look.colour, zorder=2)
        axes.plot(
            nu[first::step],
            y[first::step],
            ls="none",
            zorder=1.5 if kind == "conservative" else 3,
            clip_on=False,
            **marker_look(look),
        )


def _set_ordinate(axes: Axes, curves: xr.Dataset, wide: bool) -> None:
    low, high = float(curves["y_min_rel"].min()), float(curves["y_max_rel"].max())
    if wide:
        axes.set_yscale("symlog", linthresh=LINEAR_TO, linscale=1.6)
        reach = 1.25 * max(-low, high, 1.25 * LINEAR_TO)
        axes.set_ylim(-reach, reach)
        outer = [tick for tick in (10.0, 20.0, 50.0, 100.0) if tick < reach]
        inner = np.arange(-LINEAR_TO, LINEAR_TO + 1.0, 2.0)
        axes.set_yticks([*(-tick for tick in reversed(outer)), *inner, *outer])
        axes.yaxis.set_major_formatter(lambda tick, _: f"{tick:g}".replace("-", "−"))
        axes.minorticks_off()
    else:
        margin = 0.08 * (high - low)
        axes.set_ylim(low - margin, high + margin)
