"""Claims and entries of the ledger, to vary in tests."""

from gearmesh.reproduction.claims import REPRODUCED, Claim, Entry


def shape_claim(**changes) -> Claim:
    given = {
        "id": "F2.1",
        "where": "Fig. 2",
        "figure": "fig2",
        "statement": "It is so.",
        "kind": "shape",
        "expected": {"at_most": 1.0},
    }
    return Claim(**given | changes)


def shape_entry(name="F2.1", status=REPRODUCED, **changes) -> Entry:
    """Return the entry of `shape_claim` under another name."""
    return Entry(**shape_claim(id=name).model_dump(), status=status, **changes)


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
