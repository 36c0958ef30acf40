"""CITATION.cff and codecheck.yml: they state what is so."""

import re
from pathlib import Path

import yaml

import gearmesh

ROOT = Path(__file__).parents[1]
CITED = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
CHECK = yaml.safe_load((ROOT / "codecheck.yml").read_text(encoding="utf-8"))
KEYS = {
    *("cff-version", "message", "title", "abstract", "type", "license", "version"),
    *("date-released", "authors", "references"),
}
"""Keys of CFF 1.2.0 that the file uses."""


def test_citation_has_what_the_format_requires():
    assert CITED.keys() == KEYS
    assert CITED["cff-version"] == "1.2.0"
    assert CITED["type"] == "software"
    for work in (CITED, *CITED["references"]):
        assert work["title"] and all(author.keys() == {"name"} for author in work["authors"])
    for reference in CITED["references"]:
        assert reference["type"] == "conference-paper"
        assert re.fullmatch(r"[A-Z]{2}", reference["conference"]["country"])


def test_citation_is_of_this_version():
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert CITED["version"] == gearmesh.__version__
    assert f"## {CITED['version']}, {CITED['date-released']}\n" in changes
    assert f'license = "{CITED["license"]}"' in (ROOT / "pyproject.toml").read_text()


def test_codecheck_names_what_the_pipeline_makes(study):
    assert CHECK["version"] == "https://codecheck.org.uk/spec/config/1.0/"
    assert CHECK["paper"]["title"] == CITED["references"][0]["title"].strip()
    figures = {f"results/paper/figures/fig{n}.png" for n in range(1, 8)}
    listed = {entry["file"] for entry in CHECK["manifest"]}
    assert figures <= listed
    assert {"results/paper/claims.json", "results/paper/verification.json"} <= listed
    assert all(entry["comment"] for entry in CHECK["manifest"])
