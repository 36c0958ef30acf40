"""The mesh frequencies ν_s of a study: a grid, single values, or both."""

from decimal import Decimal
from functools import cached_property
from typing import Annotated, Self

from pydantic import BeforeValidator, Field, model_validator

from gearmesh.study.reading import units
from gearmesh.study.reading.schema import Section, quantity

NU_DECIMALS = 10
"""Greatest number of decimals of a frequency."""

NU_MIN, NU_MAX = 0.01, 10.0
MAX_CASES = 200_000


def read_nu(value: object) -> float:
    """Read a frequency, rounded to `NU_DECIMALS`; raises ValueError with what is allowed."""
    number = units.parse(value, "1")
    if not NU_MIN <= number <= NU_MAX:
        raise ValueError(f"out of range; allowed is {NU_MIN:g} to {NU_MAX:g}")
    return float(_decimal(number))


def _decimal(nu: float) -> Decimal:
    return Decimal(repr(nu)).quantize(Decimal(1).scaleb(-NU_DECIMALS))


def grid(start: float, stop: float, step: float) -> list[float]:
    """Return start, start + step, … up to stop, without binary rounding: the sums are decimal.

    Raises
    ------
    ValueError
        If there are more than `MAX_CASES`; the message begins with ``step:``.
    """
    low, high, by = (Decimal(repr(number)) for number in (start, stop, step))
    count = int((high - low) / by) + 1
    if count > MAX_CASES:
        raise ValueError(f"step: makes {count} frequencies; allowed are at most {MAX_CASES}")
    return [float(low + i * by) for i in range(count)]


Nu = Annotated[float, BeforeValidator(read_nu)]


class Frequencies(Section):
    """Frequencies ν_s: a grid, single values, or both."""

    start: Nu | None = Field(None, description="first frequency of the grid")
    stop: Nu | None = Field(None, description="upper limit of the grid")
    step: float | None = quantity("1", "Δν", "step of the grid", 1e-9, 1.0, default=None)
    values: tuple[Nu, ...] = Field((), description="further frequencies")

    @model_validator(mode="after")
    def _is_a_set_of_frequencies(self) -> Self:
        ends = {"start": self.start, "stop": self.stop, "step": self.step}
        missing = [name for name, value in ends.items() if value is None]
        if len(missing) in (1, 2):
            raise ValueError(f"{missing[0]}: missing; a grid has start, stop and step")
        if missing and not self.values:
            raise ValueError("values: missing; allowed are start, stop and step, values, or both")
        if self.start is not None and self.stop is not None and self.stop < self.start:
            raise ValueError(
                f"stop: found {self.stop:g}, below start; allowed is {self.start:g} to {NU_MAX:g}"
            )
        seen = set(self._grid())
        count = len(seen) + len(self.values)
        if count > MAX_CASES:
            raise ValueError(f"values: make {count} frequencies; allowed are at most {MAX_CASES}")
        for nu in self.values:
            if nu in seen:
                raise ValueError(f"values: found {nu:g} twice, or on the grid too; allowed is once")
            seen.add(nu)
        return self

    def _grid(self) -> list[float]:
        if self.start is None or self.stop is None or self.step is None:
            return []
        return [float(_decimal(nu)) for nu in grid(self.start, self.stop, self.step)]

    @cached_property
    def all(self) -> tuple[float, ...]:
        """All frequencies, ascending."""
        return tuple(sorted([*self._grid(), *self.values]))
