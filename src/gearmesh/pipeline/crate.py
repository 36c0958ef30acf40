"""The provenance of a study as a Workflow Run RO-Crate.

The crate is the folder of the study. It names what went into the study (copies are kept in
`inputs/`), its parameters, the workflow, an action for each job with the files that it read and
wrote, and the hash of each file. The case files of a variant stand in it as one folder; the
manifest of their job has their hashes.

The same inputs give the same bytes. So the actions have no times, which the profile recommends but
does not require, and the crate is dated as the version of the code is.
"""

import json
import shutil
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from rocrate.model import ContextEntity, DataEntity
from rocrate.rocrate import ROCrate

from gearmesh import __version__
from gearmesh.data import manifest, provenance, writing
from gearmesh.data.paths import Places
from gearmesh.pipeline.inputs import CITATION, inputs
from gearmesh.study.cases import Study
from gearmesh.study.reading import yamlfile

_WORKFLOW_CRATE = "https://w3id.org/workflowhub/workflow-ro-crate/1.0"
PROFILES = (
    ("https://w3id.org/ro/wfrun/process/0.5", "Process Run Crate", "0.5"),
    ("https://w3id.org/ro/wfrun/workflow/0.5", "Workflow Run Crate", "0.5"),
    (_WORKFLOW_CRATE, "Workflow RO-Crate", "1.0"),
)
_SHA256 = "https://w3id.org/ro/terms/workflow-run#sha256"
_SNAKEMAKE = "https://w3id.org/workflowhub/workflow-ro-crate#snakemake"
_MIT = "https://spdx.org/licenses/MIT"

NOT_DESCRIBED = {
    *("crate", "hashes", "verdict"),  # they come after the crate
    *("samples", "box", "all_samples", "identified", "identification_notebook"),
}
"""Stages whose jobs are not part of the crate; `make identify` is a run of its own."""

_AUTHORS = "#authors"
_BIOSCHEMAS = "https://bioschemas.org/profiles/ComputationalWorkflow/1.0-RELEASE"

FORMATS = {
    ".nc": "application/x-netcdf",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".json": "application/json",
    ".html": "text/html",
    ".ipynb": "application/x-ipynb+json",
    ".yaml": "application/yaml",
}
"""Media types by endings; all other files are plain text."""


def write_crate(study: Study, places: Places) -> list[Path]:
    """Write the crate and the copies of the inputs; returns all files."""
    copies = {path: places.inputs / _below(path) for path in inputs(study)}
    for path, copy in copies.items():
        with writing.replacing(copy) as temporary:
            shutil.copyfile(path, temporary)
    described = json.dumps(_Crate(study, places, copies).describe(), indent=1, ensure_ascii=False)
    writing.write_text(places.crate, described + "\n")
    return [places.crate, *copies.values()]


def _below(path: Path) -> Path:
    """Return where the copy of a file stands; one from outside the project has its name only."""
    try:
        return path.resolve().relative_to(Path.cwd())
    except ValueError:
        return Path(path.name)


