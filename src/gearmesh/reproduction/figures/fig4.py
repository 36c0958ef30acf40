"""Fig. 4: periodic and not periodic motion of c-lubricant, in the phase plane and in time."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import (
    WIDTH,
    V,
    empty,
    region_handles,
    shade_regions,
    styled,
)
from gearmesh.reproduction.figures.orbit import last_periods, scale, switches
from gearmesh.reproduction.frequencies import FIG_4

SPANS = (21, 5)
"""Last mesh periods that the time courses show."""

_STIFFNESS_UNIT = 1e5
_SWITCHES = {"A": "^", "B": "v"}
_POINT = {
    "ls": "none",
    "marker": "o",
    "ms": 5.5,
    "mew": 0.7,
    "mfc": "none",
    "mec": palette.BLUE,
}
_SWITCH = {"ls": "none", "ms": 3.6, "mew": 0.6, "mec": "white", "mfc": palette.INK}


@styled
def draw(cases: Mapping[float, xr.Dataset]) -> Figure:
    """Draw phase planes and time courses of c-lubricant.

    Parameters
    ----------
    cases : mapping from float to xarray.Dataset
        Cases with their time courses, by their ν_s; those at `FIG_4` are drawn.

    Returns
    -------
    Figure
        A column for each ν_s. From top to bottom: the phase plane of all kept periods; y, y' and
        the stiffnesses over the last 21 periods; the same over the last 5.
    """
    courses = [cases[nu] for nu in FIG_4 if nu in cases]
    if not courses:
        return empty()
    figure = Figure(figsize=(WIDTH, 9.6), layout="constrained")
    heights = (2.6, *[1.0] * (3 * len(SPANS)))
    grid = figure.subplots(len(heights), len(courses), height_ratios=heights, squeeze=False)
    _draw_phase_planes(grid[0], courses)
    for part, periods in zip((grid[1:4], grid[4:7]), SPANS, strict=True):
        _draw_courses(part, courses, periods)
    figure.align_ylabels(grid[:, 0])
    figure.legend(handles=_handles(), loc="outside lower center", ncols=4)
    return figure


def _draw_phase_planes(row: np.ndarray, cases: list[xr.Dataset]) -> None:
    _share(row, x=True)
    for axes, case, tag in zip(row, cases, "abc", strict=False):
        kept = scale(case)
        course = last_periods(case, kept.kept_periods)
        y, v = course["y_rel"].values, course["v_rel"].values
        axes.plot(y, v, color=palette.RED, lw=0.5)
        boundaries = slice(-kept.kept_periods, None)
        axes.plot(case["strobe_y_rel"][boundaries], case["strobe_v_rel"][boundaries], **_POINT)
        for (name, marker), where in zip(_SWITCHES.items(), switches(course), strict=True):
            axes.plot(y[where], v[where], marker=marker, **_SWITCH)
            _name_point(axes, name, y[where], v[where])
        axes.set_title(f"{tag})  $\\nu_s$ = {case.attrs['nu_s']:.2f}")
        axes.set_xlabel("$y$ in $y_{st}$")
    row[0].set_ylabel(f"{V} in $y_{{st}}$")
    row[0].margins(0.06, 0.1)
    row[0].set_xlim(row[0].get_xlim())
    for axes, case in zip(row, cases, strict=True):
        shade_regions(axes, scale(case).backlash, along="x")


def _share(row: np.ndarray, x: bool = False) -> None:
    """Give the axes of a row one ordinate and, on request, one abscissa."""
    for axes in row[1:]:
        axes.sharey(row[0])
        axes.tick_params(labelleft=False)
        if x:
            axes.sharex(row[0])


def _name_point(axes: Axes, name: str, y: np.ndarray, v: np.ndarray) -> None:
    """Write the name beside the outermost of the points, away from the middle of the orbit."""
    if not len(y):
        return
    outermost = np.argmax(np.abs(v))
    away = 1.0 if v[outermost] > 0 else -1.0
    axes.annotate(
        name,
        (y[outermost], v[outermost]),
        xytext=(-5, 7 * away),
        textcoords="offset points",
        ha="right",
        va="center",
        fontsize=9,
        fontweight="bold",
    )


def _draw_courses(grid: np.ndarray, cases: list[xr.Dataset], periods: int) -> None:
    for row in grid:
        _share(row)
    for column, case in zip(grid.T, cases, strict=True):
        course = last_periods(case, periods)
        period, stiffness = course["period"].values, course["stiffness"].values
        column[0].plot(period, course["y_rel"], color=palette.RED)
        column[1].plot(period, course["v_rel"], color=palette.RED)
        column[2].plot(period, stiffness / _STIFFNESS_UNIT, color=palette.PALE, lw=1.8)
        column[2].plot(
            period, course["modified_stiffness"] / _STIFFNESS_UNIT, color=palette.INK, lw=0.7
        )
        if periods == min(SPANS):
            _mark_switches(column, course)
        column[0].axhline(0.0, color=palette.GREY, lw=0.5)
        column[1].axhline(0.0, color=palette.GREY, lw=0.5)
        end = round(float(period[-1]))
        for axes in column:
            _shade_time(axes, period, course["regime"].values)
            axes.set_xlim(end - periods, end)
            axes.xaxis.set_major_locator(MultipleLocator(7 if periods > 7 else 1))
            axes.tick_params(labelbottom=axes is column[-1])
    for axes in grid[0]:
        axes.margins(y=0.12)
    stiffest = max(float(case["stiffness"].max()) for case in cases)
    grid[2, 0].set_ylim(0.0, 1.2 * stiffest / _STIFFNESS_UNIT)
    names = ("$y$ in $y_{st}$", f"{V} in $y_{{st}}$", "$C$, $10^5$ N/mm")
    for axes, name in zip(grid[:, 0], names, strict=True):
        axes.set_ylabel(name)
    grid[2, len(cases) // 2].set_xlabel(f"time $t/T$ in mesh periods: the last {periods}")


def _mark_switches(column: np.ndarray, course: xr.Dataset) -> None:
    period = course["period"].values
    for (name, marker), where in zip(_SWITCHES.items(), switches(course), strict=True):
        for axes, variable in ((column[0], "y_rel"), (column[1], "v_rel")):
            axes.plot(period[where], course[variable].values[where], marker=marker, **_SWITCH)
        column[2].tick_params(which="both", top=False)
        for place in period[where]:
            column[2].annotate(
                name,
                (place, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(1.5, -1.5),
                textcoords="offset points",
                ha="left",
                va="top",
                fontsize=6.5,
            )


def _shade_time(axes: Axes, period: np.ndarray, regime: np.ndarray) -> None:
    """Colour the time spent in contact loss and in inverse mesh."""
    for which, colour in ((0, palette.CONTACT_LOSS), (-1, palette.INVERSE_MESH)):
        axes.fill_between(
            period,
            0.0,
            1.0,
            where=regime == which,
            transform=axes.get_xaxis_transform(),
            color=colour,
            lw=0,
            zorder=0,
        )


def _handles() -> list[Artist]:
    point = {"ls": "none", "ms": 4, "color": palette.INK}
    return [
        Line2D([], [], color=palette.RED, label=f"$y$, {V} of c •"),
        Line2D([], [], color=palette.PALE, lw=1.8, label="$C(t)$"),
        Line2D([], [], color=palette.INK, lw=0.7, label="$C(t)\\,(H_1+H_2)$"),
        Line2D([], [], label="stroboscopic points", **_POINT),
        Line2D([], [], marker="^", label="A: $C$ goes to $C_{\\max}$", **point),
        Line2D([], [], marker="v", label="B: $C$ goes to $C_{\\min}$", **point),
        *region_handles(inverse=False)[1:],
    ]
