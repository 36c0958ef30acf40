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
"""Measures the quantity of a claim; returns the value (see `ledger.holds`) and a line about it."""

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
    """Measure one claim and return it with its status.

    Raises
    ------
    InputError
        If no check has the id of the claim. A claim that does not hold raises nothing.
    """
    if claim.id not in MEASURES:
        raise InputError(f"claims: {claim.id}: no such check; known are {', '.join(MEASURES)}")
    stated = claim.model_dump()
    try:
        measured, detail = MEASURES[claim.id](evidence)
    except NotInStudy as error:
        detail = f"not in this study: {error}"
        return Entry(**stated, status=NOT_TESTABLE, detail=detail, judged=False)
    except NotLocated as error:
        return Entry(**stated, status=NOT_TESTABLE, detail=f"not located: {error}")
    status = REPRODUCED if holds(claim, measured) else DEVIATES
    return Entry(**stated, measured=measured, status=status, detail=detail)


def check_figure(
    figure: Figure, evidence: Evidence, ledger: Iterable[Claim], output: Path | None = None
) -> list[Entry]:
    """Check every claim of a figure.

    Parameters
    ----------
    figure : str
        'printed' or 'fig2' to 'fig7'.
    evidence : Evidence
        What the checks read.
    ledger : iterable of Claim
        See `load_ledger`.
    output : Path, optional
        File to which the entries are written.

    Returns
    -------
    list of Entry
        In the order of the ledger.
    """
    entries = [check(claim, evidence) for claim in ledger if claim.figure == figure]
    if output is not None:
        write_entries(output, entries)
    return entries
