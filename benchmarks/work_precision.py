"""The work-precision diagram: what a digit costs each solver."""

from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from benchmarks.measure import AIM
from benchmarks.peers import OURS

IMAGES = Path(__file__).parents[1] / "docs" / "images"
_MARKERS = "osD^v<>"


@dataclass(frozen=True, slots=True)
class Point:
    """A solver at one setting.

    Attributes
    ----------
    solver : str
    setting : float
    seconds : float
        A case, on a sweep.
    error : float
        That 95 % of the runs stay below, in static deflections.
    """

    solver: str
    setting: float
    seconds: float
    error: float


def draw(points: list[Point]) -> None:
    """Draw `points` into docs/images/work_precision.svg and .png."""
    style = {"font.size": 9, "svg.hashsalt": "gearmesh", "svg.fonttype": "path"}
    with plt.rc_context(style):
        figure, axes = plt.subplots(figsize=(6.3, 4.2), layout="constrained")
        for number, name in enumerate(dict.fromkeys(point.solver for point in points)):
            chosen = [point for point in points if point.solver == name]
            ours = name == OURS.name
            axes.loglog(
                [point.error for point in chosen],
                [1e3 * point.seconds for point in chosen],
                marker=_MARKERS[number],
                markersize=5 if ours else 4,
                linewidth=2.2 if ours else 1.2,
                color="#b2182b" if ours else plt.get_cmap("viridis")(0.16 * number),
                label=name,
            )
        axes.axvline(AIM, color="0.6", linewidth=0.8, linestyle=":")
        axes.invert_xaxis()
        axes.set_xlabel("error of 95 % of the runs / static deflection")
        axes.set_ylabel("CPU time for a run of 105 mesh periods / ms")
        axes.grid(True, which="major", color="0.9")
        axes.spines[["top", "right"]].set_visible(False)
        figure.legend(frameon=False, ncols=3, loc="outside upper center")
        IMAGES.mkdir(parents=True, exist_ok=True)
        figure.savefig(IMAGES / "work_precision.svg", metadata={"Date": None})
        figure.savefig(IMAGES / "work_precision.png", dpi=200, metadata={"Software": None})
        plt.close(figure)
