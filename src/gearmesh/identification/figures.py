"""Figures of the open parameters: their compatible regions, and the sensitivity to them."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from gearmesh.identification.factors import FACTORS
from gearmesh.identification.settings import Range
from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import WIDTH, styled

_DENSITY = {"color": palette.PALE, "alpha": 0.6, "lw": 0}


@styled
def draw_regions(
    found: Mapping[str, Any], ranges: Mapping[str, Range], stated: Mapping[str, float]
) -> Figure:
    """Draw the region of each parameter that is compatible with the claims.

    Parameters
    ----------
    found : mapping
        ``regions`` of the findings.
    ranges : mapping of str to Range
        Ranges of the plausible space.
    stated : mapping of str to float
        Values of the study, shown as a line.
    """
    factors = [name for name in found["plausible"]["factors"] if name != "kind"]
    figure = Figure(figsize=(WIDTH, 0.78 * len(factors) + 0.7), layout="constrained")
    grid = figure.subplots(len(factors), 1)
    for axes, factor in zip(grid, factors, strict=True):
        _draw_factor(axes, factor, found, ranges[factor])
        if factor in stated:
            place = ranges[factor].unit(stated[factor])
            axes.axvline(place, color=palette.RED, lw=1.1, clip_on=False)
    handles = [
        Patch(**_DENSITY, label="density"),
        Line2D([], [], color=palette.GREY, lw=0.6, ls=(0, (4, 3)), label="without the claims"),
        Patch(color=palette.BLUE, alpha=0.25, lw=0, label="95 %"),
        Patch(color=palette.BLUE, alpha=0.75, lw=0, label="50 %"),
        Line2D([], [], color=palette.RED, lw=1.1, label="this study"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=5)
    return figure


def _draw_factor(axes: Axes, factor: str, found: Mapping[str, Any], bounds: Range) -> None:
    readings = {"natural": "natural", "plausible": "all"}
    varied = [reading for reading in readings if factor in found[reading]["factors"]]
    for row, reading in enumerate(varied):
        region = found[reading]["factors"][factor]
        for ends, alpha in ((region["region"], 0.25), (region["half"], 0.75)):
            low, high = (bounds.unit(end) for end in ends)
            axes.barh(row, high - low, left=low, height=0.16, color=palette.BLUE, alpha=alpha, lw=0)
        _draw_shape(axes, np.array(region["shape"]), row + 0.12, 0.66)
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(-0.2, len(varied) - 0.1)
    axes.set_yticks(range(len(varied)), [readings[reading] for reading in varied])
    axes.tick_params(axis="y", length=0)
    ticks = [tick for tick in FACTORS[factor].ticks if bounds.low <= tick <= bounds.high]
    labels = [f"{tick:g}".replace("-", "−") for tick in ticks]
    axes.set_xticks([bounds.unit(tick) for tick in ticks], labels)
    axes.set_title(FACTORS[factor].label, pad=3)


def _draw_shape(axes: Axes, shape: np.ndarray, base: float, height: float) -> None:
    """Draw the density of compatible samples over the range, and that of all samples (dashed)."""
    scale = height / shape.max()
    edges = np.linspace(0.0, 1.0, shape.size + 1)
    axes.stairs(base + scale * shape, edges, baseline=base, fill=True, **_DENSITY)
    axes.plot([0.0, 1.0], [base + scale] * 2, color=palette.GREY, lw=0.6, ls=(0, (4, 3)))


@styled
def draw_sensitivity(found: Mapping[str, Any]) -> Figure:
    """Draw the sensitivity of each threshold to each parameter: PAWN indices above chance.

    Parameters
    ----------
    found : mapping
        ``sensitivity`` of the findings: threshold -> factor -> index.
    """
    rows, factors = list(found), list(next(iter(found.values())))
    index = np.array([[found[row][factor]["index"] for factor in factors] for row in rows])
    chance = np.array([[found[row][factor]["chance"] for factor in factors] for row in rows])
    shown = np.where(index > chance, index, np.nan)
    figure = Figure(figsize=(WIDTH, 0.21 * len(rows) + 0.9), layout="constrained")
    axes = figure.subplots()
    shades = LinearSegmentedColormap.from_list("index", ["#eef5fa", palette.BLUE])
    axes.imshow(shown, cmap=shades, vmin=0.0, vmax=0.7, aspect="auto")
    for i, j in np.argwhere(np.isfinite(shown)):
        ink = "white" if shown[i, j] > 0.4 else palette.INK
        axes.text(j, i, f"{shown[i, j]:.2f}", ha="center", va="center", color=ink, fontsize=7)
    axes.set_xticks(range(len(factors)), [FACTORS[name].label for name in factors])
    axes.set_yticks(range(len(rows)), [threshold_label(row) for row in rows])
    axes.tick_params(length=0, top=False, right=False)
    axes.tick_params(axis="x", labeltop=True, labelbottom=False)
    return figure


_MARKS = {"lubricant": "•", "material": "□", "both": "×"}
_WORDS = {
    "F2.1": "remaining step",
    "F2.2": "□ against ×",
    "F2.3|near 0.66": "first jump",
    "F2.3|near 0.8": "second jump",
    "F2.5|beyond the jump": "peak beyond the jump",
    "F2.6": "distance from inverse mesh",
    "F3.1|y_max": "onset of the bifurcation",
    "F3.2|end": "end of the loops",
    "F3.4|ratio": "spread of maxima below 0.8",
    "F4.1|0.60": "stroboscopic spread at 0.60",
    "F4.1|1.05": "stroboscopic spread at 1.05",
    "F4.1|1.20": "stroboscopic spread at 1.20",
    "F6.1|from": "5k exceeds k: from",
    "F6.1|to": "5k exceeds k: to",
    "F6.2|5k": "end of the loops, 5k",
}


def threshold_label(column: str) -> str:
    """Return the label of a measured value, with its variant."""
    name = next(name for name in _WORDS if column == name or column.startswith(f"{name}|"))
    variant = column.removeprefix(name).lstrip("|")
    letter, _, place = variant.partition("-")
    mark = f", {letter}-{_MARKS[place]}" if place in _MARKS else f", {variant}" if variant else ""
    return f"{_WORDS[name]}{mark} ({name.partition('|')[0]})"
