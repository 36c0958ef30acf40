"""Measure the claims on one batch of samples of the open parameters."""

import argparse
import warnings
from pathlib import Path

from gearmesh.identification import boxes, layout, store
from gearmesh.identification.design import unit_points
from gearmesh.identification.settings import load_settings
from gearmesh.identification.survey import compute
from gearmesh.pipeline.job import job, note, tell
from gearmesh.study.loading import load_study


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("settings", type=Path)
    parser.add_argument("config", type=Path)
    parser.add_argument("design")
    parser.add_argument("index", type=int)
    parser.add_argument("output", type=Path)
    options = parser.parse_args()
    # Where nothing of a kind exists, the median of nothing is not a number, and meant to be.
    warnings.filterwarnings("ignore", category=RuntimeWarning)
    with job("identification"):
        settings = load_settings(options.settings)
        design = settings.designs[options.design]
        places = unit_points(design)
        if design.around:
            places = boxes.read_box(layout.box_file(options.design)).fill(places)
        study = load_study(options.config).pair
        found = compute(settings, study, options.design, options.index, places)
        store.write(options.output, found, f"claims on samples of the design {options.design}")
        note({"identified": found.sizes["sample"]})
        batch = f"batch {options.index + 1} of {layout.batch_count(settings, options.design)}"
        tell(f"{options.design}: {batch}")


if __name__ == "__main__":
    main()
