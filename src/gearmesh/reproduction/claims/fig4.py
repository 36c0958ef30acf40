"""Fig. 4: periodic and quasi-periodic ("heterodyne") motion of c-•, and the corners A and B."""

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.model.contact import NORMAL_MESH
from gearmesh.reproduction.claims.evidence import Evidence
from gearmesh.reproduction.claims.fig2 import LUBRICANT
from gearmesh.reproduction.frequencies import FIG_4
from gearmesh.study.reading.schema import of_wheels

if TYPE_CHECKING:
    import xarray as xr


def stroboscopic_spread(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F4.1: spread of the stroboscopic points at the three frequencies."""
    spread = evidence.located("strobe_spread", ["c-lubricant"])["c-lubricant"]
    return spread, "spread of the stroboscopic points of the kept revolution, in y_st"


def corners(case: "xr.Dataset", evidence: Evidence) -> dict[str, float]:
    """Measure the jumps of y'' in normal mesh.

    A jump is the change between two samples minus the mean of the changes before and after it.

    Returns
    -------
    dict
        ``at the switches``: jumps of y'' there, relative to the jumps that C y causes;
        ``elsewhere``: the greatest jump elsewhere, relative to the median one at the switches.
    """
    pair = evidence.pair
    y, steps = case["y_rel"].values, np.diff(case["a_rel"].values)
    stiffening = np.diff(case["stiffness"].values) / pair.stiffness_mean
    meshing = np.convolve(case["regime"].values == NORMAL_MESH, np.ones(4), "valid") == 4
    switching = stiffening != 0
    jumps = steps[1:-1] - (steps[:-2] + steps[2:]) / 2
    at_switch = meshing & switching[1:-1]
    elsewhere = meshing & ~(switching[:-2] | switching[1:-1] | switching[2:])
    if not at_switch.any() or not elsewhere.any():
        return {"at the switches": np.nan, "elsewhere": np.nan}
    # A force on the mesh line turns the wheels and also pushes their bodies along the line.
    mobility = 1 + sum(pair.reduced_mass / mass for mass in of_wheels(pair.body_mass))
    caused = -mobility * (stiffening * (y[1:] + y[:-1]) / 2)[1:-1][at_switch]
    jump = jumps[at_switch]
    return {
        "at the switches": float(np.sum(jump * np.sign(caused)) / np.sum(np.abs(caused))),
        "elsewhere": float(np.abs(jumps[elsewhere]).max() / np.median(np.abs(jump))),
    }


def by_quantity(measured: dict[str, dict[str, float]]) -> dict[str, dict[str, float]]:
    """Turn (case -> quantity -> value) into (quantity -> case -> value)."""
    quantities = next(iter(measured.values()))
    return {q: {name: values[q] for name, values in measured.items()} for q in quantities}


def phase_plane_corners(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F4.2: corners of c-• at the switches of C(t)."""
    found = {
        f"{nu:.2f}": corners(evidence.time_course("c-lubricant", nu), evidence) for nu in FIG_4
    }
    return by_quantity(found), "jumps of y'' in normal mesh, relative to those that C y causes"


def bifurcation_is_heterodyne(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F4.3: distance in ν_s between the split of the maxima and the end of periodic motion."""
    points = evidence.located("onset_strobes", LUBRICANT)
    maxima = evidence.located("onset_maxima", LUBRICANT)
    apart = {name: abs(points[name] - maxima[name]) for name in LUBRICANT}
    return apart, "distance in ν_s: onset of spread of the maxima, and of the stroboscopic points"


MEASURES = {
    "F4.1": stroboscopic_spread,
    "F4.2": phase_plane_corners,
    "F4.3": bifurcation_is_heterodyne,
}
