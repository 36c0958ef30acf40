"""The paper's claims: load them, check them, put the results together.

A notebook or a rule needs three calls::

    ledger = load_ledger("config/claims.yaml")
    entries = check_figure("fig2", Evidence(parameters=..., ...), ledger, "results/checks/fig2.json")
    verdict(collect(ledger, Path("results/checks").glob("*.json"), "results/claims.json"))
"""

from gearmesh.claims.checking import check_figure
from gearmesh.claims.evidence import Evidence, NotInStudy
from gearmesh.claims.ledger import (
    DEVIATES,
    NOT_TESTABLE,
    REPRODUCED,
    Bound,
    Claim,
    Entry,
    Verdict,
    collect,
    holds,
    load_ledger,
    read_entries,
    verdict,
    write_entries,
)

__all__ = [
    "DEVIATES",
    "NOT_TESTABLE",
    "REPRODUCED",
    "Bound",
    "Claim",
    "Entry",
    "Evidence",
    "NotInStudy",
    "Verdict",
    "check_figure",
    "collect",
    "holds",
    "load_ledger",
    "read_entries",
    "verdict",
    "write_entries",
]
