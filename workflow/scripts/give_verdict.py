"""Say how the claims of each figure came out; fail if a status is not the expected one."""

import sys
from collections import Counter

from gearmesh.data import paths
from gearmesh.data.writing import write_text
from gearmesh.pipeline.job import job, note
from gearmesh.reproduction.claims import Entry, read_entries, verdict

UNEXPECTED = 3
"""Exit status when a claim has another status than the ledger expects."""


def lines(entries: list[Entry]) -> list[str]:
    """Return one line for each figure."""
    found = {}
    for entry in entries:
        found.setdefault(entry.figure, Counter())[entry.status] += 1
    return [
        f"{figure}: " + ", ".join(f"{count} {status}" for status, count in sorted(counts.items()))
        for figure, counts in sorted(found.items())
    ]


def main() -> None:
    """Run as a job."""
    with job("ledger"):
        entries = read_entries(paths.LEDGER)
        outcome = verdict(entries)
        note({"claims": str(outcome)})
        text = "\n".join([*lines(entries), str(outcome)]) + "\n"
        if outcome.unexpected:
            print(text, end="", file=sys.stderr)
            sys.exit(UNEXPECTED)
        write_text(paths.VERDICT, text)


if __name__ == "__main__":
    main()
