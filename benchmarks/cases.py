"""The runs that are measured: sweeps and single cases of the damping variants b, c and d."""

from pathlib import Path

import numpy as np

from gearmesh.model.problem import Problem
from gearmesh.model.variants import variant
from gearmesh.study.loading import load_study

LETTERS = "bcd"
SYMBOLS = ("material", "lubricant", "both")
SWEEP = np.linspace(0.6, 1.2, 64)
SINGLE = (0.66, 0.9, 1.1)
"""In the third parametric tongue, in contact loss, and near the upper end."""

_STUDY = Path(__file__).parents[1] / "config" / "paper.yaml"


def sweeps() -> dict[str, list[Problem]]:
    """Return the runs of a sweep for each variant."""
    return _runs(SWEEP)


def singles() -> dict[str, list[Problem]]:
    """Return the runs that are solved one in a call, for each variant."""
    return _runs(SINGLE)


def _runs(frequencies) -> dict[str, list[Problem]]:
    parameters = load_study(_STUDY).pair
    names = [f"{letter}-{symbol}" for letter in LETTERS for symbol in SYMBOLS]
    return {
        name: [parameters.problem(variant(name), float(nu)) for nu in frequencies] for name in names
    }
