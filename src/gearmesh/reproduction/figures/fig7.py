"""Fig. 7: c-material with both dampings, in the phase plane and over two mesh periods."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import WIDTH, A, V, empty, styled
from gearmesh.reproduction.figures.fig6 import LOOKS, STRONGER, damping_handles
from gearmesh.reproduction.figures.orbit import closed, last_periods, switches

PERIODS = 2
ROWS = (
    ("y_rel", 1.0, "$y$ in $y_{st}$"),
    ("v_rel", 1.0, f"{V} in $y_{{st}}$"),
    ("a_rel", 1.0, f"{A} in $y_{{st}}$"),
    ("stiffness", 1e5, "$C$, $10^5$ N/mm"),
    ("force_dynamic", 1e3, "$F_{dyn}$ in kN"),
    ("force_friction", 1.0, "$F_T$ in N"),
)
"""Variable, divisor and label of each time course."""


@styled
def draw(printed: xr.Dataset | None, strong: xr.Dataset | None) -> Figure:
    """Draw phase planes and time courses at one ν_s.

    Parameters
    ----------
    printed, strong : xarray.Dataset or None
        Cases of c-material with their time courses, with the printed damping and with five
        times as much; None if missing in the study.

    Returns
    -------
    Figure
        Left: the phase plane for each damping; right: y, y', y'', C, F_dyn and F_T over 2T.
    """
    if printed is None or strong is None:
        return empty()
    figure = Figure(figsize=(WIDTH, 6.8), layout="constrained")
    grid = figure.add_gridspec(1, 2, width_ratios=(1.0, 1.5))
    planes: Any = grid[0].subgridspec(2, 1).subplots(sharex=True, sharey=True)
    courses: Any = grid[1].subgridspec(len(ROWS), 1).subplots(sharex=True)
    cases = [last_periods(case, PERIODS) for case in (printed, strong)]
    titles = ("a)  phase plane, $k_2$", f"b)  phase plane, $k_2$′ = {STRONGER} $k_2$")
    for axes, case, look, title in zip(planes, cases, LOOKS, titles, strict=True):
        _draw_phase_plane(axes, case, *look)
        axes.set_title(title)
    planes[1].set_xlabel("$y$ in $y_{st}$")
    for axes, row in zip(courses, ROWS, strict=True):
        _draw_course(axes, cases, *row)
    courses[0].set_title(f"c)  time courses over 2$T$, $\\nu_s$ = {printed.attrs['nu_s']:.2f}")
    _mark_switches(courses, cases[0])
    courses[-1].set_xlabel("time $t/T$ in mesh periods")
    figure.align_ylabels(courses)
    figure.legend(handles=damping_handles({0.0: printed}), loc="outside upper center", ncols=2)
    return figure


def _draw_phase_plane(axes: Axes, case: xr.Dataset, colour: str, _line: object, b: str) -> None:
    y, v = case["y_rel"].values, case["v_rel"].values
    axes.plot(closed(y), closed(v), color=colour)
    for name, marker, where in zip((b.replace("B", "A"), b), "^v", switches(case), strict=True):
        axes.plot(y[where], v[where], ls="none", marker=marker, ms=4, mew=0, color=palette.INK)
        if len(where):
            axes.annotate(
                name,
                (y[where[-1]], v[where[-1]]),
                xytext=(7, -7),
                textcoords="offset points",
                fontweight="bold",
                ha="center",
            )
    axes.axhline(0.0, color=palette.PALE, lw=0.5, zorder=0)
    axes.margins(0.07)
    axes.set_ylabel(f"{V} in $y_{{st}}$")


def _draw_course(
    axes: Axes, cases: list[xr.Dataset], name: str, divisor: float, label: str
) -> None:
    for case, (colour, line, _) in zip(cases, LOOKS, strict=True):
        axes.plot(case["period"], case[name] / divisor, color=colour, ls=line)
    if min(float(case[name].min()) for case in cases) < 0.0:
        axes.axhline(0.0, color=palette.PALE, lw=0.5, zorder=0)
    axes.margins(y=0.12)
    axes.set_ylabel(label)


def _mark_switches(courses: np.ndarray, case: xr.Dataset) -> None:
    """Draw the switches of C(t), common to both dampings."""
    period = case["period"].values
    for name, where in zip("AB", switches(case), strict=True):
        for place in period[where]:
            for axes in courses:
                axes.axvline(place, color=palette.GREY, lw=0.5, ls=(0, (2, 2)), zorder=0)
            courses[0].annotate(
                name,
                (place, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(3, -2),
                textcoords="offset points",
                va="top",
                fontsize=8,
                fontweight="bold",
            )
    end = round(float(period[-1]))
    courses[-1].set_xlim(end - PERIODS, end)
    courses[-1].xaxis.set_major_locator(MultipleLocator(0.5))
