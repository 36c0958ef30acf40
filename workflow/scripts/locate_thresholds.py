"""Locate the thresholds that the paper states as numbers, by refinement in nu_s."""

import argparse
import json
from pathlib import Path

from gearmesh.data import paths
from gearmesh.data.writing import write_text
from gearmesh.pipeline.job import job
from gearmesh.reproduction.thresholds import locate
from gearmesh.study.loading import load_study


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("config", type=Path)
    options = parser.parse_args()
    with job("thresholds"):
        study = load_study(options.config)
        variants = [variant.name for variant, _ in study.plan.frequencies()]
        found = locate(study.pair, variants)
        write_text(paths.THRESHOLDS, json.dumps(found, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
