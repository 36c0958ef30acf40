"""The plan of a study for the Snakefile: where its results go, and what each job is made of.

A job runs again when its manifest does not hold: when a file that it wrote or read is missing or
was changed, or when it was made of something else. The manifests are checked when Snakemake starts
(`Plan.check`), so neither the times of files nor Snakemake's own records matter.
"""

import getpass
import hashlib
import os
import re
import shlex
import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from glob import glob
from pathlib import Path

from gearmesh.data import casefile, manifest, paths, provenance
from gearmesh.data.paths import Places
from gearmesh.errors import InputError
from gearmesh.identification import layout
from gearmesh.identification.sampling.design import left_alone, stated
from gearmesh.identification.settings import Settings, load_settings
from gearmesh.pipeline import locks
from gearmesh.pipeline.inputs import RULES, inputs
from gearmesh.pipeline.messages import say
from gearmesh.pipeline.stages import STAGES, job_name
from gearmesh.reproduction.claims import Claim, load_ledger
from gearmesh.study.cases import Case, Mechanisms, Study
from gearmesh.study.loading import load_study
from gearmesh.study.speeds import check_constant_speed

_TEMPLATES = provenance.PACKAGE / "report" / "templates"
_SCRIPTS = provenance.PACKAGE / "report" / "explorer" / "scripts"
_STYLE = provenance.PACKAGE / "reproduction" / "figures" / "gearmesh.mplstyle"


_FAR_FUTURE = 2**32 - 1
"""A time later than that of any result, in seconds: the year 2106."""


@dataclass
class Plan:
    """A study and the plan of its jobs.

    Attributes
    ----------
    study : Study
        What its file states.
    holding : frozenset of str, optional
        The jobs whose manifest holds, see `check`; without it no manifest counts.
    """

    study: Study
    holding: frozenset[str] | None = None
    _digests: dict[str, str] = field(default_factory=dict, repr=False)

    @cached_property
    def places(self) -> Places:
        """Where its results go."""
        return Places(self.study.name)

    @cached_property
    def letters(self) -> dict[str, list[Case]]:
        """The cases of each letter of Tab. 1."""
        return {letter: self.study.of_letter(letter) for letter in self.study.letters}

    @cached_property
    def ledger(self) -> list[Claim]:
        """The claims that the study is checked against; a study of one's own has none."""
        return load_ledger(self.study.claims) if self.study.claims else []

    @property
    def mechanisms(self) -> Mechanisms:
        """The orbits and attractors that the study asks for."""
        if self.study.plan.mechanisms is None:
            raise KeyError("mechanisms")
        return self.study.plan.mechanisms

    @cached_property
    def designs(self) -> Settings:
        """The designs of the identification."""
        return load_settings(layout.SETTINGS)

    @cached_property
    def pair(self) -> dict[str, str | float]:
        """What all cases share: parameters, solver, versions."""
        return casefile.common_attributes(self.study.pair)

    def made_of(self, stage: str, *arguments: str) -> str:
        """Return the digest of all that a job is made of besides files of results.

        Parameters
        ----------
        stage : str
            One of `gearmesh.pipeline.stages.STAGES`.
        *arguments : str
            Which of its jobs.
        """
        job = job_name(stage, *arguments)
        if job not in self._digests:  # asked for twice: to check the manifest, and to run
            self._digests[job] = self._digest(stage, *arguments)
        return self._digests[job]

    def _digest(self, stage: str, *arguments: str) -> str:
        function = STAGES[stage]
        module = Path(function.__code__.co_filename)
        files, unused = _files(stage, *arguments)
        code = provenance.code_digest(module, stage, *files, leaving_out=unused)
        facts = _FACTS[stage](self, *arguments) if stage in _FACTS else ()
        return hashlib.sha256(repr((code, facts, _commands()[stage])).encode()).hexdigest()

    def again(self, stage: str, *arguments: str) -> list[Path]:
        """Return the input that makes a job run again, nothing while its manifest holds."""
        if self.holding is None or job_name(stage, *arguments) in self.holding:
            return []
        return [self.places.again]

    def check(self) -> frozenset[str] | None:
        """Return the jobs whose manifest holds, None if another run is in charge.

        The reasons why other manifests do not hold are printed.

        Raises
        ------
        InputError
            If the folder of results cannot be written.
        """
        with locks.alone(self.places) as undisturbed:
            if not undisturbed:  # `locks.begin_run` will report it
                return None
            hashes = manifest.Hashes(self.places.folder)
            reasons: dict[str, list[str]] = {}
            for file in sorted(self.places.manifest("x").parent.glob("*.sha256")):
                reasons.setdefault(self._why(file, hashes), []).append(file.stem)
        holding = reasons.pop("", [])
        for why, jobs in reasons.items():
            say(f"{why}; to be made again: {', '.join(jobs)}")
        # Its content is new too, for Snakemake compares the checksums of small files.
        self.places.again.write_text(str(time.time_ns()))
        os.utime(self.places.again, (_FAR_FUTURE, _FAR_FUTURE))
        return frozenset(holding)

    def _why(self, file: Path, hashes: manifest.Hashes) -> str:
        """Return why a job has to run again, nothing if its manifest holds."""
        held = manifest.read(file)
        stage, *arguments = file.stem.split("-")
        if held is None or held.made_of != self._made_of(stage, arguments):
            return "other parameters or code"
        faults = _faults(held.written, hashes) | _faults(held.read, hashes)
        faults |= {name: "not of this study" for name in self._foreign(stage, held, arguments)}
        return _named(self.places, faults) if faults else ""

    def _made_of(self, stage: str, arguments: Sequence[str]) -> str | None:
        """Return what a job is made of, None if this study has no such job."""
        try:
            return self.made_of(stage, *arguments)
        except (KeyError, TypeError):
            return None

    def _foreign(self, stage: str, found: manifest.Manifest, arguments: Sequence[str]) -> list[str]:
        """Return case files that none of the study's jobs has written."""
        if stage != "cases":
            return []
        pattern = f"{self.places.cases.name}/{arguments[0]}-*/*"
        there = glob(pattern, root_dir=self.places.folder, include_hidden=True)
        return sorted({*there} - found.written.keys())


