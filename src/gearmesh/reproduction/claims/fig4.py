"""Fig. 4: steady and heterodyne motion of c-•, and the corners A and B."""

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.model.contact import NORMAL_MESH
from gearmesh.reproduction.claims.evidence import Evidence
from gearmesh.reproduction.claims.fig2 import LUBRICANT
from gearmesh.reproduction.thresholds import STROBED_AT

if TYPE_CHECKING:
    import xarray as xr


def steadiness(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F4.1: spread of the stroboscopic points at the three tunings."""
    spread = evidence.located("strobe_spread", ["c-lubricant"])["c-lubricant"]
    return spread, "spread of the stroboscopic points of the kept revolution, in y_st"


def corners(case: "xr.Dataset", evidence: Evidence) -> dict[str, float]:
    """Measure the jumps of y'' in normal mesh: changes between samples beyond the trend beside.

    Returns
    -------
    dict
        ``at the switches``: jumps of y'' there, as a multiple of what the jump of C y makes;
        ``elsewhere``: the greatest jump elsewhere, relative to the typical one at the switches.
    """
    pair = evidence.pair
    y, steps = case["y_rel"].values, np.diff(case["a_rel"].values)
    stiffening = np.diff(case["stiffness"].values) / pair.stiffness_mean
    meshing = np.convolve(case["regime"].values == NORMAL_MESH, np.ones(4), "valid") == 4
    switching = stiffening != 0
    found = steps[1:-1] - (steps[:-2] + steps[2:]) / 2
    at_switch = meshing & switching[1:-1]
    beside = meshing & ~(switching[:-2] | switching[1:-1] | switching[2:])
    if not at_switch.any() or not beside.any():
        return {"at the switches": np.nan, "elsewhere": np.nan}
    # A force on the mesh line moves the wheels by turning them and the bodies by pushing them.
    mobility = 1 + 2 * pair.reduced_mass / pair.body_mass
    due = -mobility * (stiffening * (y[1:] + y[:-1]) / 2)[1:-1][at_switch]
    jump = found[at_switch]
    return {
        "at the switches": float(np.sum(jump * np.sign(due)) / np.sum(np.abs(due))),
        "elsewhere": float(np.abs(found[beside]).max() / np.median(np.abs(jump))),
    }


def by_quantity(measured: dict[str, dict[str, float]]) -> dict[str, dict[str, float]]:
    """Turn case -> quantity -> value into quantity -> case -> value."""
    quantities = next(iter(measured.values()))
    return {q: {name: values[q] for name, values in measured.items()} for q in quantities}


def phase_plane_corners(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F4.2: corners of c-• stand at the switches."""
    found = {
        f"{nu:.2f}": corners(evidence.time_course("c-lubricant", nu), evidence) for nu in STROBED_AT
    }
    return by_quantity(found), "jumps of y'' in normal mesh, as multiples of the jump of C y"


def bifurcation_is_heterodyne(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F4.3: the split of the maxima begins where the motion ceases to be steady."""
    strobes = evidence.located("onset_strobes", LUBRICANT)
    maxima = evidence.located("onset_maxima", LUBRICANT)
    apart = {name: abs(strobes[name] - maxima[name]) for name in LUBRICANT}
    return apart, "distance in ν_s between the onsets of spread of the strobes and of the maxima"


MEASURES = {
    "F4.1": steadiness,
    "F4.2": phase_plane_corners,
    "F4.3": bifurcation_is_heterodyne,
}
