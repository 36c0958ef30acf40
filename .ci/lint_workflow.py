"""Run ``snakemake --lint``, one finding aside; exits 1 if any other is left.

Snakemake asks for a conda environment or a container for each rule. All rules here share the one
environment of requirements.lock, whose packages are pinned by hash, so that demand is met
otherwise.
"""

import json
import subprocess
import sys
from pathlib import Path

ACCEPTED = "Specify a conda environment or container for each rule."


def findings() -> list[str]:
    """Return what is left of Snakemake's findings, one line each."""
    snakemake = Path(sys.executable).with_name("snakemake")
    run = subprocess.run([snakemake, "--lint", "json"], capture_output=True, text=True)
    start = run.stdout.find("{")
    if start < 0:
        return [] if run.returncode == 0 else [run.stderr.strip()]
    report = json.loads(run.stdout[start:])
    left = []
    for item in [*report["snakefiles"], *report["rules"]]:
        name = item["for"].get("rule") or item["for"]["snakefile"]
        left += [f"{name}: {lint['title']}" for lint in item["lints"] if lint["title"] != ACCEPTED]
    return left


if __name__ == "__main__":
    left = findings()
    print("\n".join(left) or "snakemake --lint: nothing left to say")
    sys.exit(bool(left))
