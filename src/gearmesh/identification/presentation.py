"""The findings in words and tables, for the report and for the notebook."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from gearmesh.claims import REPRODUCED, Claim
from gearmesh.identification.design import Sample, stated
from gearmesh.identification.settings import FACTORS, Settings
from gearmesh.parameters import Parameters
from gearmesh.presentation import environment, number

_DIGITS = 3


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """Where one parameter may lie, as text."""

    symbol: str
    prior: str
    region: str
    natural: str
    stated: str


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
            parameters=list(parameter_rows(found["regions"], settings, stated(study))),
            claims=claim_rows(found["claims"], ledger),
            least_run_out=least,
            fragile=[name for name, most in bears.items() if most == least],
        )
    )


def parameter_rows(
    regions: Mapping[str, Any], settings: Settings, values: Sample
) -> Iterator[ParameterRow]:
    """Yield a row for each parameter of the plausible space."""
    natural = regions["natural"]["factors"]
    for name, found in regions["plausible"]["factors"].items():
        if name == "kind":
            likely = ", ".join(f"{kind} {round(100 * p)} %" for kind, p in found.items())
            yield ParameterRow(FACTORS[name], "any", likely, "separate", str(values[name]))
            continue
        bounds = settings.ranges[name]
        yield ParameterRow(
            FACTORS[name],
            _interval([bounds.low, bounds.high]),
            _interval(found["region"]),
            _interval(natural[name]["region"]) if name in natural else number(bounds.least or 0.0),
            number(float(values[name]), _DIGITS),
        )


def _interval(ends: Sequence[float]) -> str:
    low, high = (number(end, _DIGITS) for end in ends)
    return f"{low} to {high}"


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
