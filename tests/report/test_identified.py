"""How the report words what was identified."""

import re

import pytest

from gearmesh.data import paths
from gearmesh.identification import layout, table
from gearmesh.identification.settings import Range, load_settings
from gearmesh.report import identified
from gearmesh.reproduction.claims import load_ledger


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
    assert identified.within(region, bounds) == said


def test_run_out_is_told_by_what_it_costs():
    found = {
        "with friction": {"F1": 0.0, "F2": 0.5, "F3": 3.0, "F4": 0.0},
        "without friction": {"F1": 2.0, "F2": 3.0, "F3": 0.0, "F4": 0.0},
    }
    costs = identified.run_out_costs(found, ["F1", "F2", "F3"])
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
            r"F7\.1 fails with the least \(because of the missing friction\); all other claims "
            r"that hold in this study hold up to the greatest .* 1\.5 static deflections\. The "
            r"paper therefore describes wheels without run-out, or friction .* the run-out\.</p>",
        ),
        (  # run-out costs nothing at first
            {"F2.1": 3.0, "F7.1": 2.0},
            {"F2.1": 1.5, "F7.1": 3.0},
            "no claim is lost by the least run-out that was tried. 32 samples .* does: all "
            r"claims that hold in this study hold up to an eccentricity of 1\.5 static "
            r"deflections, beyond which F2\.1 fails\.</p>",
        ),
        (  # one claim fails by friction, one by the eccentricity itself
            {"F2.1": 0.0, "F7.1": 0.0},
            {"F2.1": 2.0, "F7.1": 0.0},
            r"F2\.1, F7\.1 fail with the least run-out that was tried\. The reason for F2\.1 is "
            r"friction: .* does: F7\.1 fails with the least; all other .* The paper therefore "
            r"describes wheels without run-out\.</p>",
        ),
        (  # friction has no part in it
            {"F2.1": 0.0, "F7.1": 0.0},
            {"F2.1": 0.0, "F7.1": 0.0},
            r"was tried\. 32 samples .* does: F2\.1, F7\.1 fail with the least; no claim that "
            r"holds in this study still holds\. The paper therefore describes wheels without "
            r"run-out\.</p>",
        ),
    ],
)
def test_the_text_on_run_out_follows_the_numbers(root, pair, with_friction, without, said):
    found = table.read(root / layout.IDENTIFIED)
    found["run-out"] = {"with friction": with_friction, "without friction": without}
    ledger, settings = load_ledger(root / paths.CLAIMS), load_settings(root / layout.SETTINGS)
    page = identified.section(found, ledger, settings, pair)
    (told,) = (line for line in page.splitlines() if line.startswith("<p>Run-out"))
    assert re.search(said, told), told
