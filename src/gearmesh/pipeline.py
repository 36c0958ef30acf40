"""What the Snakefile asks of a study: its files, its batches, and what each stage depends on."""

import hashlib
import shlex
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import yaml

from gearmesh import batches, casefile, paths, provenance
from gearmesh.batches import Batch
from gearmesh.configuration import Case, Study, load_study
from gearmesh.errors import InputError
from gearmesh.job import tell

SCRIPTS = Path("workflow/scripts")
_SETTINGS = ("study",)


@dataclass(frozen=True)
class Plan:
    """A study as the pipeline sees it.

    Attributes
    ----------
    config : Path
        Its configuration file.
    study : Study
        What stands in it.
    """

    config: Path
    study: Study

    @cached_property
    def cases(self) -> tuple[Case, ...]:
        """All cases."""
        return tuple(self.study.cases())

    @cached_property
    def batches(self) -> list[Batch]:
        """The batches in which they are computed."""
        return batches.partition(self.cases, self.study.study.cases_per_job)

    @cached_property
    def recipe(self) -> str:
        """What all cases depend on besides variant and frequency: parameters and versions."""
        return _digest((self.study.parameters.digest(), provenance.versions()))

    @cached_property
    def grid(self) -> str:
        """What the datasets depend on besides the batches: their title and their axes."""
        plan = [(variant.name, nus) for variant, nus in self.study.study.frequencies()]
        return _digest((self.study.title, plan))

    @cached_property
    def variants(self) -> str:
        """The names of all variants."""
        return " ".join(variant.name for variant, _ in self.study.study.frequencies())

    @cached_property
    def stated(self) -> str:
        """All that the configuration states, reasons and title too: what the report depends on."""
        return _digest(self.study.model_dump_json())

    def case_file(self, case: Case) -> str:
        """Return the file of a case."""
        return str(paths.case_file(case.variant.name, case.nu))

    def case_files(self, cases: Iterable[Case]) -> list[str]:
        """Return the files of those cases that have one of their own."""
        return [self.case_file(case) for case in cases if self.has_file(case)]

    def has_file(self, case: Case) -> bool:
        """Tell whether a case has a file of its own; one with a time course always has."""
        return self.study.study.case_files or case.time_course

    def time_courses(self, variants: Sequence[str]) -> list[str]:
        """Return the case files of some variants that hold a time course."""
        wanted = [c for c in self.cases if c.time_course and c.variant.name in variants]
        return self.case_files(wanted)

    def members(self, batch: Batch) -> str:
        """Return what a batch depends on besides the recipe: which cases are in it."""
        return _digest([(c.variant.name, c.nu, c.time_course) for c in batch.cases])

    @cached_property
    def computed(self) -> list[str]:
        """All case files and batch files."""
        return self.case_files(self.cases) + [self.batch_file(batch) for batch in self.batches]

    def batch_file(self, batch: Batch) -> str:
        """Return the file of a batch."""
        return str(paths.batch_file(batch.name))

    def drop_damaged(self, only_tell: bool) -> None:
        """Delete files that are not as they were written, so that they are made again.

        Parameters
        ----------
        only_tell : bool
            Name them, but let them be.
        """
        for path in map(Path, [*self.computed, paths.RESONANCE, paths.BIFURCATION]):
            if path.exists() and not casefile.is_whole(path):
                tell(f"{path}: damaged, to be made again")
                if not only_tell:
                    path.unlink()


def load(config: Mapping[str, object], configfiles: Sequence[Path | str]) -> Plan:
    """Load the study that a run of Snakemake asks for.

    Parameters
    ----------
    config : mapping
        Settings of the command line (``--config study=FILE``).
    configfiles : sequence
        Files of ``--configfile``, which names a study as well.

    Raises
    ------
    InputError
        One line, if a setting or the study is wrong.
    """
    if configfiles:
        path = Path(configfiles[-1])
    else:
        for name in config:
            if name not in _SETTINGS:
                raise InputError(f"--config {name}: unknown; allowed is study=FILE")
        path = Path(str(config.get("study", paths.PAPER)))
    return Plan(path, load_study(path))


def script(name: str) -> str:
    """Return the file of a script of the pipeline."""
    return str(SCRIPTS / f"{name}.py")


def sources(*files: str) -> list[str]:
    """Return files together with the modules that they import, relative to the project's root."""
    found = [*map(Path, files), *provenance.sources(*files)]
    return [_relative(file) for file in found]


def checked_by(figure: str, *files: str) -> list[str]:
    """Return files that check the claims of a figure, and what they import of it.

    `gearmesh.claims` imports the checks of all figures; a figure depends on its own.
    """
    others = {f"claims/{name}.py" for name in paths.CHECKED if name != figure}
    return [file for file in sources(*files) if "/".join(Path(file).parts[-2:]) not in others]


def claims_digest(figure: str) -> str:
    """Return the digest of the claims that belong to a figure.

    The ledger is not checked here: that loads compiled code, which takes longer than all else
    that a run without work has to do. The jobs check it.
    """
    text = paths.CLAIMS.read_text(encoding="utf-8")
    try:
        listed = yaml.safe_load(text).items()
        claims = [(name, claim) for name, claim in listed if claim["figure"] == figure]
    except (yaml.YAMLError, AttributeError, TypeError, KeyError):
        claims = text
    return _digest(claims)


def templates() -> list[str]:
    """Return the templates of the report."""
    return sorted(
        _relative(file) for file in provenance.module("templates").with_suffix("").iterdir()
    )


def captions() -> list[str]:
    """Return the captions of the figures."""
    return [f"workflow/report/{name}.rst" for name in paths.FIGURE_NAMES]


def _relative(file: Path) -> str:
    root = Path.cwd()
    return str(file.relative_to(root) if file.is_relative_to(root) else file)


def prefix(plan: Plan) -> str:
    """Return what goes before each shell command: where `python` is, and which study runs.

    It takes the place of Snakemake's own prefix, so it repeats that a command fails with any part
    of it: the logs are written through a pipe.
    """
    folder = shlex.quote(str(Path(sys.executable).parent))
    return f"set -euo pipefail; export PATH={folder}:$PATH STUDY={shlex.quote(str(plan.config))}; "


def _digest(stated: object) -> str:
    return hashlib.sha256(repr(stated).encode()).hexdigest()
