"""A study: a pair, its variants and mesh frequencies, and the cases that follow from them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, field_validator, model_validator

from gearmesh.errors import InputError
from gearmesh.model.variants import VARIANTS, Variant, variant
from gearmesh.study.frequencies import MAX_CASES, Frequencies, Nu
from gearmesh.study.pair import Pair
from gearmesh.study.parameters import MOST_SWEPT_SAMPLES
from gearmesh.study.reading.schema import Section, nearest, quantity


def _read_variant(value: object) -> str:
    if not isinstance(value, str) or value not in VARIANTS:
        hint = nearest(str(value), VARIANTS) or f"; allowed are {', '.join(VARIANTS)}"
        raise ValueError(f"unknown variant{hint}")
    return value


def _check_each_once(variants: Sequence[str]) -> None:
    if not variants:
        raise ValueError("variants: found none; allowed are names of Tab. 1")
    for name in variants:
        if variants.count(name) > 1:
            raise ValueError(f"variants: found {name} twice; allowed is once")


VariantName = Annotated[str, BeforeValidator(_read_variant)]


class StrongDamping(Section):
    """One of the variants, repeated with its damping multiplied by a factor."""

    variant: VariantName = Field(description="the variant")
    factor: float = quantity("1", "k'/k", "factor on the damping", 1e-3, 1e3)
    nu: Frequencies = Field(description="its frequencies")

    @model_validator(mode="after")
    def _is_another_variant(self) -> Self:
        if self.strong_variant.name in VARIANTS:
            raise ValueError(f"factor: found {self.factor:g}; allowed is any other than 1")
        if self.strong_variant.powers_label == "":
            raise ValueError(f"variant: found {self.variant}; allowed is a variant with damping")
        return self

    @property
    def strong_variant(self) -> Variant:
        """The variant with its factor."""
        return replace(variant(self.variant), factor=self.factor)


class Mechanisms(Section):
    """The orbits and attractors that are computed behind the response curves."""

    variants: tuple[VariantName, ...] = Field(description="the variants whose orbits are followed")
    resolution: int = quantity(
        "1", "n", "points along each axis of basins and maps", 2, 1000, default=64
    )

    @model_validator(mode="after")
    def _names_each_variant_once(self) -> Self:
        _check_each_once(self.variants)
        return self


class Plan(Section):
    """The cases of a study, and the files that are written."""

    title: str = Field(description="one line", min_length=1, max_length=200)
    claims: str | None = Field(
        None, description="ledger of claims that the study is checked against, beside this file"
    )
    nu: Frequencies = Field(description="the mesh frequencies ν_s of all variants")
    variants: tuple[VariantName, ...] = Field(description="names of Tab. 1, or all")
    direction: Literal["up", "down"] | None = Field(
        None,
        description="whether each run starts from the end of the run at the next frequency",
    )
    strong_damping: StrongDamping | None = Field(None, description="a more damped variant")
    time_courses: dict[str, tuple[Nu, ...]] = Field(
        default_factory=dict, description="frequencies with a time course, for each variant"
    )
    mechanisms: Mechanisms | None = Field(
        None, description="orbits and attractors behind the response curves; none if left out"
    )
    loads: bool = Field(
        False, description="whether the files hold tooth forces and transmission errors, too"
    )
    case_files: bool = Field(
        True, description="whether cases without a time course have files of their own too"
    )

    @field_validator("variants", mode="before")
    @classmethod
    def _all_variants(cls, value: object) -> object:
        if value == "all":
            return tuple(VARIANTS)
        if isinstance(value, str):
            raise ValueError("allowed is a list of variants, or all")
        return value

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        _check_each_once(self.variants)
        if self.mechanisms is not None:
            for name in self.mechanisms.variants:
                if name not in self.variants:
                    raise ValueError(
                        f"mechanisms.variants: found {name}, which is not computed; allowed are "
                        f"{', '.join(self.variants)}"
                    )
        count = sum(len(nus) for _, nus in self.frequencies())
        if count > MAX_CASES:
            raise ValueError(f"nu: makes {count} cases; allowed are at most {MAX_CASES}")
        spans = self.spans()
        for name, nus in self.time_courses.items():
            if name not in spans:
                hint = nearest(name, spans) or f"; allowed are {', '.join(spans)}"
                raise ValueError(f"time_courses.{name}: this variant is not computed{hint}")
            low, high = spans[name]
            for nu in nus:
                if nus.count(nu) > 1:
                    raise ValueError(f"time_courses.{name}: found {nu:g} twice; allowed is once")
                if not low <= nu <= high:
                    raise ValueError(
                        f"time_courses.{name}: found {nu:g}; allowed is {low:g} to {high:g}"
                    )
        return self

    def frequencies(self) -> list[tuple[Variant, tuple[float, ...]]]:
        """Return the variants, each with its frequencies; time courses are not included."""
        pairs = [(variant(name), self.nu.all) for name in self.variants]
        if self.strong_damping is not None:
            pairs.append((self.strong_damping.strong_variant, self.strong_damping.nu.all))
        return pairs

    def spans(self) -> dict[str, tuple[float, float]]:
        """Return the lowest and the highest frequency of each variant, by its name."""
        return {variant.name: (nus[0], nus[-1]) for variant, nus in self.frequencies()}


@dataclass(frozen=True, slots=True)
class Case:
    """One run of a study.

    Attributes
    ----------
    variant : Variant
        Which damping terms act where.
    nu : float
        Mesh frequency ν_s.
    time_course : bool
        Whether its file holds the time course.
    direction : {"up", "down"}, optional
        In a sweep, the direction in which runs follow one another.
    loads : bool
        Whether its file holds what engineers report of a run.
    """

    variant: Variant
    nu: float
    time_course: bool = False
    direction: str | None = None
    loads: bool = False


@dataclass(frozen=True)
class Study:
    """A study as its file states it.

    Attributes
    ----------
    name : str
        Its name, which is that of its folder of results.
    path : Path
        The file.
    pair : Pair
        The gear pair, and the settings of its runs.
    plan : Plan
        All other keys of the file.
    """

    name: str
    path: Path
    pair: Pair
    plan: Plan

    @property
    def title(self) -> str:
        """Title of the study."""
        return self.plan.title

    @property
    def claims(self) -> Path | None:
        """The ledger of claims that the study is checked against, if there is one."""
        return None if self.plan.claims is None else self.path.parent / self.plan.claims

    @property
    def ledger(self) -> Path:
        """The ledger of claims; the pipeline asks for it only if the study has one."""
        if self.claims is None:
            raise InputError(f"{self.path}: claims: missing; expected: a ledger of claims")
        return self.claims

    @property
    def nu(self) -> np.ndarray:
        """Mesh frequencies ν_s of all variants, ascending, shape (n,)."""
        return np.array(self.plan.nu.all)

    @property
    def variants(self) -> tuple[str, ...]:
        """Names of all variants, the more damped one included."""
        return tuple(variant.name for variant, _ in self.plan.frequencies())

    @property
    def time_courses(self) -> Mapping[str, tuple[float, ...]]:
        """Frequencies with a time course, for each variant that has some."""
        return self.plan.time_courses

    @cached_property
    def cases(self) -> tuple[Case, ...]:
        """All cases, variant by variant, each with ascending frequencies.

        A frequency with a time course is a case of its variant even if it is not on the grid.
        """
        return tuple(self._cases(self.plan.frequencies()))

    @property
    def letters(self) -> list[str]:
        """The letters of Tab. 1 of which the study has variants."""
        return list(dict.fromkeys(variant.letter for variant, _ in self.plan.frequencies()))

    def of_letter(self, letter: str) -> list[Case]:
        """Return the cases of a letter of Tab. 1, in their order."""
        plan = self.plan.frequencies()
        return list(self._cases(part for part in plan if part[0].letter == letter))

    def check_samples(self) -> None:
        """Raise InputError if the cases of a letter, which are one job, keep too many samples.

        A job keeps the samples of time courses; a sweep with loads keeps those of all its runs.
        """
        swept = self.plan.loads and self.plan.direction is not None
        for letter in self.letters:
            runs = sum(case.time_course or swept for case in self.of_letter(letter))
            samples = runs * self.pair.kept_samples
            if samples > MOST_SWEPT_SAMPLES:
                raise InputError(
                    f"{self.path}: {'loads' if swept else 'time_courses'}: found {runs} runs of "
                    f"letter {letter}, which keep {samples} samples; allowed are at most "
                    f"{MOST_SWEPT_SAMPLES}; keep fewer revolutions, or lower samples_per_period"
                )

    def _cases(self, plan: Iterable[tuple[Variant, tuple[float, ...]]]) -> Iterator[Case]:
        for chosen, nus in plan:
            courses = set(self.time_courses.get(chosen.name, ()))
            for nu in sorted({*nus, *courses}):
                yield Case(chosen, nu, nu in courses, self.plan.direction, self.plan.loads)

    def has_file(self, case: Case) -> bool:
        """Return whether a case has a file of its own; one with a time course always has."""
        return self.plan.case_files or case.time_course
