"""Runs to vary, shared by the tests of the solvers."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from gearmesh.model.problem import Problem
from gearmesh.model.variants import VARIANTS, variant
from gearmesh.study.loading import load_study

PAPER = Path(__file__).parents[1] / "config" / "paper.yaml"
MEAN = 3.28954
POWERS = (0.12336, 0.24672, 0.49344)


def problem(nu=0.7, name="c-lubricant", **changes) -> Problem:
    variant = VARIANTS[name]
    laws = [
        tuple(k if acts else 0.0 for k, acts in zip(POWERS, powers, strict=True))
        for powers in (variant.material_powers, variant.lubricant_powers)
    ]
    plain = Problem(
        nu=nu,
        contact_ratio=1.569,
        stiffness_max=4.0 / MEAN,
        stiffness_min=2.3516 / MEAN,
        material=laws[0],
        lubricant=laws[1],
        backlash=4.0,
        body_mass=32.0,
        bearing_stiffness=1.0,
        bearing_damping_ratio=0.03,
        friction_coefficient=0.05,
        pressure_angle=np.pi / 9,
        teeth=21,
        base_radius=3000.0,
    )
    return replace(plain, **changes)


def of_paper(name: str, nu: float, **changes: object) -> Problem:
    """Return a run of the paper's study with other parameters, in the units of the study."""
    return load_study(PAPER).pair.replace(**changes).problem(variant(name), nu)
