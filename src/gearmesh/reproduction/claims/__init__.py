"""The paper's claims: load them, check them, collect the results.

A notebook or a rule needs these calls::

    ledger = load_ledger(study.claims)
    evidence = Evidence(pair=study.pair, thresholds=json.loads(...), time_courses={...})
    entries = checking.check_figure("fig2", evidence, ledger, places.check("fig2"))
    print(verdict(collect(ledger, all_check_files, places.ledger)))

`ledger` holds claims, entries and the verdict. `printed` and `fig2` to `fig7` measure each claim,
and `checking` compares the measurements with the ledger. The package itself does not import these
checks, so a program that only reads the ledger does not load the solver.
"""

from gearmesh.reproduction.claims.evidence import Evidence, NotInStudy
from gearmesh.reproduction.claims.ledger import (
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
    "collect",
    "holds",
    "load_ledger",
    "read_entries",
    "verdict",
    "write_entries",
]
