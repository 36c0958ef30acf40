"""Sweeps up and down over the branches of orbits."""

import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import NOT_IN_STUDY, WIDTH, note, shade_regions, styled
from gearmesh.reproduction.figures.orbit import scale
from gearmesh.reproduction.mechanisms.figures.branches import STYLES, draw_lines, limit

PANELS = (
    ("b-material", "b □  linear damping"),
    ("b-lubricant", "b •  linear damping"),
    ("c-lubricant", "c •  quadratic damping"),
    ("d-lubricant", "d •  cubic damping"),
)
LOOKS = {
    "up": {"marker": "^", "ms": 2.4, "mew": 0, "color": palette.RED},
    "down": {"marker": "v", "ms": 2.4, "mew": 0, "color": palette.BLUE},
}


@styled
def draw(sweeps: xr.Dataset, branches: xr.Dataset) -> Figure:
    """Draw y_max and y_min of the sweeps, and the orbits behind them.

    Parameters
    ----------
    sweeps : xarray.Dataset
        ``y_max_rel`` and ``y_min_rel`` over (variant, direction, nu).
    branches : xarray.Dataset
        `branches.nc`.
    """
    figure = Figure(figsize=(WIDTH, 5.4), layout="constrained")
    grid = figure.subplots(2, 2, sharex=True)
    for axes, (name, title) in zip(grid.flat, PANELS, strict=True):
        axes.set_title(title)
        if name not in sweeps["variant"].values:
            note(axes, NOT_IN_STUDY)
            continue
        draw_lines(axes, branches, name, palette.PALE)
        for direction, look in LOOKS.items():
            found = sweeps.sel(variant=name, direction=direction)
            for y in ("y_max_rel", "y_min_rel"):
                axes.plot(found["nu"], found[y], ls="none", zorder=4, **look)
        limit(axes, scale(sweeps).backlash)
        shade_regions(axes, scale(sweeps).backlash)
    axes.set_xlim(float(sweeps["nu"].min()), float(sweeps["nu"].max()))
    for axes in grid[1]:
        axes.set_xlabel("mesh frequency $\\nu_s$")
    for axes in grid[:, 0]:
        axes.set_ylabel("$y_{\\max},\\ y_{\\min}$ in $y_{st}$")
    dwell = sweeps.attrs["dwell_revolutions"]
    marks = [
        Line2D([], [], ls="none", label=f"sweep {name}, {dwell} revolutions at each $\\nu_s$",
               **{**look, "ms": 4})
        for name, look in LOOKS.items()
    ]  # fmt: skip
    lines = [
        Line2D([], [], color=palette.PALE, label="stable orbit", **STYLES[1]),
        Line2D([], [], color=palette.PALE, label="unstable orbit", **STYLES[-1]),
        Line2D([], [], color=palette.GREY, label="neutral orbit", **STYLES[0]),
        Line2D([], [], color=palette.GREEN, label="orbit of period 2", **STYLES[1]),
        Line2D([], [], color=palette.VIOLET, label="orbit of period 3 to 12", **STYLES[1]),
    ]
    figure.legend(handles=[*marks, *lines], loc="outside lower center", ncols=3)
    return figure
