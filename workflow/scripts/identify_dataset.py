"""Put all samples of the open parameters together."""

import argparse
from pathlib import Path

from gearmesh.identification import layout, store
from gearmesh.pipeline.job import job


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("batches", type=Path, nargs="+")
    options = parser.parse_args()
    with job("identification"):
        store.write_all(layout.DATASET, options.batches)


if __name__ == "__main__":
    main()
