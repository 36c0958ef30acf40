"""Write the executed notebooks as pages of the report."""

from gearmesh.data import paths
from gearmesh.data.writing import write_text
from gearmesh.pipeline.job import job
from gearmesh.report.notebook_page import notebook_page


def main() -> None:
    """Run as a job."""
    with job("report"):
        for name in paths.NOTEBOOK_NAMES:
            write_text(paths.notebook_page(name), notebook_page(paths.executed_notebook(name)))


if __name__ == "__main__":
    main()
