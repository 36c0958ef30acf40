"""The committed findings: the study and the notes agree with them."""

import re

import pytest

from gearmesh.data import paths
from gearmesh.errors import InputError
from gearmesh.identification import layout, table
from gearmesh.identification.estimation import inference
from gearmesh.identification.factors import KINDS
from gearmesh.identification.sampling import design
from gearmesh.identification.settings import load_settings
from gearmesh.report.identified import OPEN
from gearmesh.reproduction.claims import load_ledger

SETTINGS = layout.SETTINGS


def test_findings_survive_their_file(tmp_path):
    found = {name: {"a b": [1.0, 2.5]} for name in
             ("samples", "claims", "joint", "regions", "sensitivity", "recovery")}  # fmt: skip
    table.write(tmp_path / "found.yaml", found)
    assert table.read(tmp_path / "found.yaml") == found
    (tmp_path / "found.yaml").write_text("samples: {}\n")
    with pytest.raises(InputError, match="make identify"):
        table.read(tmp_path / "found.yaml")


def test_the_committed_findings_are_those_of_the_ledger(root):
    found = table.read(root / layout.IDENTIFIED)
    settings = load_settings(root / SETTINGS)
    ledger = load_ledger(root / paths.CLAIMS)
    tested = [claim.id for claim in ledger if claim.figure != "printed"]
    tested.remove("F3.4b")  # another reading of F3.4 is no further evidence
    assert list(found["claims"]) == tested
    assert found["samples"] == {name: d.points for name, d in settings.designs.items()}
    assert found["recovery"]["recovered"] >= 0.9 * found["recovery"]["papers"]
    assert found["recovery"]["papers"] >= 10
    for reading in ("plausible", "natural"):
        assert found["regions"][reading]["forgiven"] == 0
        assert found["regions"][reading]["samples"] >= inference.ENOUGH
        for name, region in found["regions"][reading]["factors"].items():
            if name == "kind":
                assert region.keys() == set(KINDS)
                continue
            bounds = settings.ranges[name]
            low, high = region["region"]
            assert bounds.low <= low < high <= bounds.high


REASONS = {
    "backlash": "backlash s",
    "damping_length": "damping length ℓ",
    "body_mass": "body mass m",
    "bearing_stiffness": "bearing stiffness c_b",
    "bearing_damping_ratio": "bearing damping ratio ζ_b",
    "friction_coefficient": "friction coefficient f_T",
    "initial_phase": "initial condition",
}
"""Parameter -> its row in docs/assumptions.md."""


def rounded(*ends: float) -> set[str]:
    return {f"{end:.{digits}g}" for end in ends for digits in (2, 3)}


@pytest.mark.parametrize("factor", REASONS)
def test_the_study_states_the_ranges_that_were_identified(root, pair, factor):
    found = table.read(root / layout.IDENTIFIED)
    limits = [s["to"] for s in found["beside"][factor].values() if s["then fail"]]
    (reason,) = (p.reason for p in pair.parameters if p.name == factor)
    said, _, _ = reason.partition(";")
    if not limits:
        assert said.startswith("the claims leave it open")
        return
    assert said.startswith("the claims need ")
    numbers = re.findall(r"\d+(?:\.\d+)?", re.sub(r"\(.*?\)", "", said))
    assert len(numbers) == len(limits)
    assert all(stated in rounded(limit) for stated, limit in zip(numbers, limits, strict=True))


@pytest.mark.parametrize("factor", REASONS)
def test_the_note_states_the_ranges_that_were_identified(root, factor):
    found = table.read(root / layout.IDENTIFIED)
    note = (root / "docs" / "assumptions.md").read_text(encoding="utf-8")
    (row,) = (r for r in note.splitlines() if r.startswith(f"| {REASONS[factor]} |"))
    said, _, _ = row.split("|")[3].strip().partition(". ")
    limits = [s["to"] for s in found["beside"][factor].values() if s["then fail"]]
    if not limits:
        assert not said.startswith("Identified")
        return
    assert said.startswith("Identified: ")
    numbers = set(re.findall(r"\d+(?:\.\d+)?", said))
    region = found["regions"]["plausible"]["factors"][factor]["region"]
    assert numbers <= rounded(*limits, *region)
    assert all(numbers & rounded(limit) for limit in limits)


def test_the_study_lies_where_the_evidence_wants_it(root, pair):
    found = table.read(root / layout.IDENTIFIED)
    space, free = load_settings(root / SETTINGS), OPEN
    for reading in ("plausible", "natural"):
        for name, region in found["regions"][reading]["factors"].items():
            if name == "kind":
                continue
            value = space.ranges[name].unit(design.stated(pair)[name])
            low, high = (space.ranges[name].unit(end) for end in region["region"])
            # Ends that close to those of the range are none of the claims' doing.
            assert (low < free or low <= value) and (high > 1 - free or value <= high), name
