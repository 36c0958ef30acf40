"""What figures read off a dataset or a case: its scales, its last periods, its switches."""

import json
from dataclasses import dataclass

import numpy as np
import xarray as xr


@dataclass(frozen=True, slots=True)
class Scale:
    """Scales of a dataset or a case.

    Attributes
    ----------
    static_deflection : float
        y_st in mm.
    backlash : float
        s in static deflections.
    kept_periods : int
        Mesh periods that the case keeps.
    first_kept : int
        Number of mesh periods before them.
    damping : float
        k in N s/mm.
    """

    static_deflection: float
    backlash: float
    kept_periods: int
    first_kept: int
    damping: float


def scale(dataset: xr.Dataset) -> Scale:
    """Read the scales from the parameters that `dataset` carries."""
    parameters = json.loads(dataset.attrs["parameters"])
    teeth = parameters["printed"]["teeth"]
    run, assumed = parameters["run"], parameters["assumed"]
    kept = run["kept_revolutions"] * teeth
    return Scale(
        static_deflection=assumed["static_deflection"],
        backlash=assumed["backlash"] / assumed["static_deflection"],
        kept_periods=kept,
        first_kept=run["revolutions"] * teeth - kept,
        damping=parameters["printed"]["damping"],
    )


def last_periods(case: xr.Dataset, periods: int) -> xr.Dataset:
    """Return the time course of the last mesh periods of `case`.

    The result has the coordinate ``period``, the time counted in mesh periods from the start
    of the run.
    """
    kept = scale(case)
    per_period = case.sizes["sample"] // kept.kept_periods
    period = kept.first_kept + np.arange(case.sizes["sample"]) / per_period
    course = case.drop_dims([name for name in case.dims if name != "sample"])
    return course.assign_coords(period=("sample", period)).isel(
        sample=slice(-periods * per_period, None)
    )


def switches(course: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Return the first samples after the switches of C(t).

    Returns
    -------
    tuple of ndarray
        Points A, where C_min gives way to C_max (a pair of teeth comes into mesh), and
        points B, where C_max gives way to C_min: the paper's loops melt into B.
    """
    step = np.diff(course["stiffness"].values)
    return np.flatnonzero(step > 0) + 1, np.flatnonzero(step < 0) + 1


def closed(values: np.ndarray) -> np.ndarray:
    """Return a period's samples with the first one appended, so that its orbit closes."""
    return np.append(values, values[:1])
