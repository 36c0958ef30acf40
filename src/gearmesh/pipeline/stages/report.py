"""Write the report and the pages beside it."""

from pathlib import Path

from gearmesh.data.paths import NOTEBOOK_NAMES, WHY, Places
from gearmesh.data.writing import write_text
from gearmesh.study.cases import Study


def notebook_pages(study: Study, places: Places) -> list[Path]:
    """Write the executed notebooks as pages of the report."""
    from gearmesh.report.notebook_page import notebook_page

    names = [*NOTEBOOK_NAMES, *([WHY] if study.plan.mechanisms else [])]
    pages = {name: places.notebook_page(name) for name in names}
    for name, page in pages.items():
        write_text(page, notebook_page(places.executed_notebook(name)))
    return [*pages.values()]


def explorer(study: Study, places: Places) -> list[Path]:
    """Write the explorer: the numbers of the study, with a solver that runs in the page."""
    from gearmesh.report.explorer.page import write_explorer

    write_explorer(study, places)
    return [places.explorer]


def report(study: Study, places: Places) -> list[Path]:
    """Write the report page: it opens from disk, without a network."""
    from gearmesh.report.page import write_report

    write_report(study, places)
    return [places.report]


def hashes(study: Study, places: Places) -> list[Path]:
    """Put the hashes of all results into one file, for ``sha256sum -c``."""
    from gearmesh.data import manifest

    found = map(manifest.read, sorted(places.manifest("any").parent.glob("*.sha256")))
    written = {name: digest for held in found if held for name, digest in held.written.items()}
    known = manifest.Hashes(places.folder).of(written)
    lines = [f"{digest}  {name}" for name, digest in written.items() if known[name] == digest]
    write_text(places.hashes, "".join(f"{line}\n" for line in sorted(lines, key=_name)))
    return [places.hashes]


def _name(line: str) -> str:
    return line.partition("  ")[2]
