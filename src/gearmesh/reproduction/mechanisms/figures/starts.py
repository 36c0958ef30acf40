"""Basins over (y, y') at three frequencies, and the share of starting phases that jump."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import WIDTH, V, styled
from gearmesh.reproduction.mechanisms.starts import IN_CONTACT, OTHER, RESONANT
from gearmesh.reproduction.mechanisms.tables import Row

COLOURS = {IN_CONTACT: "#cfe0ec", RESONANT: palette.RED, OTHER: palette.INK}
LABELS = {
    IN_CONTACT: "rings on, at most grazes",
    RESONANT: "resonant orbit with contact loss",
    OTHER: "another motion",
}
KINDS = {
    "flip": ("flip", (0, (1, 1.5))),
    "fold": ("fold", (0, (5, 2))),
    "grazing_front": ("grazing", "-"),
}


@styled
def draw(basins: xr.Dataset, phases: xr.Dataset, special: list[Row]) -> Figure:
    """Draw the basins above, the share of starting phases below.

    Parameters
    ----------
    basins, phases : xarray.Dataset
        See `gearmesh.reproduction.mechanisms.starts`.
    special : list of dict
        `special_points.json`.
    """
    figure = Figure(figsize=(WIDTH, 5.6), layout="constrained")
    upper, lower = np.ravel(figure.subfigures(2, 1, height_ratios=(1.25, 1.0)))
    row = upper.subplots(1, basins.sizes["nu"], sharey=True)
    for axes, nu in zip(row, basins["nu"].values, strict=True):
        _draw_basin(axes, basins.sel(nu=nu))
        axes.set_title(f"$\\nu_s={nu:g}$")
        axes.set_xlabel("initial $y$ in $y_{st}$")
    row[0].set_ylabel(f"initial {V} in $y_{{st}}$")
    patches = [Patch(facecolor=COLOURS[kind], label=label) for kind, label in LABELS.items()]
    start = Line2D([], [], ls="none", label="the study's start", **_START)
    upper.legend(handles=[*patches, start], loc="outside lower center", ncols=4)
    _draw_share(lower.subplots(), phases, special)
    lower.legend(loc="outside lower center", ncols=5)
    return figure


_START = {"marker": "+", "ms": 8, "mew": 1.4, "color": palette.INK}


def _draw_basin(axes: Axes, basin: xr.Dataset) -> None:
    colours = ListedColormap([COLOURS[kind] for kind in sorted(COLOURS)])
    y, v = basin["y_rel"].values, basin["v_rel"].values
    extent = y[0], y[-1], v[0], v[-1]
    axes.imshow(
        basin["reached"].values.T,
        cmap=colours,
        vmin=-0.5,
        vmax=2.5,
        extent=extent,
        origin="lower",
        interpolation="nearest",
        aspect="equal",
    )
    axes.plot(1.0, 0.0, ls="none", **_START)


def _draw_share(axes: Axes, phases: xr.Dataset, special: list[Row]) -> None:
    nu = phases["nu"].values
    looks = (
        {"color": palette.RED, "lw": 1.4},
        {"color": palette.INK, "lw": 0.9, "ls": (0, (4, 2))},
    )
    for (count, share), look in zip(phases["share"].groupby("revolutions"), looks, strict=True):
        label = f"after {count} revolutions"
        axes.plot(nu, 100.0 * np.ravel(share), label=label, zorder=3, **look)
    drawn = set()
    for one in special:
        if one["variant"] != "c-lubricant" or "parameters" in one or one["periods"] > 1:
            continue
        if one["kind"] in KINDS and nu[0] < one["nu"] < nu[-1]:
            name, style = KINDS[one["kind"]]
            label = "_" if name in drawn else f"{name} of an orbit"
            axes.axvline(one["nu"], color=palette.BLUE, lw=0.8, ls=style, label=label)
            drawn.add(name)
    axes.set_xlim(nu[0], nu[-1])
    axes.set_ylim(-3, 103)
    axes.set_xlabel("mesh frequency $\\nu_s$")
    axes.set_ylabel("starting phases with contact loss, %")
    axes.set_title("c •  what the study's start becomes at all starting phases")
