"""The committed findings, and how they are put into words."""

import re

import pytest

from gearmesh.data import paths
from gearmesh.errors import InputError
from gearmesh.identification import design, inference, layout, presentation, table
from gearmesh.identification.settings import KINDS, Range, load_settings
from gearmesh.paper.claims import load_ledger

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
    tested = [claim.id for claim in load_ledger(root / paths.CLAIMS) if claim.figure != "printed"]
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


@pytest.mark.parametrize(
    ("region", "said"),
    [
        ((2.0, 10.0), "2 to 10"),
        ((1.1, 10.0), "up to 10"),  # no end of a region of its own: the range has its there
        ((2.0, 98.0), "2 or more"),
        ((1.1, 98.0), "any"),
    ],
)
def test_an_interval_names_the_ends_that_the_claims_set(region, said):
    bounds = Range(low=1.0, high=100.0, scale="log", reason="a test")
    assert presentation.within(region, bounds) == said


def test_run_out_is_told_by_what_it_costs():
    found = {
        "with friction": {"F1": 0.0, "F2": 0.5, "F3": 3.0, "F4": 0.0},
        "without friction": {"F1": 2.0, "F2": 3.0, "F3": 0.0, "F4": 0.0},
    }
    costs = presentation.run_out_costs(found, ["F1", "F2", "F3"])
    assert costs == {
        "lost": ["F1"], "by_friction": ["F1"], "alone_lost": ["F3"], "need_friction": ["F3"],
        "alone_least": 2.0, "alone_fragile": ["F1"],
    }  # fmt: skip


@pytest.mark.parametrize(
    ("with_friction", "without", "said"),
    [
        (  # friction is to blame, and one claim needs it
            {"F2.1": 0.0, "F7.1": 2.0},
            {"F2.1": 1.5, "F7.1": 0.0},
            "F2.1 fails with the least run-out that was tried. The reason is friction: .* does: "
            r"F7\.1 fails with the least \(for want of friction\); all else that holds in "
            r"this study holds up to the greatest .* 1\.5 static deflections\. What the paper "
            r"describes are therefore wheels that run true, or a friction .* not turn\.</p>",
        ),
        (  # run-out costs nothing at first
            {"F2.1": 3.0, "F7.1": 2.0},
            {"F2.1": 1.5, "F7.1": 3.0},
            "no claim is lost by the least run-out that was tried. 32 samples .* does: all that "
            r"holds in this study holds up to an eccentricity of 1\.5 static deflections, beyond "
            r"which F2\.1 fails\.</p>",
        ),
        (  # one claim fails by friction, one by the eccentricity itself
            {"F2.1": 0.0, "F7.1": 0.0},
            {"F2.1": 2.0, "F7.1": 0.0},
            r"F2\.1, F7\.1 fail with the least run-out that was tried\. The reason for F2\.1 is "
            r"friction: .* does: F7\.1 fails with the least; all else .* What the paper describes "
            r"are therefore wheels that run true\.</p>",
        ),
        (  # friction has no part in it
            {"F2.1": 0.0, "F7.1": 0.0},
            {"F2.1": 0.0, "F7.1": 0.0},
            r"was tried\. 32 samples .* does: F2\.1, F7\.1 fail with the least; nothing that holds "
            r"in this study is left\. What the paper describes are therefore wheels that run "
            r"true\.</p>",
        ),
    ],
)
def test_the_text_on_run_out_follows_the_numbers(root, pair, with_friction, without, said):
    found = table.read(root / layout.IDENTIFIED)
    found["run-out"] = {"with friction": with_friction, "without friction": without}
    ledger, settings = load_ledger(root / paths.CLAIMS), load_settings(root / SETTINGS)
    page = presentation.section(found, ledger, settings, pair)
    (told,) = (line for line in page.splitlines() if line.startswith("<p>Run-out"))
    assert re.search(said, told), told


REASONS = {
    "backlash": "backlash s",
    "damping_length": "damping length ℓ",
    "body_mass": "body mass m",
    "bearing_stiffness": "support stiffness c_b",
    "bearing_damping_ratio": "support damping ζ_b",
    "friction_coefficient": "friction f_T",
    "initial_phase": "start",
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
    said = row.split("|")[3].partition(";")[0].strip()
    limits = [s["to"] for s in found["beside"][factor].values() if s["then fail"]]
    if not limits:
        assert not said.startswith("identified")
        return
    assert said.startswith("identified: ")
    numbers = set(re.findall(r"\d+(?:\.\d+)?", said))
    region = found["regions"]["plausible"]["factors"][factor]["region"]
    assert numbers <= rounded(*limits, *region)
    assert all(numbers & rounded(limit) for limit in limits)


def test_the_study_lies_where_the_evidence_wants_it(root, pair):
    found = table.read(root / layout.IDENTIFIED)
    space, free = load_settings(root / SETTINGS), presentation.OPEN
    for reading in ("plausible", "natural"):
        for name, region in found["regions"][reading]["factors"].items():
            if name == "kind":
                continue
            value = space.ranges[name].unit(design.stated(pair)[name])
            low, high = (space.ranges[name].unit(end) for end in region["region"])
            # Ends that close to those of the range are none of the claims' doing.
            assert (low < free or low <= value) and (high > 1 - free or value <= high), name
