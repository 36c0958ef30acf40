"""Which sources a file depends on, in a package that is made up."""

import ast
import hashlib
import sys

import pytest

from gearmesh.data import provenance

FILES = {
    "__init__.py": "",
    "one.py": "import json\nimport yaml\nimport hypothesis\nfrom toy.sub import two\n"
    "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from toy import typed\n"
    "else:\n    from toy import typed\n",
    "two_faced.py": "if True:\n    from toy import four\n",
    "sub/__init__.py": "from ..four import four\n",
    "sub/two.py": "def f():\n    import toy.sub.three\n",
    "sub/three.py": "import toy.sub.two\n",
    "sub/deep/__init__.py": "",
    "sub/deep/leaf.py": "",
    "four.py": "",
    "typed.py": "",
    "lonely.py": "",
    "version.py": "from toy import __version__\n",
    "names.py": "from toy import anything\n",
    "whole.py": "import toy\n",
}
CACHED = (provenance._imported, provenance._imports, provenance._files, provenance._file_digest)


@pytest.fixture
def toy(tmp_path, monkeypatch):
    """Return a function from names in the package `toy`, which stands for this one, to files."""
    package = tmp_path / "toy"
    for name, text in FILES.items():
        file = package / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    monkeypatch.setattr(provenance, "PACKAGE", package)
    for one in CACHED:
        one.cache_clear()
    yield lambda *names: [package / name for name in names]
    for one in CACHED:
        one.cache_clear()


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        # Imports in functions and of packages count, those for type checking do not.
        ("one.py", ["four.py", "sub/__init__.py", "sub/three.py", "sub/two.py"]),
        ("two_faced.py", ["four.py"]),
        ("sub/three.py", ["four.py", "sub/__init__.py", "sub/three.py", "sub/two.py"]),
        ("four.py", []),
        ("version.py", []),
        ("names.py", sorted(FILES)),
        ("whole.py", ["__init__.py"]),
    ],
)
def test_the_imports_of_a_file_are_followed(toy, name, expected):
    [file] = toy(name)
    assert provenance.sources(file) == sorted(toy(*expected))


def test_a_module_is_found_with_the_packages_above_it(toy):
    found = provenance._files("toy.sub.deep.leaf")
    assert [*found] == toy("sub/__init__.py", "sub/deep/__init__.py", "sub/deep/leaf.py")
    assert [*provenance._files("toy.four")] == toy("four.py")
    assert [*provenance._files("toy.sub")] == toy("sub/__init__.py")
    assert [*provenance._files("toy.sub.two.name")] == toy("sub/__init__.py")
    assert provenance._files("json") == ()
    assert provenance._files("toy.__version__") == ()
    assert provenance.module("sub/two") == toy("sub/two.py")[0]


@pytest.mark.parametrize(
    ("statement", "names"),
    [
        ("import json, os.path", ["json", "os.path"]),
        ("from toy import four", ["toy.four"]),
        ("from toy.sub import two", ["toy.sub", "toy.sub.two"]),
        ("from . import three", ["toy.sub", "toy.sub.three"]),
        ("from .three import x", ["toy.sub.three", "toy.sub.three.x"]),
        ("from .. import four", ["toy.four"]),
        ("from ..four import x", ["toy.four", "toy.four.x"]),
        ("try:\n    import json\nexcept ImportError:\n    import yaml", ["json", "yaml"]),
        ("match 1:\n    case 1:\n        import json", ["json"]),
        ("if typing.TYPE_CHECKING:\n    import json", []),
        ("x = 1", []),
    ],
)
def test_the_names_that_a_statement_imports(toy, statement, names):
    [file] = toy("sub/two.py")
    assert [*provenance._imported_names(ast.parse(statement), file)] == names


def test_other_files_than_python_and_notebooks_import_nothing(toy, tmp_path):
    page = tmp_path / "page.html"
    page.write_text("import toy.four")
    assert provenance.sources(page) == []


MODULE = '''"""A module."""
import json


def one():
    return helper()


class Kept:
    pass


def two():
    """Two."""
    return 2
'''


def test_a_module_without_its_other_public_functions(tmp_path):
    file = tmp_path / "module.py"
    file.write_text(MODULE)
    lines = MODULE.splitlines()
    expected = [*lines[:12], "", "", ""]
    assert provenance._without_others(file, "one") == "\n".join(expected)
    expected = [*lines[:4], "", "", *lines[6:]]
    assert provenance._without_others(file, "two") == "\n".join(expected)


def test_what_the_digest_of_code_is_made_of(toy, tmp_path, monkeypatch):
    [file, four, lonely] = toy("one.py", "four.py", "lonely.py")
    other = tmp_path / "page.html"
    other.write_text("page")

    def digest(*others, leaving_out=()):
        for one in CACHED:
            one.cache_clear()
        return provenance.code_digest(file, "one", *others, leaving_out=leaving_out)

    first = digest()
    seen = {first, digest(other), digest(leaving_out=[four]), digest(lonely)}
    assert len(seen) == 4
    assert digest(leaving_out=[lonely]) == first
    # A file that is used counts by content and by what it imports.
    other.write_text("another")
    seen.add(digest(other))
    lonely.write_text("import toy.sub.deep.leaf")
    seen.add(digest(lonely))
    before = digest(lonely)
    [leaf] = toy("sub/deep/leaf.py")
    leaf.write_text("x = 1")
    assert digest(lonely) not in seen | {before}
    # So does each module that is imported, at any depth, and the versions of other packages.
    four.write_text("x = 1")
    assert digest() != first
    second = digest()
    four.write_text("import numpy")
    third = digest()
    monkeypatch.setattr(provenance, "_version", lambda name: "0" if name == "numpy" else None)
    fourth = digest()
    monkeypatch.setattr(provenance, "_version", lambda name: "1" if name == "numpy" else None)
    assert len({first, second, third, fourth, digest()}) == 5
    known = digest()
    monkeypatch.setattr(sys, "version_info", (3, 99, 0))
    assert digest() != known
    newer = digest()
    monkeypatch.setattr(sys, "version_info", (3, 99, 1))
    assert digest() == newer  # a patch release of Python changes no result


def test_versions_are_those_of_the_packages_of_others():
    names = {"yaml", "json", "numpy.linalg", "gearmesh.model", "no_such_package", "hypothesis"}
    found = dict(provenance._versions(names))
    assert found.keys() == {"yaml", "numpy", "hypothesis"}
    import numpy
    import yaml

    assert (found["yaml"], found["numpy"]) == (yaml.__version__, numpy.__version__)
    assert provenance._version("mpl_toolkits") == provenance._version("matplotlib") is not None


def test_a_digest_of_files_depends_on_contents_and_order(tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    one.write_text("1")
    two.write_text("2")
    parts = [hashlib.sha256(text).digest() for text in (b"1", b"2")]
    assert provenance.digest([one, two]) == hashlib.sha256(b"".join(parts)).hexdigest()
    assert provenance.digest([two, one]) == hashlib.sha256(b"".join(parts[::-1])).hexdigest()


def test_what_decides_the_numbers_of_a_run():
    from gearmesh.solvers import sources

    assert provenance.physics_digest() == sources.digest()
    found = provenance.versions()
    assert found.keys() == {"gearmesh", *sources.LIBRARIES}
    assert all(found.values())
