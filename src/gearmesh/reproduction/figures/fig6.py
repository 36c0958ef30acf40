"""Fig. 6: phase portraits of c-material with the printed damping and with 5 times that."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import WIDTH, V, empty, styled
from gearmesh.reproduction.figures.fig5 import dress
from gearmesh.reproduction.figures.orbit import closed, last_periods, scale, switches
from gearmesh.reproduction.frequencies import CROSSING

RANGE = (0.6, 0.8)
STRONGER = 5
"""Factor on the damping of the second portrait."""

LOOKS = ((palette.BLUE, "-", "B"), (palette.RED, (0, (5, 1)), "B′"))
"""Colour, line and name of the point B for each damping; the dashes serve print in grey."""


@styled
def draw(printed: Mapping[float, xr.Dataset], strong: Mapping[float, xr.Dataset]) -> Figure:
    """Draw the orbits of the last period in perspective and along the ν_s axis.

    Parameters
    ----------
    printed, strong : mapping from float to xarray.Dataset
        Cases of c-material with their time courses, by their ν_s, with the printed damping
        and with five times as much; those in `RANGE` are drawn.

    Returns
    -------
    Figure
        a) in perspective, b) along the ν_s axis with the orbits at `CROSSING` strong.
    """
    portraits = [_within(cases) for cases in (printed, strong)]
    if not all(portraits):
        return empty()
    figure = Figure(figsize=(WIDTH, 4.3))
    space: Any = figure.add_axes((-0.035, -0.03, 0.58, 1.04), projection="3d")
    plane = figure.add_axes((0.63, 0.12, 0.36, 0.72))
    for cases, (colour, _, point) in zip(portraits, LOOKS, strict=True):
        for nu, case in sorted(cases.items(), reverse=True):
            course = last_periods(case, 1)
            y, v = (closed(course[name].values) for name in ("y_rel", "v_rel"))
            space.plot(np.full(len(y), nu), y, v, color=colour, lw=0.6)
            plane.plot(y, v, color=colour, lw=0.35, alpha=0.6)
        _draw_point(plane, cases, point, colour)
    for cases, (colour, _, _) in zip(portraits, LOOKS, strict=True):
        if CROSSING in cases:
            course = last_periods(cases[CROSSING], 1)
            y, v = (closed(course[name].values) for name in ("y_rel", "v_rel"))
            plane.plot(y, v, color=colour, lw=1.5)
    dress(space, portraits[0])
    space.set_box_aspect((1.25, 1.0, 0.9), zoom=0.87)
    space.xaxis.set_major_locator(MultipleLocator(0.05))
    space.yaxis.set_major_locator(MultipleLocator(0.5))
    plane.set(xlabel="$y$ in $y_{st}$", ylabel=f"{V} in $y_{{st}}$")
    plane.margins(0.06)
    figure.text(0.02, 0.87, "a)  in perspective")
    figure.text(0.63, 0.87, "b)  along the $\\nu_s$ axis; strong: $\\nu_s$ = 0.61")
    figure.legend(
        handles=damping_handles(portraits[0]), loc="upper center", ncols=2, bbox_to_anchor=(0.5, 1)
    )
    return figure


def damping_handles(printed: Mapping[float, xr.Dataset]) -> list[Line2D]:
    """Return legend entries of the two dampings."""
    damping = scale(next(iter(printed.values()))).damping
    labels = (
        f"$k_2$ = {damping:.5g} N s/mm",
        f"$k_2$′ = {STRONGER} $k_2$ = {STRONGER * damping:.6g} N s/mm",
    )
    return [
        Line2D([], [], color=colour, label=label)
        for label, (colour, _, _) in zip(labels, LOOKS, strict=True)
    ]


def _within(cases: Mapping[float, xr.Dataset]) -> dict[float, xr.Dataset]:
    low, high = RANGE
    return {nu: case for nu, case in cases.items() if low - 1e-9 < nu < high + 1e-9}


def _draw_point(axes: Axes, cases: Mapping[float, xr.Dataset], name: str, colour: str) -> None:
    """Draw the points of the switch from C_max to C_min over ν_s."""
    track: list[tuple[float, ...]] = []
    for _, case in sorted(cases.items()):
        course = last_periods(case, 1)
        _, down = switches(course)
        track.extend((course["y_rel"].values[i], course["v_rel"].values[i]) for i in down)
    if not track:
        return
    y, v = np.array(track).T
    axes.plot(y, v, color=palette.INK, lw=0.6, marker="v", ms=2.6, mfc=colour, mew=0.4, zorder=4)
    axes.annotate(
        name,
        (y[-1], v[-1]),
        xytext=(0, 7),
        textcoords="offset points",
        ha="center",
        fontweight="bold",
        color=colour,
    )
