"""The design map: what the mesh does over (ν_s, D), for □, × and •."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import WIDTH, styled
from gearmesh.reproduction.mechanisms.figures.curves import DASHES, NAMES

COLOURS = (palette.NORMAL_MESH, palette.CONTACT_LOSS, palette.INVERSE_MESH)
LABELS = ("no contact loss", "contact loss", "back-flank contact")
EDGES = ("grazing_front", "fold", "flip")
"""Special points at which the state of the mesh changes."""

PAPER = (0, (1, 1))
"""Dots, because grazings are dashed."""

TITLES = {"material": "□  material", "both": "×  both", "lubricant": "•  lubricant"}


@styled
def draw(design_map: xr.Dataset, special_curves: xr.Dataset, damping_ratio: float) -> Figure:
    """Draw a panel for each place of the damping.

    Parameters
    ----------
    design_map : xarray.Dataset
        ``state`` and ``several`` over (place, damping_ratio, nu).
    special_curves : xarray.Dataset
        Curves of special points; those of c-□ and c-• are drawn.
    damping_ratio : float
        D of the paper, drawn as a line.
    """
    figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
    row = figure.subplots(1, design_map.sizes["place"], sharey=True)
    nu, ratio = design_map["nu"].values, design_map["damping_ratio"].values
    for axes, place in zip(row, design_map["place"].values, strict=True):
        axes.pcolormesh(
            nu,
            ratio,
            design_map["state"].sel(place=place).values,
            cmap=ListedColormap(COLOURS),
            vmin=-0.5,
            vmax=2.5,
            shading="nearest",
            rasterized=True,
        )
        axes.contourf(
            nu,
            ratio,
            design_map["several"].sel(place=place).values,
            levels=(0.5, 1.5),
            colors="none",
            hatches=("////",),
        )
        _draw_exact(axes, special_curves, f"c-{place}")
        axes.axhline(damping_ratio, color=palette.BLUE, lw=1.1, ls=PAPER)
        axes.set_yscale("log")
        axes.set_ylim(ratio[0], ratio[-1])
        axes.set_xlim(nu[0], nu[-1])
        axes.set_title(f"c {TITLES[str(place)]}")
        axes.set_xlabel("mesh frequency $\\nu_s$")
    row[0].set_ylabel("damping ratio $D$")
    row[0].annotate(
        "paper", (nu[-1], damping_ratio), xytext=(-3, 3), textcoords="offset points", ha="right",
        fontsize=8, color=palette.BLUE,
    )  # fmt: skip
    edge = {"edgecolor": palette.GREY, "lw": 0.5}
    handles = [
        Patch(facecolor=colour, label=label, **edge)
        for colour, label in zip(COLOURS, LABELS, strict=True)
    ]
    handles.append(Patch(facecolor="none", hatch="////", label="sweeps up and down differ", **edge))
    lines = [
        Line2D([], [], color=palette.INK, ls=DASHES[kind], label=f"{NAMES[kind]} of an orbit")
        for kind in EDGES
    ]
    lines.append(Line2D([], [], color=palette.BLUE, lw=1.1, ls=PAPER, label="$D$ of the paper"))
    figure.legend(handles=[*handles, *lines], loc="outside lower center", ncols=4)
    return figure


def _draw_exact(axes: Axes, special_curves: xr.Dataset, name: str) -> None:
    """Draw the curves over (ν_s, D) of a variant."""
    own = (special_curves["variant"] == name) & (special_curves["parameter"] == "damping")
    own &= special_curves["kind"].isin(EDGES) & (special_curves["cusp"] == 0)
    chosen = special_curves.isel(point=np.flatnonzero(own))
    for number in np.unique(chosen["curve"]):
        curve = chosen.isel(point=np.flatnonzero(chosen["curve"] == number))
        dashes = DASHES[str(curve["kind"].values[0])]
        axes.plot(curve["nu"], curve["damping_ratio"], color=palette.INK, lw=0.9, ls=dashes)
