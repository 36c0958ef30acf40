"""The frequencies at which branches are drawn: the grids of the study and of the atlas."""

from pathlib import Path

import numpy as np

from gearmesh.study.loading import load_study

_CONFIG = Path(__file__).parents[2] / "config"

STUDY, ATLAS = "paper", "atlas"


def frequencies(study: str) -> np.ndarray:
    """Return the grid of a study in `config`, ascending."""
    return load_study(_CONFIG / f"{study}.yaml").nu
