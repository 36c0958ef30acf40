"""The digest of the code of a job: what belongs to it, and what does not."""

import ast
import json

import pytest

from gearmesh.data import provenance

MODULE = '''"""A module."""


def one():
    """Return one."""
    return _help()


def two():
    """Return two."""
    return 2


def _help():
    return 1
'''


@pytest.mark.parametrize(
    ("old", "new", "same"), [("return 2", "return 3", True), ("return 1", "return 3", False)]
)
def test_a_function_depends_on_private_helpers_but_on_no_other_public_function(
    tmp_path, old, new, same
):
    before, after = tmp_path / "before.py", tmp_path / "after.py"
    before.write_text(MODULE)
    after.write_text(MODULE.replace(old, new))
    digests = [provenance.code_digest(file, "one") for file in (before, after)]
    assert (digests[0] == digests[1]) is same


def test_the_imports_of_a_notebook_are_followed(tmp_path):
    lines = ["%matplotlib inline\n", "from gearmesh.model import damping\n", "!ls\n"]
    code = {"cell_type": "code", "source": [*lines, "import gearmesh.data.paths"]}
    text = {"cell_type": "markdown", "source": ["import gearmesh.model.friction"]}
    notebook = tmp_path / "notebook.ipynb"
    notebook.write_text(json.dumps({"cells": [text, code]}))
    found = provenance.sources(notebook)
    assert {provenance.module("model/damping"), provenance.module("data/paths")} <= {*found}
    assert provenance.module("model/friction") not in found


@pytest.mark.parametrize(
    ("statement", "name"),
    [
        ("from .extra import VALUE", "gearmesh.data.extra"),
        ("from ..model import damping", "gearmesh.model.damping"),
        ("def f():\n    from gearmesh.data import paths", "gearmesh.data.paths"),
    ],
)
def test_imports_are_found_where_they_stand(statement, name):
    place = provenance.PACKAGE / "data" / "module.py"
    assert name in {*provenance._imported_names(ast.parse(statement), place)}
