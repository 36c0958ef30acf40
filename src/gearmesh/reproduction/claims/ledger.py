"""The ledger: what the paper claims, what was found, and whether that was expected."""

import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

from pydantic import Field, field_validator, model_validator
from pydantic_core import PydanticCustomError

from gearmesh.data.writing import write_text
from gearmesh.errors import InputError
from gearmesh.study.reading import yamlfile
from gearmesh.study.reading.schema import Section, shown, validate

Status = Literal["reproduced", "deviates", "not_testable"]

REPRODUCED: Final = "reproduced"
DEVIATES: Final = "deviates"
NOT_TESTABLE: Final = "not_testable"

Kind = Literal["printed number", "threshold", "ordering", "shape"]
Figure = Literal["printed", "fig2", "fig3", "fig4", "fig5", "fig6", "fig7"]


class Bound(Section):
    """A value that is bounded on one side or on both."""

    at_least: float | None = None
    at_most: float | None = None

    @model_validator(mode="after")
    def _bounds_something(self) -> "Bound":
        if self.at_least is None and self.at_most is None:
            raise ValueError("at_least: missing; allowed are at_least, at_most or both")
        low, high = self.at_least, self.at_most
        if low is not None and high is not None and low > high:
            raise ValueError(f"at_least: {low:g} is above at_most, {high:g}")
        return self


Target = float | Bound


def _target(value: object) -> Target:
    if isinstance(value, dict):
        return Bound.model_validate(value)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise PydanticCustomError("target", "allowed is a number, or at_least and at_most")
    return float(value)


class Claim(Section):
    """One statement of the paper, and the result that confirms it.

    `expected` is a number (then `tolerance` limits the error of the measured value), a `Bound`, or
    a mapping from the names of several quantities to such targets.
    """

    id: str = Field(pattern=r"^[A-Z][0-9]+(\.[0-9]+[a-z]?)?$", description="P1, F2.1, ...")
    where: str = Field(min_length=1, description="place in the paper")
    figure: Figure = Field(description="whose notebook checks it; 'printed' for bare numbers")
    quote: str | None = Field(None, description="what the paper says, at most one sentence")
    statement: str = Field(min_length=1, description="the claim in our own words")
    kind: Kind
    expected: Target | dict[str, Target]
    tolerance: float | dict[str, float] | None = None
    tolerance_reason: str | None = None
    expected_status: Status = REPRODUCED
    reason: str | None = Field(None, description="why the expected status is not 'reproduced'")

    @field_validator("expected", mode="before")
    @classmethod
    def _read_targets(cls, value: object) -> object:
        if isinstance(value, dict) and value and not value.keys() & Bound.model_fields.keys():
            return {name: _target(target) for name, target in value.items()}
        return _target(value)

    @model_validator(mode="after")
    def _is_complete(self) -> "Claim":
        if (self.expected_status == REPRODUCED) != (self.reason is None):
            raise ValueError("reason: needed if, and only if, expected_status is not 'reproduced'")
        if isinstance(self.tolerance, dict):
            if not isinstance(self.expected, dict):
                raise ValueError("tolerance: found a mapping; allowed is a number, as for expected")
            for name in self.tolerance.keys() - self.expected.keys():
                raise ValueError(f"tolerance: expected names no quantity {name!r}")
        for name, target, tolerance in self.targets():
            of = f" of {name!r}" if name else ""
            if isinstance(target, Bound) != (tolerance is None):
                raise ValueError(f"tolerance: needed for expected numbers, not for bounds{of}")
            if tolerance is not None and not 0 <= tolerance < math.inf:
                raise ValueError(f"tolerance: found {tolerance:g}{of}; allowed is a number >= 0")
        return self

    def targets(self) -> list[tuple[str, Target, float | None]]:
        """Return (name, target, tolerance) of each quantity; the name is '' for a single one."""
        named = self.expected if isinstance(self.expected, dict) else {"": self.expected}
        of_each: dict[str, float | None] = {}
        if isinstance(self.tolerance, dict):
            of_each |= self.tolerance
        else:
            single = not isinstance(self.expected, dict)
            of_each |= {
                name: self.tolerance
                for name, target in named.items()
                if single or not isinstance(target, Bound)
            }
        return [(name, target, of_each.get(name)) for name, target in named.items()]


class Entry(Claim):
    """A claim with what was found.

    `mechanism` names the orbit that explains the claim, if one does. `judged` is false if something
    that the claim is about is missing in the study (a smoke study has few variants). The status is
    then 'not_testable', and the claim counts neither for nor against.
    """

    measured: Any = None
    status: Status
    detail: str = ""
    judged: bool = True
    mechanism: str | None = None

    @property
    def unexpected(self) -> bool:
        """Whether the status is another one than the ledger expects."""
        return self.judged and self.status != self.expected_status

    def as_json(self) -> dict[str, Any]:
        """Return the entry in the form of `results/claims.json`."""
        optional = {"quote", "tolerance_reason", "reason", "mechanism"}
        found = self.model_dump(mode="json")
        return {
            key: _rounded(value)
            for key, value in found.items()
            if not (key in optional and value is None)
        }


