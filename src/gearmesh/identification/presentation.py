"""The findings in words and tables, for the report and for the notebook."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from gearmesh.claims import REPRODUCED, Claim
from gearmesh.identification.design import Sample, stated
from gearmesh.identification.settings import FACTORS, Settings
from gearmesh.parameters import Parameters
from gearmesh.presentation import environment, number

NARROW = 0.6
"""A region shorter than this share of the plausible range says something about a parameter."""


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """Where one parameter may lie, as text."""

    symbol: str
    prior: str
    region: str
    natural: str
    stated: str
    alone: str


@dataclass(frozen=True, slots=True)
class ClaimRow:
    """Where one claim holds."""

    id: str
    statement: str
    share: float
    natural: float
    given: float
    standing: str


def section(
    found: Mapping[str, Any], ledger: Sequence[Claim], settings: Settings, study: Parameters
) -> str:
    """Return the findings as HTML.

    Parameters
    ----------
    found : mapping
        See `gearmesh.identification.table`.
    ledger : sequence of Claim
        What the claims state.
    settings : Settings
        Ranges of the plausible space.
    study : Parameters
        The values of the study, shown beside the regions.
    """
    expected = [claim.id for claim in ledger if claim.expected_status == REPRODUCED]
    bears = {name: most for name, most in found["run-out"].items() if name in expected}
    least = min(bears.values())
    return (
        environment()
        .get_template("identification.html.j2")
        .render(
            found=found,
            regions=found["regions"],
            parameters=list(parameter_rows(found, settings, stated(study))),
            claims=claim_rows(found["claims"], ledger),
            pinned=[FACTORS[name] for name in _pinned(found["regions"]["plausible"])],
            least_run_out=least,
            fragile=[name for name, most in bears.items() if most == least],
        )
    )


def _pinned(regions: Mapping[str, Any]) -> list[str]:
    """Return the parameters that the claims pin down."""
    factors = regions["factors"].items()
    return [name for name, found in factors if found.get("of the prior", 1.0) < NARROW]


def parameter_rows(
    found: Mapping[str, Any], settings: Settings, values: Sample
) -> Iterator[ParameterRow]:
    """Yield a row for each parameter of the plausible space."""
    natural = found["regions"]["natural"]["factors"]
    for name, region in found["regions"]["plausible"]["factors"].items():
        if name == "kind":
            likely = ", ".join(f"{kind} {round(100 * p)} %" for kind, p in region.items())
            yield ParameterRow(FACTORS[name], "any", likely, "separate", str(values[name]), "")
            continue
        bounds = settings.ranges[name]
        yield ParameterRow(
            FACTORS[name],
            _interval([bounds.low, bounds.high]),
            _interval(region["region"]),
            _interval(natural[name]["region"]) if name in natural else _number(bounds.least or 0.0),
            _number(float(values[name])),
            _stretch(found["beside"].get(name), float(values[name])),
        )


def _interval(ends: Sequence[float]) -> str:
    low, high = map(_number, ends)
    return f"{low} to {high}"


def _stretch(beside: Mapping[str, Any] | None, value: float) -> str:
    """Say how far a parameter may be moved alone, and what fails then."""
    if beside is None:
        return ""
    ends = [value if beside[side]["to"] is None else beside[side]["to"] for side in ("down", "up")]
    fails = {claim for side in beside.values() for claim in side["then fail"]}
    return _interval(ends) + (f" ({', '.join(sorted(fails))})" if fails else "")


def _number(value: float) -> str:
    return number(float(f"{value:.3g}"))


def claim_rows(claims: Mapping[str, Any], ledger: Sequence[Claim]) -> list[ClaimRow]:
    """Return a row for each claim, those that hold everywhere first."""
    statements = {claim.id: claim.statement for claim in ledger}
    rows = [
        ClaimRow(
            name,
            statements.get(name, ""),
            entry["share"],
            entry["natural"],
            entry["given the others"],
            entry["standing"],
        )
        for name, entry in claims.items()
    ]
    return sorted(rows, key=lambda row: -row.share)
