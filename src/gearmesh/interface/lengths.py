"""Lengths in mm and in static deflections, as every public dataset gives them."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr


def with_lengths(
    stated: Mapping[str, tuple[tuple[str, ...], Any, str]], static_deflection: float | np.ndarray
) -> xr.Dataset:
    """Return lengths in mm and, with ``_rel`` appended to the name, in static deflections.

    Parameters
    ----------
    stated : dict
        For each name the dimensions, the values in static deflections, and what they are.
    static_deflection : float or ndarray
        In mm; one number, or one for each value.
    """
    dataset = xr.Dataset()
    for name, (dimensions, values, what) in stated.items():
        values = np.asarray(values)
        in_mm = {"units": "mm", "long_name": what}
        relative = {"units": "1", "long_name": f"{what}, in static deflections y_st"}
        dataset[name] = (dimensions, values * static_deflection, in_mm)
        dataset[f"{name}_rel"] = (dimensions, values, relative)
    return dataset
