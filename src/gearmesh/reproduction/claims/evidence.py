"""What the checks read: parameters, located thresholds, time courses."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from gearmesh.study.pair import Pair

if TYPE_CHECKING:
    import xarray as xr


class NotInStudy(LookupError):
    """A variant or a frequency that a claim needs is not in the study."""


class NotLocated(LookupError):
    """A threshold depends on a run that could not be integrated."""


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """All that the checks read. The parts that a figure does not need may be left out.

    Attributes
    ----------
    pair : Pair
        The parameters of the study.
    thresholds : mapping
        What `gearmesh.reproduction.thresholds.locate` returns.
    time_courses : mapping
        (variant, nu) -> case file with its time course, opened with xarray (Figs. 4 and 7).
    """

    pair: Pair
    thresholds: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    time_courses: "Mapping[tuple[str, float], xr.Dataset]" = field(default_factory=dict)

    def located(self, observable: str, names: Iterable[str]) -> dict[str, Any]:
        """Return an observable for each of `names`; not-a-number where it does not exist.

        Raises
        ------
        NotInStudy
            If the observable is missing for one of the names.
        NotLocated
            If the observable depends on a failed run.
        """
        known = self.thresholds.get(observable, {})
        names = list(names)
        missing = [name for name in names if name not in known]
        if missing:
            raise NotInStudy(f"{observable} of {', '.join(missing)}")
        for name in names:
            if isinstance(known[name], Mapping) and "not_located" in known[name]:
                raise NotLocated(f"{observable} of {name}: {known[name]['not_located']}")
        return {name: _as_numbers(known[name]) for name in names}

    def time_course(self, variant: str, nu: float) -> "xr.Dataset":
        """Return a case with its time course; raises NotInStudy if it is missing."""
        for (name, at), case in self.time_courses.items():
            if name == variant and abs(at - nu) < 1e-9 and "y_rel" in case:
                return case
        raise NotInStudy(f"time course of {variant} at {nu:g}")


def _as_numbers(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _as_numbers(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_as_numbers(item) for item in value]
    return math.nan if value is None else value