def _faults(recorded: Mapping[str, str], hashes: manifest.Hashes) -> dict[str, str]:
    """Return what is wrong with files, by their names."""
    return {
        name: "missing" if digest is None else "damaged"
        for name, digest in hashes.of(recorded).items()
        if digest != recorded[name]
    }


def _named(places: Places, faults: Mapping[str, str]) -> str:
    """Write the first of some files, what is wrong with it, and how many others there are."""
    first, *others = faults
    more = f" (and {len(others)} more)" if others else ""
    return f"{places.folder / first}{more}: {faults[first]}"


@cache
def _commands() -> dict[str, str]:
    """Return the shell commands of each stage, as the rules state them."""
    text = "".join(file.read_text(encoding="utf-8") for file in sorted(RULES.glob("*.smk")))
    commands = re.findall(r"^ +shell:\n((?: +[\"'].*\n)+)", text, re.MULTILINE)
    found: dict[str, str] = {}
    for command in commands:
        for name in _RUNS.findall(command):
            # `report` has a rule for each kind of study.
            found[name] = found.get(name, "") + command
    return found


_RUNS = re.compile(r"gearmesh\.pipeline (\w+) ")


def _files(stage: str, *arguments: str) -> tuple[list[Path], list[Path]]:
    """Return committed files that a job uses, and modules that it imports but does not use.

    `gearmesh.reproduction.claims.checking` imports the checks of all figures; a figure depends on
    its own, and on what these import.
    """
    if stage == "figure" or stage == "printed":
        [figure] = arguments or ["printed"]
        own = provenance.module(f"reproduction/claims/{figure}")
        checks = {provenance.module(f"reproduction/claims/{name}") for name in paths.CHECKED}
        files = [paths.notebook(figure), _STYLE, _TEMPLATES / "claims.html.j2"]
        return files if arguments else [], [*checks - {own, *provenance.sources(own)}]
    return _COMMITTED.get(stage, list)(), []


def _templates() -> list[Path]:
    return sorted(_TEMPLATES.iterdir())


_COMMITTED: dict[str, Callable[[], list[Path]]] = {
    "fig1": lambda: [_STYLE],
    "identified_figures": lambda: [_STYLE, layout.IDENTIFIED, layout.SETTINGS],
    "study_figures": lambda: [_STYLE],
    "why": lambda: [
        *(paths.notebook(paths.WHY), _STYLE),
        *(_TEMPLATES / name for name in ("points.html.j2", "parts.html.j2")),
    ],
    "notebook_pages": lambda: [
        _TEMPLATES / name for name in ("notebook.html.j2", "base.html.j2", "report.css")
    ],
    "explorer": lambda: [
        *(
            _TEMPLATES / name
            for name in ("explorer.html.j2", "base.html.j2", "explorer.css", "report.css")
        ),
        *sorted(_SCRIPTS.rglob("*.js")),
    ],
    "report": lambda: [
        *_templates(),
        *(paths.CAPTIONS / f"{name}.rst" for name in (*paths.FIGURE_NAMES, *paths.WHY_FIGURES)),
        *(layout.IDENTIFIED, layout.SETTINGS, paths.CLAIMS, paths.GLOSSARY),
    ],
    "box": lambda: [paths.CLAIMS],
    "identified": lambda: [layout.SETTINGS, paths.CLAIMS],
    "identification_notebook": lambda: [
        *(paths.notebook("identification"), layout.SETTINGS, paths.CLAIMS, _STYLE),
        _TEMPLATES / "identification.html.j2",
    ],
}
"""Committed files that a stage uses, besides code."""

