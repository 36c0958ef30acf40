"""Check the claims, put all checks together, and judge."""

from pathlib import Path

from gearmesh.data.paths import CHECKED, Places
from gearmesh.study.cases import Study

UNEXPECTED = 3
"""Exit status when a claim has another status than the ledger expects."""


def printed(study: Study, places: Places) -> list[Path]:
    """Check the numbers that the paper prints and that follow from one another."""
    from gearmesh.reproduction.claims import Evidence, load_ledger
    from gearmesh.reproduction.claims.checking import check_figure

    path = places.check("printed")
    check_figure("printed", Evidence(pair=study.pair), load_ledger(study.ledger), path)
    return [path]


def ledger(study: Study, places: Places) -> list[Path]:
    """Collect the checks of all figures; write a line for each figure, and the counts."""
    from collections import Counter

    from gearmesh.data.writing import write_text
    from gearmesh.reproduction.claims import collect, load_ledger, verdict
    from gearmesh.reproduction.mechanisms import explanations

    checks = [places.check(name) for name in CHECKED]
    explained = (
        explanations.of_run(places.special_points, places.thresholds)
        if study.plan.mechanisms
        else {}
    )
    entries = collect(load_ledger(study.ledger), checks, places.ledger, explained)
    found: dict[str, Counter[str]] = {}
    for entry in entries:
        found.setdefault(entry.figure, Counter())[entry.status] += 1
    lines = [
        f"{figure}: " + ", ".join(f"{count} {status}" for status, count in sorted(counts.items()))
        for figure, counts in sorted(found.items())
    ]
    write_text(places.verdict, "\n".join([*lines, str(verdict(entries))]) + "\n")
    return [places.ledger, places.verdict]


def verdict(study: Study, places: Places) -> list[Path]:
    """Print the result of the claims; fail if a status is not the expected one."""
    import sys

    from gearmesh.data.writing import write_text
    from gearmesh.reproduction.claims import read_entries, verdict

    print(places.verdict.read_text(encoding="utf-8"), end="", file=sys.stderr)
    if verdict(read_entries(places.ledger)).unexpected:
        sys.exit(UNEXPECTED)
    write_text(places.as_expected, "All claims have the statuses that the ledger expects.\n")
    return [places.as_expected]
