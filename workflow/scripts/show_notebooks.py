"""Write the executed notebooks as pages of the report."""

from gearmesh import paths
from gearmesh.job import job, write_text
from gearmesh.notebook_page import notebook_page


def main() -> None:
    """Run as a job."""
    with job("report"):
        for name in paths.NOTEBOOK_NAMES:
            write_text(paths.notebook_page(name), notebook_page(paths.executed_notebook(name)))


if __name__ == "__main__":
    main()
