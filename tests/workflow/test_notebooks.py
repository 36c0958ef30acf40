"""Notebooks: committed clean, parametrised, without logic, and they run."""

import ast
import json

import matplotlib as mpl
import nbformat
import pytest
from matplotlib.image import imread

from gearmesh.data import paths
from gearmesh.data.paths import Places
from gearmesh.reproduction.claims import load_ledger, read_entries
from gearmesh.reproduction.figures import canvas

PAPER, SMOKE = Places("paper"), Places("smoke")
PLACES = {
    "configuration": paths.PAPER,
    "resonance": PAPER.resonance,
    "bifurcation": PAPER.bifurcation,
    "thresholds": PAPER.thresholds,
    "cases": PAPER.cases,
    "ledger": paths.CLAIMS,
}

each_notebook = pytest.mark.parametrize("name", paths.NOTEBOOK_NAMES)


@pytest.fixture
def notebook(name, root):
    read = nbformat.read(root / paths.notebook(name), as_version=4)
    nbformat.validate(read)
    return read


def code_cells(notebook) -> list:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def parameter_cell(notebook):
    (found,) = [c for c in notebook.cells if "parameters" in c.metadata.get("tags", ())]
    return found


def test_every_figure_but_the_drawing_has_a_notebook_and_so_has_the_identification(root):
    found = sorted(path.stem for path in (root / paths.NOTEBOOKS).glob("*.ipynb"))
    assert found == sorted({*paths.FIGURE_NAMES, paths.WHY, "identification"} - {"fig1"})


@pytest.mark.parametrize("name", [*paths.NOTEBOOK_NAMES, paths.WHY])
def test_a_notebook_is_committed_without_outputs(notebook):
    for cell in code_cells(notebook):
        assert cell.outputs == []
        assert cell.execution_count is None
    assert set(notebook.metadata) == {"kernelspec", "language_info"}


@each_notebook
def test_opened_by_itself_a_notebook_reads_the_paper_s_study_and_writes_nothing(notebook):
    given = {}
    exec(parameter_cell(notebook).source, given)
    del given["__builtins__"]
    assert given.pop("figure") is None
    assert given.pop("checks") is None
    assert given == {key: f"../{PLACES[key]}" for key in given}  # from the folder of notebooks


@each_notebook
def test_a_notebook_holds_no_logic(notebook):
    """Nothing is defined, repeated or decided in a notebook: that belongs to a module."""
    logic = (ast.FunctionDef, ast.ClassDef, ast.Lambda, ast.For, ast.While, ast.If, ast.Try)
    for cell in code_cells(notebook):
        assert not [node for node in ast.walk(ast.parse(cell.source)) if isinstance(node, logic)]


@each_notebook
def test_a_notebook_shows_checks_and_explains(notebook):
    kinds = [cell.cell_type for cell in notebook.cells]
    headings = [c.source.splitlines()[0] for c in notebook.cells if c.cell_type == "markdown"]
    assert kinds == ["markdown", *["code"] * 3, "markdown", "code", "markdown"]
    assert headings[1:] == ["## What the paper claims", "## What is seen"]


@each_notebook
def test_a_notebook_needs_no_equation_renderer(notebook):
    """Its page stands without a script, so its symbols are letters."""
    assert not any("$" in c.source for c in notebook.cells if c.cell_type == "markdown")


@each_notebook
def test_a_notebook_leaves_checks_and_the_same_bytes_as_in_the_pipeline(
    name, notebook, root, small_run, smoke, tmp_path
):
    """Whatever the settings of matplotlib are."""
    given = {
        "configuration": root / paths.SMOKE,
        "ledger": root / paths.CLAIMS,
        "figure": tmp_path / name,
        "checks": tmp_path / "checks.json",
        **{
            key: small_run / getattr(SMOKE, key)
            for key in PLACES.keys() - {"configuration", "ledger"}
        },
    }
    namespace = {}
    with mpl.rc_context({"font.size": 30, "svg.hashsalt": "other", "savefig.dpi": 20}):
        for cell in code_cells(notebook):
            exec(cell.source, namespace)
            if cell is parameter_cell(notebook):
                stated = {key: str(value) for key, value in given.items() if key in namespace}
                namespace.update(stated)
    for file in (f"{name}.png", f"{name}.svg"):
        assert (tmp_path / file).read_bytes() == (smoke.study / "figures" / file).read_bytes()
    assert imread(tmp_path / f"{name}.png").shape[1] >= 200 * canvas.WIDTH
    assert b"<dc:date>" not in (tmp_path / f"{name}.svg").read_bytes()
    expected = [claim.id for claim in load_ledger(root / paths.CLAIMS) if claim.figure == name]
    assert [entry.id for entry in read_entries(tmp_path / "checks.json")] == expected


def test_the_pipeline_sets_every_parameter_of_every_notebook(root):
    """A parameter that the pipeline does not pass would silently keep its default."""
    stage = root / "src" / "gearmesh" / "pipeline" / "stages" / "figures.py"
    given = stage.read_text(encoding="utf-8")
    for name in paths.NOTEBOOK_NAMES:
        cells = json.loads((root / paths.notebook(name)).read_text(encoding="utf-8"))["cells"]
        (source,) = [c["source"] for c in cells if "parameters" in c["metadata"].get("tags", ())]
        for line in source:
            assert f'"{line.partition(" = ")[0]}":' in given
