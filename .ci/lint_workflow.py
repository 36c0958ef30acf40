"""Run ``snakemake --lint``, one finding aside; exits 1 if any other is left.

Snakemake asks for a conda environment or a container for each rule. All rules here share the one
environment of requirements.lock, whose packages are pinned by hash, so that demand is met
otherwise.
"""

import re
import subprocess
import sys
from pathlib import Path

ACCEPTED = "Specify a conda environment or container for each rule."


def findings(report: str) -> list[tuple[str, str]]:
    """Return (rule or file, finding) for everything that a report of Snakemake's lint names."""
    found, place = [], ""
    for line in report.splitlines():
        if match := re.fullmatch(r"Lints for (.+):", line):
            place = match[1]
        elif match := re.fullmatch(r" {4}\* (.+):", line):
            found.append((place, match[1]))
    return found


def main() -> int:
    """Lint the workflow; returns the exit status."""
    snakemake = Path(sys.executable).with_name("snakemake")
    run = subprocess.run([snakemake, "--lint"], capture_output=True, text=True)
    found = findings(run.stderr)
    if run.returncode and not found:  # it did not come as far as linting
        print(run.stderr, file=sys.stderr)
        return 1
    left = [(place, finding) for place, finding in found if finding != ACCEPTED]
    print(f"snakemake --lint: {len(left)} findings, {len(found) - len(left)} accepted")
    for place, finding in left:
        print(f"  {place}: {finding}")
    return int(bool(left))


if __name__ == "__main__":
    sys.exit(main())
