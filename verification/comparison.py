"""A case file beside what heyoka gives for the same run."""

from dataclasses import dataclass
from pathlib import Path

import netCDF4
import numpy as np

from verification.runs import (
    CONTACT_LOSS,
    INVERSE_MESH,
    SAMPLES_PER_PERIOD,
    Outcome,
    acceleration,
)
from verification.statement import Run

DISPLACEMENT = 1e-9
"""How far the second run of each case starts from the first, in y_st."""

SENSITIVE = 1e3
"""An orbit that amplifies a displacement more than this is sensitive."""

BOUND = 1e-6
"""Allowed difference: y_st for lengths, T for times, C_s for stiffnesses, F_st for forces."""

NOT_COMPARED = {"y_max_error", "y_min_error", "sensitive", "status"}
"""What describes the integration of the file and not the motion (with the twins in y_st)."""


@dataclass(frozen=True)
class Comparison:
    """One case, compared.

    Attributes
    ----------
    variant : str
        Its name.
    nu : float
        Mesh frequency ν_s.
    differences : dict of str to float
        Greatest difference of each variable of the file; infinite if sizes or kinds differ.
    amplification : float
        How much the orbit amplifies a displacement of its start, at the stroboscopic points.
    sensitive : bool
        Whether it amplifies so much that its end cannot be compared.
    comparable : int
        Mesh periods after which the amplification exceeds `SENSITIVE`; all if it never does.
    early : float
        Greatest difference of the stroboscopic points of these periods.
    flagged : bool
        Whether the file calls the orbit sensitive.
    unknown : tuple of str
        Variables of the file that are not known here, and not compared.
    problems : tuple of str
        What cannot be expressed as a difference: a status, a missing variable.
    """

    variant: str
    nu: float
    differences: dict[str, float]
    amplification: float
    sensitive: bool
    comparable: int
    early: float
    flagged: bool
    unknown: tuple[str, ...]
    problems: tuple[str, ...]

    @property
    def faults(self) -> list[str]:
        """What does not agree, of all that can be compared."""
        compared = {"early strobes": self.early} if self.sensitive else self.differences
        beyond = [f"{name}: {value:.1e}" for name, value in compared.items() if value > BOUND]
        return [*self.problems, *beyond]


def compare(path: Path, run: Run, outcome: Outcome, displaced: Outcome) -> Comparison:
    """Compare a case file with the outcome of its run, and with that of the displaced run."""
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        found = {name: np.asarray(variable[...]) for name, variable in file.variables.items()}
        flags = file["status"].flag_meanings.split()
    expected = _expected(run, outcome)
    known = {name for name in found if name.removesuffix("_rel") not in NOT_COMPARED}
    problems = [f"{name}: missing" for name in expected if name not in found]
    status = flags[int(found["status"])]
    problems += [f"status: {status}"] if status != "ok" else []
    scales = _scales(run)
    differences = {
        name: _difference(found[name], values) / scales.get(name, 1.0)
        for name, values in expected.items()
        if name in found
    }
    grown = np.maximum.accumulate(_apart(run, outcome, displaced)) / DISPLACEMENT
    extremes = _extremes_apart(outcome, displaced)
    comparable = int(np.searchsorted(grown, SENSITIVE, side="right")) - 1
    early = slice(0, comparable + 1)
    strobes = [
        np.abs(found[name][early] - expected[name][early]).max()
        for name in ("strobe_y_rel", "strobe_v_rel")
    ]
    return Comparison(
        variant=run.variant,
        nu=run.nu,
        differences=differences,
        amplification=float(grown[-1]),
        sensitive=bool(grown[-1] > SENSITIVE or extremes > SENSITIVE * DISPLACEMENT),
        comparable=comparable,
        early=float(max(strobes)),
        flagged=bool(found["sensitive"] == 1),
        unknown=tuple(sorted(known - {*expected})),
        problems=tuple(problems),
    )


def _apart(run: Run, outcome: Outcome, displaced: Outcome) -> np.ndarray:
    """Return the distance of two runs at each boundary, in y_st and y_st Ω_s."""
    distance = np.abs(outcome.strobes - displaced.strobes) * [1.0, run.velocity]
    return distance.max(axis=1)


