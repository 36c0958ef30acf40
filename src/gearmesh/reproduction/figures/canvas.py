"""Common parts of all figures: style, regions, axis in micrometres, saving."""

import functools
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rcParams, style
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, FuncFormatter
from PIL import Image

from gearmesh.data.writing import replacing
from gearmesh.reproduction.figures import palette

STYLE = "gearmesh.reproduction.figures.gearmesh"
WIDTH = 7.2
"""Width of a full page figure in inches."""

_COMPRESSION = 3  # of PNG; 6, the default, takes half as long again and saves a fourteenth

NOT_IN_STUDY = "not in this study"
"""Text of a panel whose cases are missing in the study."""

V = "$y$′"
A = "$y$″"
"""y' and y''. Mathtext sets primes too far from the letter."""


def styled(draw: Callable[..., Figure]) -> Callable[..., Figure]:
    """Make `draw` use the style file of the figures instead of the caller's settings."""

    @functools.wraps(draw)
    def under_style(*args: Any, **kwargs: Any) -> Figure:
        with style.context(["default", STYLE]):
            return draw(*args, **kwargs)

    return under_style


def save(figure: Figure, path: Path | str) -> tuple[Path, Path]:
    """Write `figure` as PNG and as SVG, whole or not at all; the same figure gives the same bytes.

    Parameters
    ----------
    figure : Figure
        The figure.
    path : Path or str
        Place without suffix; missing folders are made.

    Returns
    -------
    tuple of Path
        The PNG and the SVG file.
    """
    png, svg = (Path(f"{path}{suffix}") for suffix in (".png", ".svg"))
    with style.context(["default", STYLE]):
        _lay_out(figure)
        with replacing(png) as temporary:
            _write_png(figure, temporary)
        with replacing(svg) as temporary:
            figure.savefig(temporary, format="svg", metadata={"Date": None, "Creator": None})
    return png, svg


def _lay_out(figure: Figure) -> None:
    """Lay a figure out once, for PNG and SVG: matplotlib would draw it once more for each."""
    if engine := figure.get_layout_engine():
        figure.dpi = rcParams["savefig.dpi"]
        engine.execute(figure)
        figure.set_layout_engine(None)


def _write_png(figure: Figure, file: Path | io.BytesIO) -> None:
    """Write a laid-out figure as PNG: three channels, because all of it is opaque.

    matplotlib would write a fourth and compress harder: twice the time, for no smaller file.
    """
    figure.dpi = dpi = rcParams["savefig.dpi"]
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    pixels.save(file, format="png", dpi=(dpi, dpi), compress_level=_COMPRESSION)


def picture(figure: Figure, path: Path | str | None = None) -> bytes:
    """Return a figure as PNG, and write it as `save` does if `path` is given."""
    if path is not None:
        return save(figure, path)[0].read_bytes()
    image = io.BytesIO()
    with style.context(["default", STYLE]):
        _lay_out(figure)
        _write_png(figure, image)
    return image.getvalue()


def note(axes: Axes, text: str) -> None:
    """Write in an empty panel why it is empty."""
    axes.text(
        0.5, 0.5, text, ha="center", va="center", color=palette.GREY, transform=axes.transAxes
    )


def empty() -> Figure:
    """Return a figure with the text `NOT_IN_STUDY`."""
    figure = Figure(figsize=(WIDTH, 1.2))
    figure.text(0.5, 0.5, NOT_IN_STUDY, ha="center", va="center", color=palette.GREY)
    return figure


def shade_regions(axes: Axes, backlash: float, along: str = "y") -> None:
    """Colour contact loss yellow and inverse mesh red in the background of `axes`.

    Parameters
    ----------
    axes : Axes
        Axes whose limits are final.
    backlash : float
        s in units of the axis.
    along : {"y", "x"}
        The axis that carries the relative motion.
    """
    span, line, limits = (
        (axes.axhspan, axes.axhline, axes.get_ylim())
        if along == "y"
        else (axes.axvspan, axes.axvline, axes.get_xlim())
    )
    low = limits[0]
    if low < 0.0:
        span(max(low, -backlash), 0.0, color=palette.CONTACT_LOSS, lw=0, zorder=0)
        line(0.0, color=palette.GREY, lw=0.5, zorder=0.5)
    if low < -backlash:
        span(low, -backlash, color=palette.INVERSE_MESH, lw=0, zorder=0)
        line(-backlash, color=palette.GREY, lw=0.5, zorder=0.5)


def region_handles(inverse: bool = True) -> list[Patch]:
    """Return legend entries of the region colours."""
    regions = [
        (palette.NORMAL_MESH, "normal mesh, $y\\geq 0$"),
        (palette.CONTACT_LOSS, "contact loss, $-s<y<0$"),
        (palette.INVERSE_MESH, "inverse mesh, $y\\leq -s$"),
    ]
    return [
        Patch(facecolor=colour, edgecolor=palette.GREY, lw=0.5, label=label)
        for colour, label in regions[: 3 if inverse else 2]
    ]


def curve_handle(name: str) -> Line2D:
    """Return the legend entry of the curves with damping in `name`, such as ``lubricant``."""
    look = palette.LOOKS[name]
    return Line2D(
        [],
        [],
        ls="none",
        label=look.meaning,
        **marker_look(look, size=max(look.size, 3.6)),
    )


def marker_look(look: palette.Look, size: float | None = None) -> dict[str, Any]:
    """Return the marker settings of `look` for `Axes.plot`."""
    return {
        "marker": look.marker,
        "ms": size or look.size,
        "mew": 0.7 if look.open else 0.0,
        "mec": look.colour,
        "mfc": "none" if look.open else look.colour,
    }


def micrometre_axis(axes: Axes, static_deflection: float, label: bool = True) -> Axes:
    """Give `axes`, whose ordinate counts static deflections, a right ordinate in micrometres.

    Parameters
    ----------
    axes : Axes
        Axes whose scale and limits are final.
    static_deflection : float
        y_st in mm.
    label : bool
        Whether the new ordinate is named.

    Returns
    -------
    Axes
        The axes of the right ordinate.
    """
    right = axes.twinx()
    axes.tick_params(axis="y", which="both", right=False)
    micrometres = 1e3 * static_deflection
    scale: Any = axes.yaxis.get_transform()
    if axes.get_yscale() == "symlog":
        right.set_yscale(
            "symlog",
            linthresh=scale.linthresh * micrometres,
            linscale=scale.linscale,
        )
        right.yaxis.set_major_locator(FixedLocator(micrometres * axes.get_yticks()))
        right.yaxis.set_major_formatter(
            FuncFormatter(lambda tick, _: f"{tick:g}".replace("-", "−"))
        )
        right.minorticks_off()
    right.set_ylim(*(limit * micrometres for limit in axes.get_ylim()))
    right.tick_params(axis="y", which="both", left=False, right=True)
    if label:
        right.set_ylabel("µm")
    return right
