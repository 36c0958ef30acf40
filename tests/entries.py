"""An entry of the ledger, for tests that write entries."""

from gearmesh.reproduction.claims import Entry


def claim(**changes) -> Entry:
    given = {
        "id": "F2.1",
        "where": "Fig. 2",
        "figure": "fig2",
        "statement": "It jumps near ν_s = 0.66.",
        "kind": "threshold",
        "expected": 0.66,
        "tolerance": 0.02,
        "measured": 0.654321,
        "status": "reproduced",
    }
    return Entry(**given | changes)
