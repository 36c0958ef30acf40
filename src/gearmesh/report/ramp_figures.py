"""Figures of runs whose speed changes, for ``gearmesh plot`` and ``gearmesh compare``."""

import json
from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearmesh.report.run_names import suffixes
from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import WIDTH, shade_regions, styled
from gearmesh.reproduction.figures.orbit import scale

HIGHEST_ORDER = 6.0
_LOOKS = ((palette.BLUE, "-"), (palette.RED, "--"))
_DYNAMIC_RANGE = 1e-4


def is_ramp(run: xr.Dataset) -> bool:
    """Return whether the speed changes in a run."""
    return "period_nu" in run


@styled
def draw_ramps(runs: Sequence[xr.Dataset]) -> Figure:
    """Draw one or two speed ramps over the mesh frequency.

    Parameters
    ----------
    runs : sequence of Dataset
        Case files of speed ramps.

    Returns
    -------
    Figure
        Above: greatest and least y in each mesh period. Below, for a single run of several
        revolutions that holds the tooth force: its amplitudes over speed and order.
    """
    mapped = len(runs) == 1 and "force_normal" in runs[0] and _revolutions(runs[0]) > 1
    figure = Figure(figsize=(WIDTH, 6.4 if mapped else 3.6), layout="constrained")
    axes = figure.subplots(2 if mapped else 1, 1, squeeze=False, sharex=True)[:, 0]
    letters = ("",) if len(runs) == 1 else ("A: ", "B: ")
    endings = suffixes(runs)
    for run, letter, ending, (colour, line) in zip(runs, letters, endings, _LOOKS, strict=False):
        first, last = run["strobe_nu"].values[[0, -1]]
        name = f"{letter}{run.attrs['variant']}, $\\nu_s$ from {first:g} to {last:g}{ending}"
        for extreme, label in (("period_y_max_rel", name), ("period_y_min_rel", None)):
            axes[0].plot(run["period_nu"], run[extreme], color=colour, ls=line, lw=0.9, label=label)
    response = axes[0]
    response.set(ylim=response.get_ylim())  # shading the regions must not change the limits
    shade_regions(response, scale(runs[0]).backlash)
    response.margins(x=0.0)
    response.set_title("greatest and least $y$ in each mesh period")
    response.set_ylabel("$y$ in $y_{st}$")
    if mapped:
        _draw_orders(figure, axes[1], runs[0])
    axes[-1].set_xlabel("mesh frequency $\\nu_s$")
    figure.legend(*response.get_legend_handles_labels(), loc="outside upper center")
    return figure


def _revolutions(run: xr.Dataset) -> int:
    """Return how many revolutions of wheel 3 a run keeps."""
    return int(json.loads(run.attrs["parameters"])["kept_revolutions"])


def _draw_orders(figure: Figure, axes: Axes, run: xr.Dataset) -> None:
    """Draw the amplitudes of the tooth force over orders, revolution by revolution."""
    revolutions = _revolutions(run)
    force = run["force_normal"].values.reshape(revolutions, -1)
    amplitudes = 2.0 * np.abs(np.fft.rfft(force)) / force.shape[1]
    order = np.arange(amplitudes.shape[1]) * (revolutions / run.sizes["period"])
    shown = (order > 0.0) & (order <= HIGHEST_ORDER)
    nu = run["period_nu"].values.reshape(revolutions, -1).mean(axis=1)
    level = np.log10(np.maximum(amplitudes[:, shown], _DYNAMIC_RANGE * amplitudes.max()))
    picture = axes.pcolormesh(nu, order[shown], level.T, shading="nearest", cmap="viridis")
    figure.colorbar(picture, ax=axes, label="$\\log_{10}$ of the amplitude in N")
    axes.set_title("spectrum of the tooth force in each revolution")
    axes.set_ylabel("order of the mesh frequency")
