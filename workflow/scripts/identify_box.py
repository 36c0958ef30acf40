"""Find the box that the best samples before a focused design span."""

import argparse
from pathlib import Path

from gearmesh.data import paths
from gearmesh.identification import boxes, focus, layout, store
from gearmesh.identification.settings import load_settings
from gearmesh.identification.survey import tested_claims
from gearmesh.pipeline.job import job
from gearmesh.reproduction.claims import load_ledger


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("settings", type=Path)
    parser.add_argument("design")
    parser.add_argument("batches", type=Path, nargs="+")
    options = parser.parse_args()
    with job("identification"):
        design = load_settings(options.settings).designs[options.design]
        ledger = [c for c in load_ledger(paths.CLAIMS) if c.id in tested_claims()]
        box = focus.around(store.read(*options.batches), design, ledger)
        boxes.write_box(layout.box_file(options.design), box, design)


if __name__ == "__main__":
    main()
