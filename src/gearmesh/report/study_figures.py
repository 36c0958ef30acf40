"""Figures of a study of one's own: response curves and a bifurcation diagram of each variant."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import WIDTH, curve_handle, shade_regions, styled
from gearmesh.reproduction.figures.fig2 import plot_curve
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
        A panel for each letter of Tab. 1, with the symbols of Fig. 2. A variant with a multiple of
        the damping has the symbol of the variant itself.
    """
    letters = list(dict.fromkeys(resonance["letter"].values.tolist()))
    figure, panels = _panels(letters)
    for letter, axes in zip(letters, panels, strict=True):
        handles = {}
        for name in resonance["variant"].values[resonance["letter"].values == letter]:
            curve = resonance.sel(variant=name)
            kind = str(curve["symbol"].item())
            plot_curve(axes, curve, kind)
            handles[str(name)] = curve_handle(kind)
        axes.set_title(f"variants {letter}")
        axes.legend([*handles.values()], [*handles], loc="best")
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
