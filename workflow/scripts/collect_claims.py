"""Put the checks of all figures together into the ledger."""

import argparse
from pathlib import Path

from gearmesh.data import paths
from gearmesh.pipeline.job import job
from gearmesh.reproduction.claims import collect, load_ledger


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("checks", type=Path, nargs="+")
    options = parser.parse_args()
    with job("ledger"):
        collect(load_ledger(paths.CLAIMS), options.checks, paths.LEDGER)


if __name__ == "__main__":
    main()
