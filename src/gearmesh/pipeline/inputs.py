"""The committed files that a study is made from."""

from collections.abc import Iterator
from pathlib import Path

from gearmesh.data import paths
from gearmesh.identification import layout
from gearmesh.study.cases import Study
from gearmesh.study.reading import yamlfile

SNAKEFILE = Path("Snakefile")
CITATION = Path("CITATION.cff")
_LOCK = Path("requirements.lock")
RULES = Path("workflow/rules")


def inputs(study: Study) -> list[Path]:
    """Return the files, the Snakefile first; all but the study itself stand in the project."""
    ledger = [study.claims, *sorted(paths.NOTEBOOKS.glob("*.ipynb"))] if study.claims else []
    return [
        *(SNAKEFILE, *sorted(RULES.glob("*.smk")), *_bases(study.path)),
        *(path for path in ledger if path),
        *(layout.IDENTIFIED, layout.SETTINGS, _LOCK, CITATION),
    ]


def _bases(path: Path) -> Iterator[Path]:
    """Yield the file of a study, and those that it is based on."""
    yield path
    base = yamlfile.read_mapping(path).get("base")
    if isinstance(base, str):
        yield from _bases(path.parent / base)
