"""A study as a configuration file states it: parameters, frequencies, variants, cases.

`load_study` reads YAML (`gearmesh.study.yamlfile`), follows `base:`, applies ``--set`` overrides
and checks everything; each slip becomes one line. Nothing in a configuration is evaluated.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from pathlib import Path
from typing import Annotated, Self

from pydantic import BeforeValidator, Field, field_validator, model_validator

from gearmesh.errors import InputError
from gearmesh.model.variants import VARIANTS, Variant, variant
from gearmesh.study import units, yamlfile
from gearmesh.study.parameters import Assumed, Derived, Parameters, Printed, Run, Solver
from gearmesh.study.schema import Section, nearest, quantity, shown, validate

NU_DECIMALS = 10
"""Frequencies are decimal numbers of at most so many decimals."""

NU_MIN, NU_MAX = 0.01, 10.0
MAX_CASES = 200_000
_MAX_BASES = 8


def read_nu(value: object) -> float:
    """Read a frequency, rounded to `NU_DECIMALS`; raises ValueError with what is allowed."""
    number = units.parse(value, "1")
    if not NU_MIN <= number <= NU_MAX:
        raise ValueError(f"out of range; allowed is {NU_MIN:g} to {NU_MAX:g}")
    return float(_decimal(number))


def _decimal(nu: float) -> Decimal:
    return Decimal(repr(nu)).quantize(Decimal(1).scaleb(-NU_DECIMALS))


Nu = Annotated[float, BeforeValidator(read_nu)]


class Frequencies(Section):
    """Frequencies ν_s: a grid, single values, or both."""

    start: Nu | None = Field(None, description="first frequency of the grid")
    stop: Nu | None = Field(None, description="last frequency of the grid, at the most")
    step: float | None = quantity("1", "Δν", "step of the grid", 1e-9, 1.0, default=None)
    values: tuple[Nu, ...] = Field((), description="further frequencies")

    @model_validator(mode="after")
    def _is_a_set_of_frequencies(self) -> Self:
        ends = {"start": self.start, "stop": self.stop, "step": self.step}
        lacking = [name for name, value in ends.items() if value is None]
        if len(lacking) in (1, 2):
            raise ValueError(f"{lacking[0]}: missing; a grid has start, stop and step")
        if lacking and not self.values:
            raise ValueError("values: missing; allowed are start, stop and step, values, or both")
        if not lacking and self.stop < self.start:
            raise ValueError(
                f"stop: found {self.stop:g}, below start; allowed is {self.start:g} to {NU_MAX:g}"
            )
        count = self._count() + len(self.values)
        if count > MAX_CASES:
            raise ValueError(f"step: makes {count} frequencies; allowed are at most {MAX_CASES}")
        seen = set(self._grid())
        for nu in self.values:
            if nu in seen:
                raise ValueError(f"values: found {nu:g} twice, or on the grid too; allowed is once")
            seen.add(nu)
        return self

    def _count(self) -> int:
        if self.step is None:
            return 0
        span = Decimal(repr(self.stop)) - Decimal(repr(self.start))
        return int(span / Decimal(repr(self.step))) + 1

    def _grid(self) -> list[float]:
        if self.step is None:
            return []
        start, step = Decimal(repr(self.start)), Decimal(repr(self.step))
        return [float(_decimal(float(start + i * step))) for i in range(self._count())]

    @cached_property
    def all(self) -> tuple[float, ...]:
        """All frequencies, ascending."""
        return tuple(sorted([*self._grid(), *self.values]))


def _read_variant(value: object) -> str:
    if not isinstance(value, str) or value not in VARIANTS:
        hint = nearest(str(value), VARIANTS) or f"; allowed are {', '.join(VARIANTS)}"
        raise ValueError(f"unknown variant{hint}")
    return value


VariantName = Annotated[str, BeforeValidator(_read_variant)]


class StrongDamping(Section):
    """One variant again with its damping multiplied."""

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


class Plan(Section):
    """Which cases are computed."""

    nu: Frequencies = Field(description="the frequencies ν_s of all variants")
    variants: tuple[VariantName, ...] = Field(description="names of Tab. 1, or all")
    strong_damping: StrongDamping | None = Field(None, description="a more damped variant")
    time_courses: dict[str, tuple[Nu, ...]] = Field(
        default_factory=dict, description="frequencies with a time course, for each variant"
    )
    cases_per_job: int = quantity("1", "", "cases that one job computes, at the most", 1, 100_000)
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
        if not self.variants:
            raise ValueError("variants: found none; allowed are names of Tab. 1, or all")
        for name in self.variants:
            if self.variants.count(name) > 1:
                raise ValueError(f"variants: found {name} twice; allowed is once")
        count = sum(len(nus) for _, nus in self.frequencies())
        if count > MAX_CASES:
            raise ValueError(f"nu: makes {count} cases; allowed are at most {MAX_CASES}")
        spans = {v.name: (nus[0], nus[-1]) for v, nus in self.frequencies()}
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
        """Return the variants, each with its frequencies (time courses apart)."""
        pairs = [(variant(name), self.nu.all) for name in self.variants]
        if self.strong_damping is not None:
            pairs.append((self.strong_damping.strong_variant, self.strong_damping.nu.all))
        return pairs


@dataclass(frozen=True, slots=True)
class Case:
    """One run of the study."""

    variant: Variant
    nu: float
    time_course: bool = False


class Study(Section):
    """A whole configuration."""

    title: str = Field(description="one line", min_length=1, max_length=200)
    printed: Printed = Field(description="the numbers that the paper prints")
    derived: Derived = Field(description="inputs that follow from printed ones")
    assumed: Assumed = Field(description="inputs on which the paper is silent")
    reasons: dict[str, str] = Field(description="a line for every assumed key")
    run: Run = Field(description="length of a run")
    solver: Solver = Field(description="settings of the integration")
    study: Plan = Field(description="frequencies and variants")

    @model_validator(mode="after")
    def _every_assumption_has_a_reason(self) -> Self:
        assumed = Assumed.model_fields
        for name, reason in self.reasons.items():
            if name not in assumed:
                hint = nearest(name, assumed)
                raise ValueError(f"reasons.{name}: no assumed key of this name{hint}")
            if not reason.strip() or "\n" in reason.strip():
                raise ValueError(f"reasons.{name}: found {shown(reason)}; allowed is one line")
        for name in assumed:
            if name not in self.reasons:
                raise ValueError(f"reasons.{name}: missing; every assumed key needs one line")
        return self

    @cached_property
    def parameters(self) -> Parameters:
        """The parameters that all cases share."""
        return Parameters(
            printed=self.printed,
            derived=self.derived,
            assumed=self.assumed,
            run=self.run,
            solver=self.solver,
        )

    def cases(self) -> list[Case]:
        """List all cases, variant by variant, each with ascending frequencies.

        A frequency that has a time course is a case of its variant also where it lies off the
        grid.
        """
        cases = []
        for chosen, nus in self.study.frequencies():
            courses = set(self.study.time_courses.get(chosen.name, ()))
            cases += [Case(chosen, nu, nu in courses) for nu in sorted({*nus, *courses})]
        return cases


def load_study(path: str | Path, overrides: Iterable[str] = ()) -> Study:
    """Read and check a configuration.

    Parameters
    ----------
    path : str or Path
        YAML file; ``base: FILE`` in it names one (relative to it) whose keys it inherits.
    overrides : iterable of str
        ``KEY=VALUE`` with a dotted key, as ``"assumed.backlash=40 um"``.

    Raises
    ------
    InputError
        With one line: file, key, what was found, what is allowed.
    """
    path = Path(path)
    data = _with_bases(path, ())
    changed = {}
    for text in overrides:
        key, value = _override(text)
        _set(data, key.split("."), value, text)
        changed[key] = f"--set {text}"
    _restate_reasons(data, changed)
    return validate(Study, data, str(path), changed)


def _with_bases(path: Path, inheriting: tuple[Path, ...]) -> dict[str, object]:
    """Read a file and merge it over its bases."""
    if path.resolve() in inheriting or len(inheriting) >= _MAX_BASES:
        raise InputError(f"{path}: base: the files inherit in a circle, or more than {_MAX_BASES}")
    data = yamlfile.read_mapping(path)
    base = data.pop("base", None)
    if base is None:
        return data
    if not isinstance(base, str):
        raise InputError(f"{path}: base: found {shown(base)}; allowed is the name of a file")
    inherited = path.parent / base
    try:
        return _merge(_with_bases(inherited, (*inheriting, path.resolve())), data)
    except InputError as error:
        raise InputError(f"{path}: base: {error}" if not inheriting else str(error)) from None


def _merge(base: Mapping[str, object], own: Mapping[str, object]) -> dict[str, object]:
    """Lay `own` over `base`: mappings key by key, all else whole; an empty value removes a key."""
    merged = dict(base)
    for key, value in own.items():
        if value is None:
            merged.pop(key, None)
        elif isinstance(value, Mapping) and isinstance(merged.get(key), Mapping):
            merged[key] = _merge(merged[key], value)
        else:
            merged[key] = value
    return merged


def _override(text: str) -> tuple[str, object]:
    key, equals, value = text.partition("=")
    key = key.strip()
    if not equals or not key or not all(key.split(".")):
        raise InputError(f"--set {text}: allowed is KEY=VALUE, as in assumed.backlash='40 um'")
    return key, yamlfile.read_value(value, f"--set {text}")


def _restate_reasons(data: dict[str, object], changed: Mapping[str, str]) -> None:
    """Let no reason of the file stand beside a value that the command line has replaced."""
    reasons = data.get("reasons")
    if isinstance(reasons, dict):
        for key in changed:
            section, _, name = key.partition(".")
            if section == "assumed" and name in reasons and f"reasons.{name}" not in changed:
                reasons[name] = "set on the command line"


def _set(data: dict[str, object], keys: list[str], value: object, text: str) -> None:
    for key in keys[:-1]:
        data = data.setdefault(key, {})
        if not isinstance(data, dict):
            raise InputError(f"--set {text}: '{key}' is no section, it holds no keys")
    data[keys[-1]] = value
