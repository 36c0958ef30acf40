"""What `config/identify.yaml` states: ranges of the open parameters, designs, wordings."""

import hashlib
import math
from pathlib import Path
from typing import Literal, Self

from pydantic import Field, field_validator, model_validator

from gearmesh.identification.factors import FACTORS, KINDS
from gearmesh.study.reading import yamlfile
from gearmesh.study.reading.schema import Section, validate


class Range(Section):
    """Plausible range of a factor."""

    low: float
    high: float
    scale: Literal["linear", "log"] = "linear"
    least: float | None = Field(None, description="value that removes the effect, if there is one")
    reason: str = Field(min_length=1, description="why the range ends there")

    @model_validator(mode="after")
    def _is_a_range(self) -> Self:
        ends = (self.low, self.high, self.low if self.least is None else self.least)
        if not all(map(math.isfinite, ends)) or self.low >= self.high:
            raise ValueError(f"low: found {self.low:g}; allowed is less than high, {self.high:g}")
        if self.scale == "log" and self.low <= 0:
            raise ValueError(f"low: found {self.low:g}; allowed is more than 0 on a log scale")
        return self

    def value(self, unit: float) -> float:
        """Return the value at a place `unit` of the unit interval."""
        if self.scale == "log":
            return self.low * (self.high / self.low) ** unit
        return self.low + (self.high - self.low) * unit

    def unit(self, value: float) -> float:
        """Return the place of a value in the unit interval."""
        if self.scale == "log":
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


class Design(Section):
    """A set of samples.

    The factors in `vary` vary. Those in `fixed` have one value, and all others keep the value of
    the study. With `around`, the samples fill the box that the best samples of that design span;
    otherwise they fill the whole space.
    """

    purpose: str = Field(min_length=1)
    points: int = Field(ge=2, le=2**20)
    points_per_job: int = Field(128, gt=0, le=4096)
    seed: int = Field(ge=0)
    vary: tuple[str, ...]
    fixed: dict[str, float | str] = Field(default_factory=dict)
    around: str | None = None
    one_at_a_time: bool = Field(False, description="whether a sample varies one factor only")

    @field_validator("points")
    @classmethod
    def _fills_evenly(cls, points: int) -> int:
        if points & (points - 1):
            raise ValueError(f"found {points}; allowed is a power of 2, for Sobol' points")
        return points

    @model_validator(mode="after")
    def _names_factors(self) -> Self:
        for name in (*self.vary, *self.fixed):
            if name not in FACTORS:
                raise ValueError(f"vary: unknown factor {name!r}; allowed are {', '.join(FACTORS)}")
        if set(self.vary) & set(self.fixed):
            raise ValueError("fixed: names a factor that varies; allowed is one or the other")
        kind = self.fixed.get("kind", KINDS[0])
        if kind not in KINDS:
            raise ValueError(f"fixed.kind: found {kind!r}; allowed are {', '.join(KINDS)}")
        return self

    @property
    def space(self) -> str:
        """The space of its samples: the factors that vary, in order, and the fixed ones."""
        return ", ".join([*self.vary, *(f"{f} = {self.fixed[f]}" for f in sorted(self.fixed))])


class Wording(Section):
    """How exactly the paper's words state a number.

    The weight of a measured value is 1 up to a distance `sure` from the number. From there it falls
    linearly to 0 at the tolerance of the ledger.
    """

    claim: str
    quantity: str
    words: str = Field(min_length=1)
    sure: float = Field(ge=0)
    reason: str = Field(min_length=1)


class Settings(Section):
    """The whole of `config/identify.yaml`."""

    ranges: dict[str, Range]
    designs: dict[str, Design]
    wordings: tuple[Wording, ...]
    together: tuple[tuple[str, ...], ...] = Field(
        (), description="claims that state the same number; they are held out together"
    )

    def sampling(self, name: str) -> str:
        """Return a digest of all that determines the samples of a design and its batches."""
        design = self.designs[name]
        ranges = {
            f: [self.ranges[f].value(place) for place in (0.0, 0.5, 1.0)]
            for f in design.vary
            if f != "kind"
        }
        stated = design.model_dump(exclude={"purpose"}), ranges
        before = self.sampling(design.around) if design.around else ""
        return hashlib.sha256(f"{stated} {before}".encode()).hexdigest()

    @model_validator(mode="after")
    def _is_complete(self) -> Self:
        for name, design in self.designs.items():
            if design.around is not None and design.around not in self.designs:
                raise ValueError(f"designs.{name}.around: no design {design.around!r}")
            for factor in design.vary:
                if factor not in self.ranges and factor != "kind":
                    raise ValueError(f"ranges.{factor}: missing; design {name} varies it")
        return self

    @model_validator(mode="after")
    def _is_made_of_chains(self) -> Self:
        focused = {name: (d, d.around) for name, d in self.designs.items() if d.around is not None}
        followed: dict[str, str] = {}
        for name, (design, around) in focused.items():
            chain, where = [name], f"designs.{name}"
            while (before := self.designs[chain[-1]].around) is not None:
                chain.append(before)
                if before in chain[:-1]:
                    raise ValueError(
                        f"{where}.around: found a circle, {' around '.join(chain)}; "
                        "allowed is a chain that ends at a design around none"
                    )
            if first := followed.get(around):
                raise ValueError(
                    f"{where}.around: found {around!r}, as in {first}; "
                    "allowed is one design around each"
                )
            followed[around] = name
            parent = self.designs[around]
            if design.space != parent.space:  # samples of a chain are weighed as one even design
                raise ValueError(
                    f"{where}.vary, fixed: found {design.space}; "
                    f"allowed is that of {around}: {parent.space}"
                )
        return self


def load_settings(path: str | Path) -> Settings:
    """Read and check the settings.

    Raises
    ------
    InputError
        With one line: file, key, what was found, what is allowed.
    """
    return validate(Settings, yamlfile.read_mapping(Path(path)), str(path), {})
