"""Draw the report's figures of what the claims tell about the open parameters."""

import argparse
from pathlib import Path

from gearmesh.identification import layout, table
from gearmesh.identification.design import stated
from gearmesh.identification.figures import draw_regions, draw_sensitivity
from gearmesh.identification.settings import load_settings
from gearmesh.pipeline.job import job
from gearmesh.reproduction.figures import canvas
from gearmesh.study.loading import load_study


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("config", type=Path)
    options = parser.parse_args()
    with job("drawings"):
        study, settings = load_study(options.config), load_settings(layout.SETTINGS)
        found = table.read()
        regions = draw_regions(found["regions"], settings.ranges, stated(study.pair))
        canvas.save(regions, layout.REPORTED["regions"])
        canvas.save(draw_sensitivity(found["sensitivity"]), layout.REPORTED["sensitivity"])


if __name__ == "__main__":
    main()
