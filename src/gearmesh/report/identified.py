"""The results of the identification in words and tables, for the report and the notebook."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from gearmesh.identification.factors import FACTORS
from gearmesh.identification.sampling.design import Sample, stated
from gearmesh.identification.settings import Range, Settings
from gearmesh.report.presentation import environment, number
from gearmesh.reproduction.claims import REPRODUCED, Claim
from gearmesh.study.pair import Pair

ANY = "any"
"""Text for a parameter that the claims do not restrict."""

OPEN = 0.05
"""A region that ends closer than this to an end of the range, as a share of it, is open there.

Without any restriction by the claims, a region of 95 % ends at half this distance."""

NARROW = 0.6
"""A region shorter than this share of the plausible range restricts a parameter."""


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """The compatible region of one parameter, as text."""

    name: str
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
    found: Mapping[str, Any],
    ledger: Sequence[Claim],
    settings: Settings,
    study: Pair,
    figures: Mapping[str, str] | None = None,
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
    study : Pair
        The values of the study, shown beside the regions.
    figures : mapping of str to str, optional
        Places of the figures ``regions`` and ``sensitivity``, without suffix; the notebook draws
        its own.
    """
    expected = [claim.id for claim in ledger if claim.expected_status == REPRODUCED]
    factors = found["regions"]["plausible"]["factors"]
    return (
        environment()
        .get_template("identification.html.j2")
        .render(
            found=found,
            regions=found["regions"],
            parameters=list(parameter_rows(found, settings, stated(study))),
            claims=claim_rows(found["claims"], ledger),
            error=max(entry["error"] for entry in found["claims"].values()),
            pinned=[
                FACTORS[name].symbol
                for name, region in factors.items()
                if region.get("of the prior", 1.0) < NARROW
            ],
            free=[
                FACTORS[name].symbol
                for name, region in factors.items()
                if name != "kind" and within(region["region"], settings.ranges[name]) == ANY
            ],
            run_out=run_out_costs(found["run-out"], expected),
            figures=figures,
        )
    )


def run_out_costs(found: Mapping[str, Any], expected: Sequence[str]) -> dict[str, Any]:
    """Return which claims fail because of run-out, with friction and without it."""
    bears, alone = (
        {name: most for name, most in found[words].items() if name in expected}
        for words in ("with friction", "without friction")
    )
    most = {name: up_to for name, up_to in alone.items() if up_to > 0}
    least = min(most.values(), default=0.0)
    lost, alone_lost = (
        [name for name, up_to in borne.items() if up_to == 0] for borne in (bears, alone)
    )
    return {
        "lost": lost,
        "by_friction": [name for name in lost if name not in alone_lost],
        "alone_lost": alone_lost,
        "need_friction": [name for name in alone_lost if name not in lost],
        "alone_least": least,
        "alone_fragile": [
            name for name, up_to in most.items() if up_to == least < max(most.values())
        ],
    }


def parameter_rows(
    found: Mapping[str, Any], settings: Settings, values: Sample
) -> Iterator[ParameterRow]:
    """Yield a row for each parameter of the plausible space."""
    natural = found["regions"]["natural"]["factors"]
    for name, region in found["regions"]["plausible"]["factors"].items():
        if name == "kind":
            likely = ", ".join(f"{kind} {round(100 * p)} %" for kind, p in region.items())
            yield ParameterRow(
                "", FACTORS[name].symbol, ANY, likely, "separate", str(values[name]), ""
            )
            continue
        bounds = settings.ranges[name]
        yield ParameterRow(
            name.replace("_", " "),
            FACTORS[name].symbol,
            _interval([bounds.low, bounds.high]),
            within(region["region"], bounds),
            within(natural[name]["region"], bounds)
            if name in natural
            else _number(bounds.least or 0.0),
            _number(float(values[name]), 4),
            _alone(found["beside"].get(name), float(values[name])),
        )


def _interval(ends: Sequence[float]) -> str:
    low, high = map(_number, ends)
    return f"{low} to {high}"


def within(region: Sequence[float], bounds: Range) -> str:
    """Return a region as text; ends at those of the plausible range are left out."""
    low, high = region
    return _between(
        low if bounds.unit(low) > OPEN else None, high if bounds.unit(high) < 1.0 - OPEN else None
    )


def _between(low: float | None, high: float | None) -> str:
    """Return an interval as text; either end may be open."""
    if low is not None and high is not None:
        return _interval([low, high])
    if low is not None:
        return f"{_number(low)} or more"
    return ANY if high is None else f"up to {_number(high)}"


def _alone(beside: Mapping[str, Any] | None, value: float) -> str:
    """Return as text how far one parameter may be moved, and which claims fail beyond."""
    if beside is None:
        return ""
    low, high = (
        (value if side["to"] is None else side["to"]) if side["then fail"] else None
        for side in (beside["down"], beside["up"])
    )
    fails = {claim for side in beside.values() for claim in side["then fail"]}
    return _between(low, high) + (f" ({', '.join(sorted(fails))})" if fails else "")


def _number(value: float, digits: int = 3) -> str:
    return number(float(f"{value:.{digits}g}"))


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
