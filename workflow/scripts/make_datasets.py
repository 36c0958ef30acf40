"""Make the datasets over (variant, nu) from all batches."""

import argparse
from pathlib import Path

from gearmesh.data import paths
from gearmesh.data.datasets import write_datasets
from gearmesh.pipeline.job import job
from gearmesh.study.loading import load_study


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("config", type=Path)
    parser.add_argument("batches", type=Path, nargs="+")
    options = parser.parse_args()
    with job("datasets"):
        study = load_study(options.config)
        write_datasets(study, options.batches, paths.RESONANCE, paths.BIFURCATION)


if __name__ == "__main__":
    main()
