"""Build the report page: it opens from disk, without a network."""

import argparse
from pathlib import Path

from gearmesh import paths
from gearmesh.job import job


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("config", type=Path)
    options = parser.parse_args()
    with job("report"):
        paths.REPORT.parent.mkdir(parents=True, exist_ok=True)
        paths.REPORT.write_text(f"{options.config}")


if __name__ == "__main__":
    main()
