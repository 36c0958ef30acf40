"""Figure of the samples that meet the claims, over the most influential parameters."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearmesh.identification.estimation.wording import statements, weight_of_claims
from gearmesh.identification.factors import FACTORS
from gearmesh.identification.sampling.store import Samples
from gearmesh.reproduction.claims import Claim
from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import WIDTH, styled
from gearmesh.reproduction.frequencies import FIRST, LAST


@styled
def draw_supports(samples: Samples, ledger: Sequence[Claim]) -> Figure:
    """Draw how many claims each sample meets, over the most influential parameters.

    Parameters
    ----------
    samples : Samples
        Samples of the plausible space.
    ledger : sequence of Claim
        Claims. Those that were not measured on the samples are left out.
    """
    tested = {column.partition("|")[0] for column in samples.measured}
    stated = statements([claim for claim in ledger if claim.id in tested])
    held = [weight > 0 for weight in weight_of_claims(stated, samples.measured).values()]
    failing = len(held) - np.sum(held, axis=0)
    figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    _scatter(left, samples, "body_mass", "bearing_stiffness", failing)
    _scatter(right, samples, "damping_length", "backlash", failing)
    mass = np.array(left.get_xlim())
    for nu, name in ((FIRST, "0.6"), (LAST, "1.2")):
        # The natural frequency of a body on its bearings is at ν_s = √(c_b/C_s · m_red/m).
        left.plot(mass, nu**2 * mass, color=palette.RED, lw=0.8)
        left.annotate(
            name,
            (30.0, nu**2 * 30.0),
            color=palette.RED,
            fontsize=7,
            ha="center",
            va="center",
            bbox={"fc": "white", "ec": "none", "pad": 0.8},
        )
    handles = [
        Line2D([], [], ls="none", marker="o", ms=size, mec="none", color=colour, label=label)
        for label, colour, size in (
            ("at most 1 claim fails", palette.BLUE, 4.5),
            ("2 or 3 fail", "#8fb6d3", 3.5),
            ("more", palette.PALE, 2.0),
        )
    ]
    handles.append(
        Line2D([], [], color=palette.RED, lw=0.8, label="resonance of a body at $\\nu_s$")
    )
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure


def _scatter(axes: Axes, samples: Samples, x: str, y: str, failing: np.ndarray) -> None:
    for chosen, colour, size in (
        (failing > 3, palette.PALE, 0.8),
        ((failing == 2) | (failing == 3), "#8fb6d3", 5.0),
        (failing <= 1, palette.BLUE, 12.0),
    ):
        places = samples.values[x][chosen], samples.values[y][chosen]
        axes.scatter(*places, s=size, color=colour, lw=0)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xticks(FACTORS[x].ticks, [f"{tick:g}" for tick in FACTORS[x].ticks])
    axes.set_yticks(FACTORS[y].ticks, [f"{tick:g}" for tick in FACTORS[y].ticks])
    axes.minorticks_off()
    axes.set_xlim(samples.values[x].min(), samples.values[x].max())
    axes.set_ylim(samples.values[y].min(), samples.values[y].max())
    axes.set_xlabel(FACTORS[x].label)
    axes.set_ylabel(FACTORS[y].label)
