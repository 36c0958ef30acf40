"""What the Snakefile asks of a study: its files, its batches, and what each stage depends on."""

import hashlib
import shlex
import sys
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from gearmesh.data import batches, casefile, paths, provenance
from gearmesh.data.batches import Batch
from gearmesh.errors import InputError
from gearmesh.identification import layout
from gearmesh.pipeline.job import tell
from gearmesh.reproduction.claims import Claim
from gearmesh.study.cases import Case, Study
from gearmesh.study.loading import load_study

SCRIPTS = Path("workflow/scripts")
_SETTINGS = ("study",)
_LOOKS = (
    *("-l", "-S", "-D", "-t", "--lint", "--list", "--lt", "--lc", "--li", "--lp", "--lu", "--cm"),
    *("--summary", "--detailed-summary", "--dag", "--rulegraph", "--filegraph", "--d3dag"),
    *("--unlock", "--report", "--archive", "--touch", "--containerize", "--export-cwl"),
    *("--generate-unit-tests", "--print-compilation", "--deploy-sources"),
)
_LOOKS_BEGIN = ("--list-", "--cleanup-", "--delete-", "--conda-c", "--container-cleanup-")
"""Options of Snakemake with which it runs no job, and how others of that kind begin."""

_RECORDS = (Path(".snakemake/metadata"), Path(".snakemake/incomplete"))
"""Where Snakemake keeps what it knows of files, and of those that are being made."""


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
        return tuple(self.study.cases)

    @cached_property
    def batches(self) -> list[Batch]:
        """The batches in which they are computed."""
        return batches.partition(self.cases, 1400)

    @cached_property
    def recipe(self) -> str:
        """What all cases depend on besides variant and frequency: parameters and versions."""
        return _digest((self.study.pair.digest(), provenance.versions()))

    @cached_property
    def grid(self) -> str:
        """What the datasets depend on besides the batches: their title and their axes."""
        plan = [(variant.name, nus) for variant, nus in self.study.plan.frequencies()]
        return _digest((self.study.title, plan))

    @cached_property
    def variants(self) -> str:
        """The names of all variants."""
        return " ".join(variant.name for variant, _ in self.study.plan.frequencies())

    @cached_property
    def stated(self) -> str:
        """All that the configuration states, reasons and title too: what the report depends on."""
        return _digest((self.study.pair.parameters, self.study.plan.model_dump_json()))

    def has_file(self, case: Case) -> bool:
        """Tell whether a case has a file of its own; one with a time course always has."""
        return self.study.plan.case_files or case.time_course

    def time_courses(self, variants: Sequence[str]) -> list[str]:
        """Return the batch files whose cases have time courses of some variants."""
        return [
            self.batch_file(batch)
            for batch in self.batches
            if any(case.time_course and case.variant.name in variants for case in batch.cases)
        ]

    def members(self, batch: Batch) -> str:
        """Return what a batch depends on besides the recipe: which cases are in it."""
        return _digest([(c.variant.name, c.nu, c.time_course) for c in batch.cases])

    def batch_file(self, batch: Batch) -> str:
        """Return the file of a batch."""
        return str(paths.batch_file(batch.name))

    @cached_property
    def batch_files(self) -> list[str]:
        """The files of all batches."""
        return [self.batch_file(batch) for batch in self.batches]

    def look(self, asked: Container[str], only_tell: bool) -> dict[int, list[str]]:
        """Look at every file that carries a seal; delete what is not as it was written.

        Parameters
        ----------
        asked : container of str
            Files that the command line asks for.
        only_tell : bool
            Name what is to be made again, but let it be.

        Returns
        -------
        dict of int to list of str
            The case files of each batch, by its index, that Snakemake has to know of: those that
            are asked for, and the first that lacks, with which come all others.
        """
        for file in (paths.RESONANCE, paths.BIFURCATION, *self.batch_files):
            if Path(file).exists() and not casefile.is_whole(Path(file)):
                _drop(file, "damaged", only_tell)
        if not any(any(folder.glob("*")) for folder in _RECORDS):
            self._distrust(only_tell)
        known = {}
        for batch in self.batches:
            files = {
                str(paths.case_file(case.variant.name, case.nu)): case
                for case in batch.cases
                if self.has_file(case)
            }
            lacking = self._lacking(batch, files, only_tell)[:1]
            named = [file for file in files if file in asked and file not in lacking]
            known[batch.index] = lacking + named
        return known

    def _lacking(self, batch: Batch, files: Mapping[str, Case], only_tell: bool) -> list[str]:
        """Return the case files of a batch that are not there, or not as this study makes them."""
        parameters = self.study.pair
        lacking, others = [], []
        for file, case in files.items():
            path = Path(file)
            if casefile.is_whole(path, casefile.recipe(casefile.attributes(parameters, case))):
                continue
            if casefile.is_whole(path):
                others.append(file)
                continue
            if path.exists():
                _drop(file, "damaged", only_tell)
            lacking.append(file)
        # Files of other parameters beside a batch file of these: another study ran in between.
        # Where the batch file is out of date too, its job runs anyway and keeps what it can.
        if others and self._is_current(batch):
            for file in others:
                _drop(file, "of another study", only_tell)
            lacking += others
        return lacking

    def _distrust(self, only_tell: bool) -> None:
        """Delete what may be of other parameters, where Snakemake's records of them are gone.

        Without a record Snakemake takes a file for what is wanted. Case files and batch files say
        themselves what they are; all else follows from the files that are named here, or is one of
        the samples of the identification.
        """
        outdated = [self.batch_file(batch) for batch in self.batches if not self._is_current(batch)]
        samples = layout.FOLDER.glob("*/*.nc")
        first = (paths.RESONANCE, paths.THRESHOLDS, paths.check_file("printed"))
        for file in (*outdated, *first, *samples):
            if Path(file).exists():
                _drop(file, "without a record of its parameters", only_tell)

    def _is_current(self, batch: Batch) -> bool:
        wanted = casefile.recipe(batches.attributes(self.study.pair, batch))
        return casefile.is_whole(Path(self.batch_file(batch)), wanted)


def only_looks(arguments: Sequence[str]) -> bool:
    """Tell whether a command line asks Snakemake for something else than to run jobs.

    Snakemake reads the Snakefile for all of them alike, and says only later what it is asked.
    """
    options = [argument.split("=")[0] for argument in arguments]
    return any(option in _LOOKS or option.startswith(_LOOKS_BEGIN) for option in options)


def _drop(file: Path | str, why: str, only_tell: bool) -> None:
    tell(f"{file}: {why}, to be made again")
    if not only_tell:
        Path(file).unlink()


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

    `gearmesh.reproduction.claims.checking` imports the checks of all figures; a figure depends on its
    own, and on what these import.
    """
    checks = {provenance.module(f"reproduction/claims/{name}") for name in paths.CHECKED}
    own = provenance.module(f"reproduction/claims/{figure}")
    others = {_relative(check) for check in checks - {own, *provenance.sources(own)}}
    return [file for file in sources(*files) if file not in others]


def claims_digest(ledger: Sequence[Claim], figure: str) -> str:
    """Return the digest of the claims that belong to a figure."""
    return _digest([claim for claim in ledger if claim.figure == figure])


def templates() -> list[str]:
    """Return the templates of the report."""
    return sorted(
        _relative(file) for file in provenance.module("report/templates").with_suffix("").iterdir()
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
