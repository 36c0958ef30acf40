"""Check the numbers that the paper prints and that follow from one another."""

import argparse
from pathlib import Path

from gearmesh.data import paths
from gearmesh.pipeline.job import job
from gearmesh.reproduction.claims import Evidence, load_ledger
from gearmesh.reproduction.claims.checking import check_figure
from gearmesh.study.loading import load_study


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("config", type=Path)
    options = parser.parse_args()
    with job("ledger"):
        evidence = Evidence(pair=load_study(options.config).pair)
        check_figure("printed", evidence, load_ledger(paths.CLAIMS), paths.check_file("printed"))


if __name__ == "__main__":
    main()
