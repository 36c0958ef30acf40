"""Check the claims of a figure against the evidence."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from gearmesh.errors import InputError
from gearmesh.reproduction.claims import fig2, fig3, fig4, fig5, fig6, fig7, printed
from gearmesh.reproduction.claims.evidence import Evidence, NotInStudy, NotLocated
from gearmesh.reproduction.claims.ledger import (
    DEVIATES,
    NOT_TESTABLE,
    REPRODUCED,
    Claim,
    Entry,
    Figure,
    holds,
    write_entries,
)

Measure = Callable[[Evidence], tuple[Any, str]]
"""Measures what a claim speaks of; returns the value (see `ledger.holds`) and a line on it."""

MEASURES: dict[str, Measure] = {
    **printed.MEASURES,
    **fig2.MEASURES,
    **fig3.MEASURES,
    **fig4.MEASURES,
    **fig5.MEASURES,
    **fig6.MEASURES,
    **fig7.MEASURES,
}
"""How each claim is measured, by its id."""


def check(claim: Claim, evidence: Evidence) -> Entry:
    """Measure one claim and give it its status; a claim that does not hold raises nothing."""
    if claim.id not in MEASURES:
        raise InputError(f"claims: {claim.id}: no such check, known are {', '.join(MEASURES)}")
    try:
        measured, detail = MEASURES[claim.id](evidence)
    except NotInStudy as error:
        found = {"status": NOT_TESTABLE, "detail": f"not in this study: {error}", "judged": False}
    except NotLocated as error:
        found = {"status": NOT_TESTABLE, "detail": f"not located: {error}"}
    else:
        status = REPRODUCED if holds(claim, measured) else DEVIATES
        found = {"measured": measured, "status": status, "detail": detail}
    return Entry(**claim.model_dump(), **found)


def check_figure(
    figure: Figure, evidence: Evidence, ledger: Iterable[Claim], output: Path | None = None
) -> list[Entry]:
    """Check every claim that the ledger gives to a figure.

    Parameters
    ----------
    figure : str
        'printed' or 'fig2' to 'fig7'.
    evidence : Evidence
        What the checks look at.
    ledger : iterable of Claim
        See `load_ledger`.
    output : Path, optional
        Where the entries are written, `results/checks/fig2.json`.

    Returns
    -------
    list of Entry
        In the order of the ledger. A claim that deviates raises nothing.
    """
    entries = [check(claim, evidence) for claim in ledger if claim.figure == figure]
    if output is not None:
        write_entries(output, entries)
    return entries