class _Crate:
    """The crate of a study while it is put together."""

    def __init__(self, study: Study, places: Places, copies: Mapping[Path, Path]) -> None:
        self.study = study
        self.places = places
        self.inputs = [copy.relative_to(places.folder).as_posix() for copy in copies.values()]
        self.workflow = self.inputs[0]
        self.hashes = manifest.Hashes(places.folder)
        self.crate = ROCrate(version="1.1")
        self.crate.metadata.extra_terms["sha256"] = _SHA256

    def describe(self) -> dict[str, Any]:
        """Return the crate as JSON-LD."""
        self._code()
        parameters = self._parameters()
        self._inputs(parameters)
        jobs = [*self._jobs()]
        written = [part for _, _, parts in jobs for part in parts]
        run = self._add(
            "#run",
            "CreateAction",
            name=f"Run of the study {self.study.name}",
            description="All jobs of the workflow, each of which has an action of its own",
            instrument=_link(self.workflow),
            object=[
                *(_link(name) for name in self.inputs[1:]),
                *(_link(f"#value-{name}") for name in parameters),
            ],
            result=[_link(name) for name in dict.fromkeys(written)],
            actionStatus="http://schema.org/CompletedActionStatus",
        )
        actions = [self._job(*job) for job in jobs]
        self._root([run, *actions])
        described: dict[str, Any] = self.crate.metadata.generate()
        return described

    def _add(self, place: str, kind: str, **properties: Any) -> ContextEntity:
        return self.crate.add(ContextEntity(self.crate, place, {"@type": kind, **properties}))

    def _file(self, path: str, kind: tuple[str, ...] = ("File",), **properties: Any) -> None:
        """Add a file of the folder, with its hash."""
        stated: dict[str, Any] = {
            "@type": kind[0] if len(kind) == 1 else [*kind],
            "name": path,
            "sha256": self.hashes.of([path])[path],
            "encodingFormat": FORMATS.get(Path(path).suffix, "text/plain"),
        }
        self.crate.add(DataEntity(self.crate, path, stated | properties))

    def _root(self, actions: list[ContextEntity]) -> None:
        cited: Any = yamlfile.read_mapping(CITATION)
        root = self.crate.root_dataset
        root["name"] = self.study.title
        root["description"] = f"Results of the study {self.study.name}. {cited['abstract']}"
        authors = self._add(_AUTHORS, "Organization", name=cited["authors"][0]["name"])
        root["author"] = root["publisher"] = authors
        self.crate.metadata["conformsTo"] = [
            _link(self.crate.metadata.profile),
            _link(_WORKFLOW_CRATE),
        ]
        root["datePublished"] = cited["date-released"]
        root["license"] = self._add(_MIT, "CreativeWork", name="MIT License", identifier=_MIT)
        root["conformsTo"] = [
            self._add(uri, "CreativeWork", name=name, version=version)
            for uri, name, version in PROFILES
        ]
        root["mentions"] = actions
        root["mainEntity"] = _link(self.workflow)

    def _code(self) -> None:
        """Add the package, the libraries that decide the numbers, and the stages."""
        versions = provenance.versions()
        libraries = [name for name in versions if name != "gearmesh"]
        for name in libraries:
            self._add(f"#{name}", "SoftwareApplication", name=name, softwareVersion=versions[name])
        self._add(
            "#gearmesh",
            "SoftwareApplication",
            name="gearmesh",
            softwareVersion=__version__,
            description=f"SHA-256 of the sources of the solvers: {provenance.physics_digest()}",
            softwareRequirements=[_link(f"#{name}") for name in libraries],
        )
        self._add(
            _SNAKEMAKE,
            "ComputerLanguage",
            name="Snakemake",
            url="https://snakemake.readthedocs.io",
            identifier="https://snakemake.readthedocs.io",
        )

    def _parameters(self) -> list[str]:
        """Add each parameter of the pair, as the workflow takes it and with its value."""
        names = []
        for parameter in self.study.pair.parameters:
            if parameter.value is None:
                continue
            names.append(parameter.name)
            self._add(
                f"#parameter-{parameter.name}",
                "FormalParameter",
                name=parameter.name,
                description=parameter.description,
                additionalType="Text" if isinstance(parameter.value, tuple) else "Float",
                valueRequired=True,
            )
            self._add(
                f"#value-{parameter.name}",
                "PropertyValue",
                name=parameter.name,
                value=repr(parameter.value),
                unitText=parameter.unit,
                exampleOfWork=_link(f"#parameter-{parameter.name}"),
            )
        return names

    def _inputs(self, parameters: list[str]) -> None:
        rules = [name for name in self.inputs if name.endswith(".smk")]
        for name in self.inputs:
            kind: tuple[str, ...] = ("File",)
            more: dict[str, Any] = {}
            if name == self.workflow:
                kind = ("File", "SoftwareSourceCode", "ComputationalWorkflow")
                more = {
                    "name": "The workflow of gearmesh",
                    "programmingLanguage": _link(_SNAKEMAKE),
                    "input": [_link(f"#parameter-{parameter}") for parameter in parameters],
                    "hasPart": [_link(rule) for rule in rules],
                    "softwareRequirements": _link("#gearmesh"),
                    "version": __version__,
                    "conformsTo": _link(_BIOSCHEMAS),
                }
            elif name in rules:
                kind = ("File", "SoftwareSourceCode")
                more = {"programmingLanguage": _link(_SNAKEMAKE), "version": __version__}
            self._file(name, kind, **more)

    def _jobs(self) -> Iterator[tuple[str, manifest.Manifest, list[str]]]:
        """Yield each job, its manifest, and the files and folders that it wrote, and add these."""
        for path in sorted(self.places.manifest("any").parent.glob("*.sha256")):
            held = manifest.read(path)
            stage = path.stem.partition("-")[0]
            if held is None or stage in NOT_DESCRIBED:
                continue
            if self.hashes.of(held.written) != held.written:
                continue  # of a job that this study has no more
            name = path.relative_to(self.places.folder).as_posix()
            self._file(name, description="SHA-256 of the files that a job wrote and read")
            parts = [name]
            folders: dict[str, int] = {}
            for file in held.written:
                if file.startswith("cases/"):
                    folder = f"{Path(file).parent.as_posix()}/"
                    folders[folder] = folders.get(folder, 0) + 1
                else:
                    self._file(file)
                    parts.append(file)
            for folder, count in folders.items():
                self._folder(folder, f"{count} case files; {name} has their SHA-256")
            yield path.stem, held, [*parts, *folders]

    def _folder(self, name: str, description: str) -> None:
        stated = {"@type": "Dataset", "name": name, "description": description}
        self.crate.add(DataEntity(self.crate, name, stated))

    def _job(self, job: str, held: manifest.Manifest, written: list[str]) -> ContextEntity:
        """Add the action of a job, and its stage if no job before it has added it."""
        stage = job.partition("-")[0]
        if self.crate.dereference(f"#stage-{stage}") is None:
            self._add(
                f"#stage-{stage}",
                "SoftwareApplication",
                name=f"gearmesh.pipeline {stage}",
                softwareVersion=__version__,
                softwareRequirements=_link("#gearmesh"),
            )
        return self._add(
            f"#job-{job}",
            "CreateAction",
            name=job,
            description=f"Digest of code, parameters and files it was made of: {held.made_of}",
            instrument=_link(f"#stage-{stage}"),
            object=_links(held.read),
            result=_links(written),
            actionStatus="http://schema.org/CompletedActionStatus",
        )


def _link(name: str) -> dict[str, str]:
    return {"@id": name}


def _links(names: Iterable[str]) -> dict[str, str] | list[dict[str, str]]:
    """Link several entities. RO-Crate wants no list around a single link."""
    links = [_link(name) for name in names]
    return links[0] if len(links) == 1 else links
