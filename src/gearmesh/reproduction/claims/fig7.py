"""Fig. 7: c-□ with both dampings over two mesh periods."""

import math
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.model.stiffness import in_double_contact
from gearmesh.reproduction.claims.evidence import Evidence
from gearmesh.reproduction.claims.fig4 import by_quantity, corners
from gearmesh.reproduction.claims.fig6 import LESS, MORE
from gearmesh.reproduction.frequencies import CROSSING

if TYPE_CHECKING:
    import xarray as xr


def _cases(evidence: Evidence) -> "dict[str, xr.Dataset]":
    return {name: evidence.time_course(name, CROSSING) for name in (LESS, MORE)}


def mesh_phase(case: "xr.Dataset", evidence: Evidence) -> np.ndarray:
    """Return the phase of the mesh period at every sample; 0 is the middle of the C_max pulse."""
    periods = case["time"].values / float(case["mesh_period"])
    return (periods + evidence.pair.initial_phase) % 1.0


def friction_sense(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F7.1: friction in double contact, and the phase at which it changes its sign."""
    found = {}
    for name, case in _cases(evidence).items():
        phase, force = mesh_phase(case, evidence), case["force_friction"].values
        double = in_double_contact(phase, evidence.pair.contact_ratio)
        # A sample on a switch may belong to either side of it, so the outermost samples are left
        # out.
        inner = double & np.roll(double, 1) & np.roll(double, -1)
        turns = np.flatnonzero(force[1:] * force[:-1] < 0)
        scale = np.abs(force).max()
        found[name] = {
            "in double contact": float(np.abs(force[inner]).max() / scale) if scale else math.nan,
            "phase of the change": float(np.median(phase[turns])) if turns.size else math.nan,
        }
    detail = "greatest F_T in double contact, relative to its maximum; phase where F_T changes sign"
    return by_quantity(found), detail


def jumps_of_acceleration(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F7.2: jumps of y'' at the switches and elsewhere."""
    found = {name: corners(case, evidence) for name, case in _cases(evidence).items()}
    return by_quantity(found), "jumps of y'', relative to those that C y causes"


def lag(case: "xr.Dataset", evidence: Evidence) -> float:
    """Return the lag of the first harmonic of y behind that of C, in degrees."""
    turning = np.exp(-2j * np.pi * mesh_phase(case, evidence))
    return float(-np.degrees(np.angle(np.mean(case["y_rel"].values * turning)))) % 360.0


def phase_shift(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F7.3: shift of y against C(t) by damping."""
    lags = {name: lag(case, evidence) for name, case in _cases(evidence).items()}
    shift = (lags[MORE] - lags[LESS] + 180.0) % 360.0 - 180.0
    shown = ", ".join(f"{name} {value:.1f}°" for name, value in lags.items())
    return {"shift": abs(shift)}, f"degrees of the mesh period; lag of y behind C: {shown}"


def loop_height(case: "xr.Dataset") -> float:
    """Return the height of the loop in y_st: the least difference of neighbouring extrema of y.

    Without a loop there are two turning points a period, and the height is 0.
    """
    if float(case["turning_points_per_period"]) < 3.0:
        return 0.0
    return float(np.abs(np.diff(case["extremum_y_rel"].values)).min())


def loop_depends_on_damping(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F7.4: size of the loop with each damping."""
    heights = {name: loop_height(case) for name, case in _cases(evidence).items()}
    ratio = heights[MORE] / heights[LESS]
    return {"5k to k": ratio, **heights}, "height of the loop in y at ν_s = 0.61, in y_st"


MEASURES = {
    "F7.1": friction_sense,
    "F7.2": jumps_of_acceleration,
    "F7.3": phase_shift,
    "F7.4": loop_depends_on_damping,
}