def _extremes_apart(outcome: Outcome, displaced: Outcome) -> float:
    """Return the distance of the turning points of two runs; infinite if their number differs."""
    here, there = ([y for _, y, _ in found.extrema] for found in (outcome, displaced))
    return _difference(np.array(here), np.array(there))


def _difference(found: np.ndarray, expected: np.ndarray) -> float:
    if found.shape != expected.shape:
        return float("inf")
    greatest = float(np.abs(found.astype(float) - expected).max(initial=0.0))
    return greatest if np.isfinite(greatest) else float("inf")


def _expected(run: Run, outcome: Outcome) -> dict[str, np.ndarray]:
    """Return the variables of the case file, in its units."""
    times, heights, kinds = (
        np.array(column) for column in (zip(*outcome.extrema, strict=True) or ((), (), ()))
    )
    lengths = {
        "extremum_y": heights,
        "strobe_y": outcome.strobes[:, 0],
        "strobe_v": outcome.strobes[:, 1] * run.velocity,
        "y_rms": np.sqrt(outcome.mean_square),
    }
    others = {
        "extremum_time": times * run.period,
        "extremum_kind": kinds,
        "contact_loss_fraction": np.array(outcome.shares[CONTACT_LOSS]),
        "inverse_mesh_fraction": np.array(outcome.shares[INVERSE_MESH]),
        "n_contact_losses": np.array(outcome.losses),
        "turning_points_per_period": np.array(len(outcome.extrema) / run.teeth),
        "mesh_period": np.array(run.period),
    }
    ends = outcome.strobes[[-1 - run.teeth, -1], 0]
    lengths["y_max"] = np.max([*heights, *ends])
    lengths["y_min"] = np.min([*heights, *ends])
    if outcome.samples is not None:
        more, forces = _time_course(run, outcome.samples)
        lengths |= more
        others |= forces
    for name, values in lengths.items():
        others[name] = values * run.deflection
        others[f"{name}_rel"] = values
    return others


def _time_course(
    run: Run, samples: np.ndarray
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return the lengths and the other variables of a time course."""
    y, w, body, body_rate = samples.T
    n = np.arange(y.size)
    phase = (n % SAMPLES_PER_PERIOD) / SAMPLES_PER_PERIOD
    piece = np.searchsorted([piece.start for piece in run.pieces], phase, side="right") - 1
    stiffness = np.array([part.stiffness for part in run.pieces])[piece] / run.load
    gamma = np.array([part.gamma for part in run.pieces])[piece]
    regime = np.where(y > 0.0, 1, np.where(y > -run.backlash, CONTACT_LOSS, INVERSE_MESH))
    depth = np.where(regime == 1, y, 0.0) + np.where(regime == -1, y + run.backlash, 0.0)
    force = run.stiffness_mean * run.deflection
    forces = {
        "time": (run.periods - run.teeth + n / SAMPLES_PER_PERIOD) * run.period,
        "stiffness": stiffness * run.stiffness_mean,
        "modified_stiffness": stiffness * run.stiffness_mean * (regime != CONTACT_LOSS),
        "force_dynamic": stiffness * y * force,
        "force_friction": -run.friction_coefficient * gamma * stiffness * depth * force,
        "regime": regime,
    }
    accelerations = acceleration(run, piece, regime, (y, w, body, body_rate))
    lengths = {"y": y, "v": w * run.velocity, "a": accelerations * run.velocity**2}
    return lengths, forces


def _scales(run: Run) -> dict[str, float]:
    """Return the units in which differences of variables of a case file count."""
    lengths = ("extremum_y", "strobe_y", "strobe_v", "y_rms", "y_max", "y_min", "y", "v", "a")
    times = ("extremum_time", "mesh_period", "time")
    force = run.stiffness_mean * run.deflection
    return {
        **dict.fromkeys(lengths, run.deflection),
        **dict.fromkeys(times, run.period),
        **dict.fromkeys(("stiffness", "modified_stiffness"), run.stiffness_mean),
        **dict.fromkeys(("force_dynamic", "force_friction"), force),
    }
