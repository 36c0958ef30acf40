"""The packages say what they hold, and the names and files that text speaks of exist."""

import pkgutil
import re

import pytest

import gearmesh

TEXTS = (
    *("*.md", "docs/*.md", "docs/howto/*.md", "docs/reference/*.md", "benchmarks/README.md"),
    *(f"{folder}/**/*.py" for folder in ("src", "tests", "benchmarks", "verification")),
)
NAME = re.compile(r"`(gearmesh(?:\.\w+)+)")
"""A dotted name that begins in backticks."""
FILE = re.compile(
    r"`((?:benchmarks|docs|notebooks|src|tests|verification|workflow)/[\w./-]+\.\w+)`"
)
"""The path of a source or a page in backticks."""

PACKAGES = [
    module.name for module in pkgutil.walk_packages(gearmesh.__path__, "gearmesh.") if module.ispkg
]


def exists(name: str) -> bool:
    """Return whether a dotted name leads to a module, or to something in one."""
    try:
        pkgutil.resolve_name(name)
    except (AttributeError, ImportError):
        owner, _, field = name.rpartition(".")
        return owner != "gearmesh" and field in getattr(
            pkgutil.resolve_name(owner), "__annotations__", {}
        )
    return True


def quoted(root, pattern):
    """Return what matches a pattern, with the file that it stands in."""
    files = {file for texts in TEXTS for file in root.glob(texts)}
    files.discard(root / "CHANGELOG.md")  # it speaks of earlier versions
    found = {
        (match, file.relative_to(root).as_posix())
        for file in files
        for match in pattern.findall(file.read_text(encoding="utf-8"))
    }
    assert len(found) > 20
    return sorted(found)


def test_every_name_in_backticks_exists(root):
    assert [one for one in quoted(root, NAME) if not exists(one[0])] == []


def test_every_file_in_backticks_exists(root):
    assert [one for one in quoted(root, FILE) if not (root / one[0]).exists()] == []


@pytest.mark.parametrize("package", PACKAGES)
def test_every_package_says_what_it_holds(package):
    said = pkgutil.resolve_name(package).__doc__
    assert len(said.split()) > 8