def _rounded(value: Any) -> Any:
    """Cut numbers to the six digits that a threshold can have; not-a-number becomes null."""
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items() if key is not None}
    if isinstance(value, list | tuple):
        return [_rounded(item) for item in value]
    if isinstance(value, float):
        return float(f"{value:.6g}") if math.isfinite(value) else None
    return value


def _satisfies(value: Any, target: Target, tolerance: float | None) -> bool:
    if isinstance(value, Mapping):
        return bool(value) and all(_satisfies(v, target, tolerance) for v in value.values())
    if value is None or not math.isfinite(value):
        return False
    if isinstance(target, Bound):
        low = -math.inf if target.at_least is None else target.at_least
        high = math.inf if target.at_most is None else target.at_most
        return low <= value <= high
    # A measured value at the limit must not fail because of rounding.
    return tolerance is not None and abs(value - target) <= tolerance * (1 + 1e-9)


def holds(claim: Claim, measured: Any) -> bool:
    """Return whether the measured value agrees with the claim, within its tolerance.

    Parameters
    ----------
    claim : Claim
    measured : number or None, or a mapping from variants to these
        Where `claim.expected` names several quantities, a mapping from their names to such
        values. Every one must fit; a missing value (None, not a number, empty) does not fit.
    """
    named = measured if isinstance(claim.expected, dict) else {"": measured}
    return all(
        _satisfies(named.get(name), target, tolerance)
        for name, target, tolerance in claim.targets()
    )


def load_ledger(path: Path) -> list[Claim]:
    """Read and check `config/claims.yaml`: a mapping from the id of a claim to its other keys.

    Raises
    ------
    InputError
        One line that names the file, the claim and the key.
    """
    content = yamlfile.read_mapping(Path(path))
    claims = []
    for name, claim in content.items():
        if not isinstance(claim, dict):
            raise InputError(f"{path}: {name}: found {shown(claim)}; allowed is a mapping of keys")
        if "id" in claim:
            raise InputError(f"{path}: {name}: id: unknown key; {name} is the id")
        claims.append(validate(Claim, {"id": name} | claim, f"{path}: {name}", {}))
    return claims


def write_entries(path: Path, entries: Iterable[Entry]) -> None:
    """Write entries as JSON, the same bytes for the same entries."""
    content = json.dumps([entry.as_json() for entry in entries], indent=1, ensure_ascii=False)
    write_text(Path(path), content + "\n")


def read_entries(path: Path) -> list[Entry]:
    """Read what `write_entries` wrote.

    Raises
    ------
    InputError
        If the file is missing, cut short or not a list of entries.
    """
    try:
        content = json.loads(Path(path).read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: not a file of checked claims ({error})") from None
    if not isinstance(content, list):
        raise InputError(f"{path}: found {shown(content)}: allowed is a list of checked claims")
    return [validate(Entry, item, str(path), {}) for item in content]


def collect(
    ledger: Iterable[Claim],
    checks: Iterable[Path],
    output: Path,
    mechanisms: Mapping[str, str] | None = None,
) -> list[Entry]:
    """Put the checks of all figures together, in the order of the ledger, as `results/claims.json`.

    `mechanisms` are the orbits that explain claims, by their ids.

    A claim that is missing in all files (because its notebook failed before the check) is entered
    as 'not_testable', and is judged: it is unexpected unless the ledger expects it.
    """
    found = {entry.id: entry for path in checks for entry in read_entries(path)}
    entries = [
        found.get(claim.id)
        or Entry(**claim.model_dump(), status=NOT_TESTABLE, detail="was not checked")
        for claim in ledger
    ]
    known = mechanisms or {}
    entries = [entry.model_copy(update={"mechanism": known.get(entry.id)}) for entry in entries]
    write_entries(output, entries)
    return entries


@dataclass(frozen=True)
class Verdict:
    """Result of the ledger."""

    reproduced: int
    deviates: int
    not_testable: int
    unexpected: tuple[Entry, ...]

    def __str__(self) -> str:
        """Return the last lines of a run: the counts, and every unexpected status."""
        lines = [
            f"claims: {self.reproduced} reproduced, {self.deviates} deviating, "
            f"{self.not_testable} not testable"
        ]
        lines += [
            f"  unexpected: {entry.id} is {entry.status}, expected {entry.expected_status}"
            for entry in self.unexpected
        ]
        return "\n".join(lines)


def verdict(entries: Iterable[Entry]) -> Verdict:
    """Count the statuses and name the entries whose status the ledger does not expect."""
    entries = list(entries)
    counts = Counter(entry.status for entry in entries)
    return Verdict(
        reproduced=counts[REPRODUCED],
        deviates=counts[DEVIATES],
        not_testable=counts[NOT_TESTABLE],
        unexpected=tuple(entry for entry in entries if entry.unexpected),
    )
