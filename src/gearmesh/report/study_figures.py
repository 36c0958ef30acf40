"""Figures of a study of one's own: response curves and a bifurcation diagram of each variant."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import WIDTH, shade_regions, styled
from gearmesh.reproduction.figures.orbit import scale

COLUMNS = 2
HEIGHT = 2.4
"""Height of a row of panels in inches."""


@styled
def draw_response(resonance: xr.Dataset) -> Figure:
    """Draw y_max and y_min of every variant over the mesh frequency.

    Parameters
    ----------
    resonance : xarray.Dataset
        ``y_max_rel`` and ``y_min_rel`` over (variant, nu).

    Returns
    -------
    Figure
        A panel for each letter of Tab. 1, with the colour and the marker of each variant.
    """
    letters = list(dict.fromkeys(resonance["letter"].values.tolist()))
    figure, panels = _panels(letters)
    for letter, axes in zip(letters, panels, strict=True):
        for name in resonance["variant"].values[resonance["letter"].values == letter]:
            curve = resonance.sel(variant=name)
            look = palette.LOOKS[str(curve["symbol"].item())]
            for extreme in ("y_max_rel", "y_min_rel"):
                axes.plot(
                    *(curve["nu"], curve[extreme]),
                    ls="none",
                    marker=".",
                    ms=2.4,
                    mew=0,
                    rasterized=True,
                    color=look.colour,
                    alpha=0.5 if curve["damping_factor"] != 1.0 else 1.0,
                    label=str(name) if extreme == "y_max_rel" else None,
                )
        axes.set_title(f"variants {letter}")
        axes.legend(loc="upper right", markerscale=3.0)
        _finish(axes, resonance)
    return figure


@styled
def draw_bifurcation(bifurcation: xr.Dataset) -> Figure:
    """Draw every local extremum of y of every variant over the mesh frequency.

    Parameters
    ----------
    bifurcation : xarray.Dataset
        ``extremum_y_rel`` over (variant, nu, extremum).

    Returns
    -------
    Figure
        A panel for each variant.
    """
    names = [str(name) for name in bifurcation["variant"].values]
    figure, panels = _panels(names)
    for name, axes in zip(names, panels, strict=True):
        curve = bifurcation.sel(variant=name)
        extrema = curve["extremum_y_rel"].values
        nu = np.broadcast_to(curve["nu"].values[:, None], extrema.shape)
        axes.plot(
            *(nu.ravel(), extrema.ravel()),
            ls="none",
            marker=".",
            ms=1.4,
            mew=0,
            rasterized=True,
            color=palette.LOOKS[str(curve["symbol"].item())].colour,
        )
        axes.set_title(name)
        _finish(axes, bifurcation)
    return figure


def _panels(titles: list[str]) -> tuple[Figure, list[Axes]]:
    columns = min(COLUMNS, len(titles))
    rows = -(-len(titles) // columns)
    figure = Figure(figsize=(WIDTH, HEIGHT * rows), layout="constrained")
    panels = list(figure.subplots(rows, columns, sharex=True, squeeze=False).flat)
    for axes in panels[len(titles) :]:
        axes.set_visible(False)
    figure.supxlabel("mesh frequency $\\nu_s$", fontsize="medium")
    figure.supylabel("$y$ in static deflections $y_{st}$", fontsize="medium")
    return figure, panels[: len(titles)]


def _finish(axes: Axes, dataset: xr.Dataset) -> None:
    nu = dataset["nu"].values
    if nu.size > 1:
        axes.set_xlim(nu.min(), nu.max())
    axes.margins(y=0.08)
    axes.autoscale_view()
    axes.set_ylim(*axes.get_ylim())
    shade_regions(axes, scale(dataset).backlash)
