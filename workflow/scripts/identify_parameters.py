"""Infer the open parameters from all samples, and check the inference on itself."""

import argparse
from pathlib import Path

from gearmesh.data import paths
from gearmesh.identification import boxes, layout, store, table
from gearmesh.identification.findings import Analysis, findings
from gearmesh.identification.settings import load_settings
from gearmesh.identification.survey import tested_claims
from gearmesh.pipeline.job import job, tell
from gearmesh.reproduction.claims import load_ledger


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("settings", type=Path)
    options = parser.parse_args()
    with job("identification"):
        settings = load_settings(options.settings)
        focused = [name for name, design in settings.designs.items() if design.around]
        analysis = Analysis(
            samples=store.read(layout.DATASET),
            boxes={name: boxes.read_box(layout.box_file(name)) for name in focused},
            ledger=[c for c in load_ledger(paths.CLAIMS) if c.id in tested_claims()],
            settings=settings,
        )
        found = findings(analysis)
        table.write(layout.FOUND, found)
        recovery = found["recovery"]
        tell(f"synthetic papers: {recovery['recovered']} of {recovery['papers']} recovered")


if __name__ == "__main__":
    main()
