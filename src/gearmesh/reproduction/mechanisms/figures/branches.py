"""Branches of orbits under the dots of Figs. 2 and 3."""

from collections import defaultdict

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import (
    NOT_IN_STUDY,
    WIDTH,
    note,
    region_handles,
    shade_regions,
    styled,
)
from gearmesh.reproduction.figures.orbit import present, scale
from gearmesh.reproduction.mechanisms.tables import Row

ROWS = (("b", "linear"), ("c", "quadratic"), ("d", "cubic"), ("h", "quadratic and cubic"))
COLUMNS = (("lubricant", "•", palette.RED), ("material", "□", palette.BLUE))

STYLES = {1: {"lw": 1.1, "ls": "-"}, 0: {"lw": 0.8, "ls": "-"}, -1: {"lw": 0.8, "ls": (0, (3, 2))}}
"""Lines of stable, neutral and unstable orbits; neutral ones are grey."""

HEIGHTS = ("y_max_rel", "y_min_rel")

_FARTHEST = 1.25  # of the backlash, in pictures

MARKS = {"fold": "D", "flip": "s", "grazing_front": "o", "grazing_back": "v", "switching": "^"}
"""Markers of special points; the fold is filled."""


@styled
def draw(branches: xr.Dataset, special: list[Row], bifurcation: xr.Dataset) -> Figure:
    """Draw y_max and y_min of the orbits over the extrema of the fifth revolution.

    Parameters
    ----------
    branches : xarray.Dataset
        `branches.nc`.
    special : list of dict
        `special_points.json`.
    bifurcation : xarray.Dataset
        ``extremum_y_rel`` over (variant, nu, extremum).

    Returns
    -------
    Figure
        A row of two panels, • and □, for each of b, c, d and h.
    """
    figure = Figure(figsize=(WIDTH, 8.6), layout="constrained")
    grid = figure.subplots(4, 2, sharex=True, sharey="row")
    for row, (letter, law) in zip(grid, ROWS, strict=True):
        for axes, (kind, symbol, colour) in zip(row, COLUMNS, strict=True):
            name = f"{letter}-{kind}"
            axes.set_title(f"{letter} {symbol}  {law} damping")
            if not (branches["variant"] == name).any():
                note(axes, NOT_IN_STUDY)
                continue
            if present(bifurcation, [name], "extremum_y_rel"):
                draw_dots(axes, bifurcation.sel(variant=name))
            draw_lines(axes, branches, name, colour)
            draw_marks(axes, special, name)
        limit(row[0], scale(bifurcation).backlash)
        for axes in row:
            if axes.lines:
                shade_regions(axes, scale(bifurcation).backlash)
        row[0].set_ylabel("$y$ in $y_{st}$")
    nu = bifurcation["nu"].values
    grid[0, 0].set_xlim(nu.min(), nu.max())
    for axes in grid[-1]:
        axes.set_xlabel("mesh frequency $\\nu_s$")
    figure.legend(handles=handles(), loc="outside lower center", ncols=4)
    return figure


def draw_dots(axes: Axes, curve: xr.Dataset) -> None:
    """Draw every extremum of the kept revolution, pale."""
    nu, y = np.broadcast_arrays(curve["nu"].values[:, None], curve["extremum_y_rel"].values)
    look = {"ls": "none", "marker": ".", "ms": 1.6, "mew": 0, "zorder": 1.5, "rasterized": True}
    axes.plot(nu[np.isfinite(y)], y[np.isfinite(y)], color=palette.PALE, **look)


def draw_lines(axes: Axes, branches: xr.Dataset, name: str, colour: str) -> None:
    """Draw y_max and y_min along all branches of a variant, in the style of their stability.

    One line with gaps holds all pieces of one style: matplotlib takes much longer for many lines.
    """
    columns = ("branch", "periods", "stability", "nu", *HEIGHTS)
    chosen = branches["variant"].values == name
    own = {column: branches[column].values[chosen] for column in columns}
    pieces: defaultdict[tuple[int, str], list[np.ndarray]] = defaultdict(list)
    for number in np.unique(own["branch"]):
        points = np.flatnonzero(own["branch"] == number)
        period, stability = int(own["periods"][points[0]]), own["stability"][points]
        of_period = {1: colour, 2: palette.GREEN}.get(period, palette.VIOLET)
        for piece in np.split(points, np.flatnonzero(np.diff(stability)) + 1):
            kind = int(own["stability"][piece[0]])
            # A piece reaches to the first point of the next one, so that no gap is left.
            piece = np.append(piece, min(piece[-1] + 1, points[-1]))
            pieces[kind, palette.GREY if kind == 0 else of_period].append(piece)
    for (kind, tint), drawn in pieces.items():
        for y in HEIGHTS:
            line = (
                np.concatenate([np.append(own[column][piece], np.nan) for piece in drawn])
                for column in ("nu", y)
            )
            axes.plot(*line, color=tint, zorder=2.5 + kind, **STYLES[kind])


def limit(axes: Axes, backlash: float) -> None:
    """Fix the range of y, without the orbits that strike both flanks far beyond the backlash."""
    low, high = axes.get_ylim()
    axes.set_ylim(max(low, -_FARTHEST * backlash), min(high, _FARTHEST * backlash))


def draw_marks(axes: Axes, special: list[Row], name: str) -> None:
    """Mark the special points of the orbits of one mesh period."""
    own = [row for row in special if row["variant"] == name and row["periods"] == 1]
    own = [row for row in own if "parameters" not in row]
    for kind in dict.fromkeys(row["kind"] for row in own):
        places = [(row["nu"], row[y]) for row in own if row["kind"] == kind for y in HEIGHTS]
        axes.plot(
            *zip(*places, strict=True),
            marker=MARKS.get(kind, "*"),
            ms=3.6,
            mew=0.7,
            mec=palette.INK,
            mfc=palette.INK if kind == "fold" else "white",
            ls="none",
            zorder=5,
        )


def handles() -> list[Artist]:
    """Return the entries of the legend."""
    lines = [
        Line2D([], [], color=palette.INK, label="stable orbit", **STYLES[1]),
        Line2D([], [], color=palette.INK, label="unstable orbit", **STYLES[-1]),
        Line2D([], [], color=palette.GREY, label="neutral orbit", **STYLES[0]),
        Line2D([], [], color=palette.GREEN, label="orbit of period 2", **STYLES[1]),
        Line2D([], [], color=palette.VIOLET, label="orbit of period 3 to 12", **STYLES[1]),
        Line2D(
            [], [], color=palette.PALE, ls="none", marker=".", ms=4, label="extrema of the runs"
        ),
    ]
    look = {"ls": "none", "ms": 4, "mew": 0.7, "mec": palette.INK}
    names = {"fold": "fold", "flip": "flip", "grazing_front": "grazing", "switching": "switching"}
    marks = [
        Line2D(
            [],
            [],
            marker=MARKS[kind],
            label=label,
            mfc=palette.INK if kind == "fold" else "white",
            **look,
        )
        for kind, label in names.items()
    ]
    return [*lines, *marks, *region_handles()[1:]]
