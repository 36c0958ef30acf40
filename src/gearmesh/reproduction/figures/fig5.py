"""Fig. 5: the phase portrait of c-material over the whole range of ν_s."""

from collections.abc import Iterable, Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d.axes3d import Axes3D

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import WIDTH, V, empty, styled
from gearmesh.reproduction.figures.orbit import closed, last_periods, switches

SPACING = 0.02
"""Least distance in ν_s between two orbits, so that they can be distinguished."""

TURNING_POINTS_WITHOUT_LOOP = 2
"""A plain orbit turns twice a period; a loop adds two turning points."""


@styled
def draw(cases: Mapping[float, xr.Dataset]) -> Figure:
    """Draw the last period's orbits in the space of ν_s, y and y'.

    Parameters
    ----------
    cases : mapping from float to xarray.Dataset
        Cases with their time courses, by their ν_s.

    Returns
    -------
    Figure
        Orbits with a loop in blue, others in grey, and the lines of the points A and B.
    """
    if not cases:
        return empty()
    figure = Figure(figsize=(WIDTH, 4.8))
    axes = figure.add_axes((-0.1, -0.16, 1.12, 1.34), projection="3d")
    places: dict[str, list[tuple[float, ...]]] = {"A": [], "B": []}
    for nu in reversed(_spaced(cases)):
        case = cases[nu]
        course = last_periods(case, 1)
        y, v = course["y_rel"].values, course["v_rel"].values
        loop = float(case["turning_points_per_period"]) > TURNING_POINTS_WITHOUT_LOOP
        axes.plot(
            np.full(len(y) + 1, nu),
            closed(y),
            closed(v),
            color=palette.BLUE if loop else palette.GREY,
            lw=0.9 if loop else 0.6,
        )
        for name, where in zip(places, switches(course), strict=True):
            places[name].extend((nu, y[i], v[i]) for i in where)
    for name, points in places.items():
        _draw_point(axes, name, np.array(sorted(points)))
    dress(axes, cases)
    figure.legend(handles=_handles(), loc="upper left", bbox_to_anchor=(0.02, 0.98))
    return figure


def _spaced(frequencies: Iterable[float]) -> list[float]:
    chosen: list[float] = []
    for nu in sorted(frequencies):
        if not chosen or nu - chosen[-1] > SPACING - 1e-9:
            chosen.append(nu)
    return chosen


def dress(axes: Axes3D, cases: Mapping[float, xr.Dataset]) -> None:
    """Label the axes of a phase portrait and set the view of the paper."""
    axes.set(
        xlabel="mesh frequency $\\nu_s$", ylabel="$y$ in $y_{st}$", zlabel=f"{V} in $y_{{st}}$"
    )
    axes.set_xlim(min(cases), max(cases))
    axes.set_box_aspect((1.9, 1.0, 0.9), zoom=0.95)
    axes.view_init(elev=20, azim=-62)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.pane.set(facecolor="white", edgecolor=palette.PALE)
        axis._axinfo["grid"].update(color="#e4e4e4", linewidth=0.4)
        axis.labelpad = 2
    axes.tick_params(pad=0, labelsize=7.5)


def _draw_point(axes: Axes3D, name: str, points: np.ndarray) -> None:
    if not len(points):
        return
    axes.plot(*points.T, color=palette.RED, lw=0.8, marker="^" if name == "A" else "v", ms=2.4)
    axes.text(*points[-1], f"  {name}", color=palette.RED, fontweight="bold", fontsize=10)


def _handles() -> list[Line2D]:
    return [
        Line2D([], [], color=palette.BLUE, label="orbit with a loop"),
        Line2D([], [], color=palette.GREY, lw=0.6, label="orbit without a loop"),
        Line2D([], [], color=palette.RED, marker="^", ms=3, label="A: $C$ goes to $C_{\\max}$"),
        Line2D([], [], color=palette.RED, marker="v", ms=3, label="B: $C$ goes to $C_{\\min}$"),
    ]