_FACTS: dict[str, Callable[..., object]] = {
    "cases": lambda plan, letter: (
        plan.pair,
        [(case.variant.name, case.nu, case.time_course) for case in plan.letters[letter]],
        (plan.study.plan.case_files, plan.study.plan.direction),
    ),
    "datasets": lambda plan: (plan.study.title, plan.pair, _grid(plan.study)),
    "thresholds": lambda plan: (plan.pair, plan.study.variants),
    "branches": lambda plan: (
        *(plan.study.title, plan.pair, plan.mechanisms.variants, _grid(plan.study)),
        plan.study.plan.nu.all,
    ),
    **{
        stage: lambda plan: (plan.study.title, plan.pair, plan.mechanisms)
        for stage in ("basins", "ensembles", "special_curves", "why")
    },
    "figure": lambda plan, name: (
        *(plan.study.title, plan.pair, plan.study.time_courses),
        _of_figure(plan.ledger, name),
    ),
    "identified_figures": lambda plan: sorted(stated(plan.study.pair).items()),
    "printed": lambda plan: (plan.pair, _of_figure(plan.ledger, "printed")),
    "ledger": lambda plan: plan.ledger,
    "explorer": lambda plan: _statements(plan.study),
    "report": lambda plan: (_statements(plan.study), _verified(plan.places)),
    "crate": lambda plan: (
        _statements(plan.study),
        [(str(path), provenance.digest([path])) for path in inputs(plan.study)],
    ),
    "samples": lambda plan, design, index: (
        left_alone(plan.designs.designs[design], plan.study.pair),
        provenance.versions(),
        plan.designs.sampling(design),
    ),
    "box": lambda plan, design: plan.designs.sampling(design),
    "identification_notebook": lambda plan: plan.pair,
}
"""The parts of the study and of the settings of the identification that a job depends on."""


def _grid(study: Study) -> list[tuple[str, Sequence[float]]]:
    return [(variant.name, nus) for variant, nus in study.plan.frequencies()]


def _of_figure(ledger: Iterable[Claim], figure: str) -> list[Claim]:
    return [claim for claim in ledger if claim.figure == figure]


def _verified(places: Places) -> str | None:
    """Return the hash of what `make verify` found; the report shows it."""
    name = places.verification.name
    return manifest.Hashes(places.folder).of([name])[name]


def _statements(study: Study) -> tuple[object, ...]:
    return study.name, study.pair.parameters, study.plan.model_dump_json()


def load(
    options: Mapping[str, object], configfiles: Sequence[Path | str], main: bool = True
) -> Plan:
    """Load the study that a run of Snakemake asks for.

    Parameters
    ----------
    options : mapping
        Settings of the command line, ``--config study=FILE``.
    configfiles : sequence
        Files of ``--configfile``, which names a study as well.
    main : bool
        Whether this process plans the run; jobs on a cluster load the Snakefile too.

    Raises
    ------
    InputError
        One line, if a setting or the study is wrong.
    """
    for name in options:
        if name != "study":
            raise InputError(f"--config {name}: unknown; allowed is study=FILE")
    if len(configfiles) + len(options) > 1:
        raise InputError(
            "--config study=FILE and --configfile FILE: found several studies; allowed is one"
        )
    [path] = [*configfiles, *options.values()] or [paths.PAPER]
    if Path("src/gearmesh").resolve() != provenance.PACKAGE:
        raise InputError(
            f"the code would come from {provenance.PACKAGE}, not from this folder; "
            "run 'make reproduce', which sets up an environment here"
        )
    _name_the_user()
    study = load_study(str(path))
    check_constant_speed(study.pair, f"{path}: each case of a study")
    study.check_samples()
    plan = Plan(study)
    _ = plan.designs, plan.ledger  # a mistake in them is reported before all jobs
    if main:
        plan.holding = plan.check()
    return plan


def _name_the_user() -> None:
    """Give a name to a user whom the system does not know; Snakemake cannot run without one."""
    try:
        getpass.getuser()
    except (KeyError, OSError):
        os.environ["USER"] = str(os.getuid())


def prefix(plan: Plan) -> str:
    """Return what goes before each shell command: where `python` is, and which study runs.

    It takes the place of Snakemake's own prefix, so it repeats that a command fails with any part
    of it: the logs are written through a pipe. Jobs run side by side, so the matrix library takes
    one thread for each. With more, a small matrix takes a hundred times as long. Jobs do
    not inherit settings of the caller's Python. Without bytecode, as in many containers, each job
    would compile all modules. With warnings as errors, a warning in a library would stop a job.
    """
    folder = shlex.quote(str(Path(sys.executable).parent))
    study = shlex.quote(str(plan.study.path))
    return (
        f"set -euo pipefail; export PATH={folder}:$PATH STUDY={study} OPENBLAS_NUM_THREADS=1; "
        "unset NUMBA_DISABLE_JIT PYTHONDONTWRITEBYTECODE PYTHONOPTIMIZE PYTHONWARNINGS; "
    )
