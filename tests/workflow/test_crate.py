"""The provenance of a study: a valid Workflow Run RO-Crate that names what is there."""

import json
from hashlib import sha256
from pathlib import Path

import pytest
import rdflib.plugins.shared.jsonld.context as jsonld
import rocrate
from rocrate_validator import services
from rocrate_validator.models import Severity, ValidationSettings

BIOSCHEMAS = "https://bioschemas.org/"
BEFORE_1_3 = {
    "ComputationalWorkflow": BIOSCHEMAS + "ComputationalWorkflow",
    "FormalParameter": BIOSCHEMAS + "FormalParameter",
    "input": BIOSCHEMAS + "ComputationalWorkflow#input",
    "output": BIOSCHEMAS + "ComputationalWorkflow#output",
}
"""The terms of the JSON-LD context 1.1 that are others in 1.3, the one that rocrate brings."""

ONLINE = ["ro-crate-1.1_3.1", "ro-crate-1.1_3.2"]
"""Checks that fetch the context."""

NOT_FOLLOWED = (
    "an endTime",  # results have no times, so that the same inputs give the same bytes
    "an agent",  # they do not know who ran the workflow
    "have a url",  # the jobs are stages of gearmesh, which has no address of its own
    "have a URL",
    "be an absolute URI",
    "README.md",  # the crate is described by its report
)
"""Recommendations that the crate does not follow."""


@pytest.fixture
def without_network(monkeypatch):
    text = (Path(rocrate.__file__).parent / "data" / "ro-crate.jsonld").read_text()
    context = {"@context": json.loads(text)["@context"] | BEFORE_1_3}
    monkeypatch.setattr(jsonld.Context, "_fetch_context", lambda *_: context["@context"])


def findings(folder: Path, severity: Severity) -> set[str]:
    settings = ValidationSettings(
        rocrate_uri=str(folder),
        profile_identifier="workflow-run-crate-0.5",
        requirement_severity=severity,
        abort_on_first=False,
        no_cache=True,
        skip_checks=ONLINE,
    )
    issues = services.validate(settings).get_issues()
    return {f"{issue.severity.name}: {issue.message}" for issue in issues}


def test_crate_is_a_valid_workflow_run_crate(smoke, without_network):
    found = findings(smoke.study, Severity.RECOMMENDED)
    assert {text for text in found if not any(part in text for part in NOT_FOLLOWED)} == set()


def test_validator_notices_what_is_missing(smoke, without_network, tmp_path):
    crate = json.loads((smoke.study / "ro-crate-metadata.json").read_text())
    for entity in crate["@graph"]:
        if entity["@id"] == "#run":
            del entity["instrument"]
    (tmp_path / "ro-crate-metadata.json").write_text(json.dumps(crate))
    assert any("instrument" in text for text in findings(tmp_path, Severity.REQUIRED))


def test_crate_names_every_file_of_the_run_with_its_hash(smoke):
    crate = json.loads((smoke.study / "ro-crate-metadata.json").read_text())["@graph"]
    hashes = {entity["@id"]: entity["sha256"] for entity in crate if "sha256" in entity}
    for name, digest in hashes.items():
        assert sha256((smoke.study / name).read_bytes()).hexdigest() == digest, name
    folders = {entity["@id"] for entity in crate if entity["@id"].startswith("cases/")}
    listed = (smoke.study / "manifest.sha256").read_text().splitlines()
    written = {line.split("  ", 1)[1] for line in listed}
    after = {"ro-crate-metadata.json"}
    assert written - hashes.keys() - after == {
        name for name in written if f"{Path(name).parent.as_posix()}/" in folders
    }


def test_crate_states_the_parameters_with_units(smoke):
    crate = json.loads((smoke.study / "ro-crate-metadata.json").read_text())["@graph"]
    values = {
        e["name"]: (e["value"], e["unitText"]) for e in crate if e["@id"].startswith("#value")
    }
    assert values["backlash"] == ("0.08", "mm")
    assert values["teeth"] == ("21", "1")
