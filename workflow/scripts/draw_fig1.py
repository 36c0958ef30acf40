"""Draw Fig. 1, the kinematic pair with its symbols: it needs no data."""

import argparse
from pathlib import Path

from gearmesh.pipeline.job import job
from gearmesh.reproduction.figures import canvas, fig1


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("png", type=Path)
    parser.add_argument("svg", type=Path, help="beside it, with the same name")
    options = parser.parse_args()
    with job("drawings"):
        canvas.save(fig1.draw(), options.png.with_suffix(""))


if __name__ == "__main__":
    main()
