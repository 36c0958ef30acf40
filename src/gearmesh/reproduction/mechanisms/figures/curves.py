"""Curves of special points over (ν_s, damping) and (ν_s, damping length)."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import NOT_IN_STUDY, WIDTH, note, styled

PANELS = (
    ("damping", "damping_ratio", "damping ratio $D$"),
    ("damping_length", "damping_length_rel", "damping length $\\ell$ in $y_{st}$"),
)
DASHES = {
    "fold": "-",
    "flip": (0, (1, 1.5)),
    "grazing_front": (0, (5, 2)),
    "switching": (0, (5, 2, 1, 2)),
}
COLOURS = {"b-material": palette.GREEN, "c-material": palette.BLUE, "c-lubricant": palette.RED}
SYMBOLS = {"material": "□", "lubricant": "•", "both": "×"}
NAMES = {"fold": "fold", "flip": "flip", "grazing_front": "grazing", "switching": "switching"}


@styled
def draw(curves: xr.Dataset, printed: Mapping[str, float]) -> Figure:
    """Draw the curves of special points.

    Parameters
    ----------
    curves : xarray.Dataset
        See `gearmesh.reproduction.mechanisms.curves`.
    printed : mapping
        Parameter -> its value in the study: D, and ℓ in static deflections.
    """
    figure = Figure(figsize=(WIDTH, 3.9), layout="constrained")
    row = figure.subplots(1, 2, sharex=True)
    for axes, (parameter, ordinate, label) in zip(row, PANELS, strict=True):
        own = curves.isel(point=np.flatnonzero(curves["parameter"] == parameter))
        axes.set_xlabel("mesh frequency $\\nu_s$")
        axes.set_ylabel(label)
        axes.set_yscale("log")
        if not own.sizes["point"]:
            note(axes, NOT_IN_STUDY)
            continue
        draw_curves(axes, own, ordinate)
        axes.axhline(printed[parameter], color=palette.INK, lw=0.7, ls=(0, (1, 1)))
    row[0].set_xlim(0.5, 1.2)
    known = {label: line for axes in row for line, label in zip(*_entries(axes), strict=True)}
    dotted = Line2D([], [], color=palette.INK, lw=0.7, ls=(0, (1, 1)), label="value of this study")
    figure.legend(handles=[*known.values(), dotted], loc="outside lower center", ncols=4)
    return figure


def _entries(axes: Axes) -> tuple[list[Artist], list[str]]:
    return axes.get_legend_handles_labels()


def draw_curves(axes: Axes, own: xr.Dataset, ordinate: str) -> None:
    """Draw curves of special points, with `ordinate` against ν_s."""
    for number in np.unique(own["curve"]):
        curve = own.isel(point=np.flatnonzero(own["curve"] == number))
        name = str(curve["variant"].values[0])
        letter, kind = name.split("-")
        special = str(curve["kind"].values[0])
        line = curve.isel(point=np.flatnonzero(curve["cusp"] == 0))
        axes.plot(
            line["nu"],
            line[ordinate],
            color=COLOURS[name],
            ls=DASHES[special],
            label=f"{NAMES[special]}, {letter}-{SYMBOLS[kind]}",
        )
        cusp = curve.isel(point=np.flatnonzero(curve["cusp"] == 1))
        if cusp.sizes["point"]:
            axes.plot(cusp["nu"], cusp[ordinate], ls="none", marker="D", ms=4, color=COLOURS[name])
            axes.annotate(
                "cusp",
                (cusp["nu"].values[0], cusp[ordinate].values[0]),
                xytext=(6, 2),
                textcoords="offset points",
                fontsize=8,
            )
