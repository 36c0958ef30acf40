"""What figures need from a dataset or a case: its scales, its last periods, its switches."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from gearmesh.data import paths
from gearmesh.data.datasets import open_dataset

TimeCourses = dict[tuple[str, float], xr.Dataset]
"""(variant, nu_s) -> case with its time course."""


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
    damping : float
        k in N s/mm.
    """

    static_deflection: float
    backlash: float
    kept_periods: int
    damping: float


def scale(dataset: xr.Dataset) -> Scale:
    """Read the scales from the parameters that `dataset` carries."""
    parameters = json.loads(dataset.attrs["parameters"])
    y_st = parameters["static_deflection"]
    return Scale(
        static_deflection=y_st,
        backlash=parameters["backlash"] / y_st,
        kept_periods=parameters["kept_revolutions"] * int(np.ravel(parameters["teeth"])[0]),
        damping=parameters["damping"],
    )


def present(dataset: xr.Dataset, variants: Iterable[str], variable: str) -> list[str]:
    """Return the `variants` for which `dataset` has at least one value of `variable`."""
    known = [name for name in variants if name in dataset["variant"].values]
    return [name for name in known if bool(dataset[variable].sel(variant=name).notnull().any())]


def read_time_courses(
    folder: Path | str, time_courses: Mapping[str, Iterable[float]], *variants: str
) -> TimeCourses:
    """Read the cases of `variants` that have a time course.

    Parameters
    ----------
    folder : Path or str
        Place of the case files, ``results/cases``.
    time_courses : mapping
        The configuration's ``study.time_courses``: variant -> ν_s.
    *variants : str
        Names of the variants that are wanted.

    Returns
    -------
    dict
        (variant, nu_s) -> dataset. A case that could not be integrated is left out.

    Raises
    ------
    InputError
        If a file is missing or damaged.
    """
    courses = {}
    for name in variants:
        for nu in time_courses.get(name, ()):
            case = open_dataset(Path(folder) / paths.case_name(name, nu))
            if case.sizes.get("sample"):
                courses[name, nu] = case
    return courses


def by_nu(courses: TimeCourses, variant: str) -> dict[float, xr.Dataset]:
    """Return the cases of one variant by their ν_s, in ascending order."""
    return {
        nu: case
        for (name, nu), case in sorted(courses.items(), key=lambda item: item[0])
        if name == variant
    }


def last_periods(case: xr.Dataset, periods: int) -> xr.Dataset:
    """Return the time course of the last mesh periods of `case`.

    The result has the coordinate ``period``, the time counted in mesh periods from the start
    of the run.
    """
    per_period = case.sizes["sample"] // scale(case).kept_periods
    period = case["time"].values / float(case["mesh_period"])
    course = case.drop_dims([name for name in case.dims if name != "sample"])
    return course.assign_coords(period=("sample", period)).isel(
        sample=slice(-periods * per_period, None)
    )


def switches(course: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Return the first samples after the switches of C(t).

    Parameters
    ----------
    course : xarray.Dataset
        Time course of whole mesh periods: a switch may fall on the first sample.

    Returns
    -------
    tuple of ndarray
        Points A, where C_min gives way to C_max (a pair of teeth comes into mesh), and points B,
        where C_max gives way to C_min. The loops of the paper shrink to B.
    """
    stiffness = course["stiffness"].values
    step = stiffness - np.roll(stiffness, 1)
    return np.flatnonzero(step > 0), np.flatnonzero(step < 0)


def closed(values: np.ndarray) -> np.ndarray:
    """Return a period's samples with the first one appended, so that its orbit closes."""
    return np.append(values, values[:1])
