"""What a check may look at."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

    from gearmesh.parameters import Parameters


class NotInStudy(LookupError):
    """The study lacks what a claim speaks of: a variant, a frequency, a threshold."""


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """All that the checks of a figure may need; what a figure does not need may be left out.

    Attributes
    ----------
    parameters : Parameters
        The parameters of the study.
    resonance : xarray.Dataset or None
        `results/datasets/resonance.nc`.
    thresholds : mapping
        `results/datasets/thresholds.json`: what `gearmesh.thresholds.locate` returns.
    time_courses : mapping
        (variant, nu) -> case file with its time course, opened with xarray.
    """

    parameters: "Parameters"
    resonance: "xr.Dataset | None" = None
    thresholds: Mapping[str, Any] = field(default_factory=dict)
    time_courses: "Mapping[tuple[str, float], xr.Dataset]" = field(default_factory=dict)
