"""Fig. 3: bifurcation diagrams, all extrema of the fifth revolution against ν_s; Detail X."""

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import (
    NOT_IN_STUDY,
    WIDTH,
    micrometre_axis,
    note,
    region_handles,
    shade_regions,
    styled,
)
from gearmesh.reproduction.figures.orbit import present, scale
from gearmesh.reproduction.frequencies import LOOP_END

ROWS = (("lubricant", "•", palette.RED), ("material", "□", palette.BLUE))
COLUMNS = (("c", "quadratic damping"), ("d", "cubic damping"), ("h", "both together"))
MINIMA = palette.INK

DETAIL_X = (0.595, 0.665)
"""Range of ν_s in Detail X."""


@styled
def draw(bifurcation: xr.Dataset) -> Figure:
    """Draw every extremum of y in the kept revolution for c, d and h, lubricant and material.

    Parameters
    ----------
    bifurcation : xarray.Dataset
        ``extremum_y_rel`` and ``extremum_kind`` over (variant, nu, extremum).

    Returns
    -------
    Figure
        Two rows of three panels; Detail X of c-material is an inset.
    """
    figure = Figure(figsize=(WIDTH, 5.6), layout="constrained")
    grid = figure.subplots(2, 3, sharex=True, sharey="row")
    for row, (kind, symbol, colour) in zip(grid, ROWS, strict=True):
        for axes, (letter, title) in zip(row, COLUMNS, strict=True):
            axes.set_title(f"{letter} {symbol}  {title}")
        names = [f"{letter}-{kind}" for letter, _ in COLUMNS]
        _draw_row(row, bifurcation, names, colour)
        row[0].set_ylabel(f"extrema of $y$ in $y_{{st}}$   ({kind} damping)")
    nu = bifurcation["nu"].values
    grid[0, 0].set_xlim(nu.min(), nu.max())
    for axes in grid[1]:
        axes.set_xlabel("mesh frequency $\\nu_s$")
    if present(bifurcation, ["c-material"], "extremum_y_rel"):
        _add_detail(grid[1, 0], bifurcation.sel(variant="c-material"))
    inverse = any(axes.get_ylim()[0] < -scale(bifurcation).backlash for axes in grid[:, 0])
    figure.legend(handles=_handles(inverse), loc="outside lower center", ncols=5)
    return figure


def _draw_row(row: np.ndarray, bifurcation: xr.Dataset, names: list[str], colour: str) -> None:
    scales = scale(bifurcation)
    known = present(bifurcation, names, "extremum_y_rel")
    if known:
        row[0].set_ylim(*_limits(bifurcation["extremum_y_rel"].sel(variant=known)))
    for axes, name in zip(row, names, strict=True):
        if name not in known:
            note(axes, NOT_IN_STUDY)
            continue
        _plot_extrema(axes, bifurcation.sel(variant=name), colour)
        shade_regions(axes, scales.backlash)
        right = micrometre_axis(axes, scales.static_deflection, label=axes is row[-1])
        right.tick_params(labelright=axes is row[-1])


def _limits(extrema: xr.DataArray) -> tuple[float, float]:
    low, high = float(extrema.min()), float(extrema.max())
    margin = 0.06 * (high - low)
    return low - margin, high + margin


def _plot_extrema(axes: Axes, curve: xr.Dataset, colour: str, size: float = 1.7) -> None:
    """Draw maxima in `colour` and minima in ink, as pixels: there are tens of thousands."""
    nu, y = np.broadcast_arrays(curve["nu"].values[:, None], curve["extremum_y_rel"].values)
    kind = curve["extremum_kind"].values
    for which, tint in ((kind > 0, colour), (kind < 0, MINIMA)):
        axes.plot(
            nu[which], y[which], ls="none", marker=".", ms=size, mew=0, color=tint, rasterized=True
        )


def _add_detail(axes: Axes, curve: xr.Dataset) -> None:
    """Enlarge the branches that belong to the loops of the orbits."""
    near = curve.sel(nu=slice(*DETAIL_X))
    if near.sizes["nu"] < 2:
        return
    y = near["extremum_y_rel"]
    inner_low = float(y.where(near["extremum_kind"] > 0).min())
    low, high = min(inner_low, float(y.max()) - 0.5) - 0.1, float(y.max()) + 0.1
    inset = axes.inset_axes((0.36, 0.36, 0.58, 0.34))
    _plot_extrema(inset, near, palette.BLUE, size=3.2)
    inset.set(xlim=DETAIL_X, ylim=(low, high))
    inset.set_xticks([0.60, 0.62, 0.64, 0.66])
    inset.tick_params(labelsize=6.5, length=2)
    inset.set_title("Detail X", fontsize=7.5, pad=2)
    inset.axvline(LOOP_END, color=palette.GREY, lw=0.6, ls=(0, (4, 2)))
    inset.text(LOOP_END, low, " paper:\n 0.64", fontsize=6.5, va="bottom", color=palette.GREY)
    start, end = DETAIL_X
    axes.add_patch(
        Rectangle((start, low), end - start, high - low, fill=False, ec=palette.GREY, lw=0.6)
    )
    axes.text(end + 0.01, high, "X", fontsize=8, va="bottom", color=palette.GREY)


def _handles(inverse: bool) -> list[Artist]:
    dot = {"ls": "none", "marker": "o", "ms": 3.5, "mew": 0}
    return [
        Line2D([], [], color=palette.RED, label="maxima, •", **dot),
        Line2D([], [], color=palette.BLUE, label="maxima, □", **dot),
        Line2D([], [], color=MINIMA, label="minima", **dot),
        *region_handles(inverse),
    ]
