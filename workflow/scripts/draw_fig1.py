"""Draw Fig. 1, the kinematic pair with its symbols: it needs no data."""

import argparse

from gearmesh.figures import canvas, fig1
from gearmesh.job import job


def main() -> None:
    """Run as a job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("figure", help="place, without suffix")
    options = parser.parse_args()
    with job("figures"):
        canvas.save(fig1.draw(), options.figure)


if __name__ == "__main__":
    main()
