"""Build the report page: it opens from disk, without a network."""

import argparse
from pathlib import Path

from gearmesh.pipeline.job import job
from gearmesh.report.page import write_report
from gearmesh.study.loading import load_study


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("config", type=Path)
    options = parser.parse_args()
    with job("report"):
        write_report(load_study(options.config))


if __name__ == "__main__":
    main()
