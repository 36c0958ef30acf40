"""Every place that others rely on, once; all relative to the project's root."""

from pathlib import Path

CONFIG = Path("config")
PAPER = CONFIG / "paper.yaml"
SMOKE = CONFIG / "smoke.yaml"
CLAIMS = CONFIG / "claims.yaml"
NOTEBOOKS = Path("notebooks")

RESULTS = Path("results")
CASES = RESULTS / "cases"
BATCHES = RESULTS / "batches"
DATASETS = RESULTS / "datasets"
RESONANCE = DATASETS / "resonance.nc"
BIFURCATION = DATASETS / "bifurcation.nc"
THRESHOLDS = DATASETS / "thresholds.json"
FIGURES = RESULTS / "figures"
EXECUTED_NOTEBOOKS = RESULTS / "notebooks"
CHECKS = RESULTS / "checks"
LEDGER = RESULTS / "claims.json"
VERDICT = RESULTS / "verdict.txt"
REPORT = RESULTS / "report" / "index.html"

FIGURE_NAMES = tuple(f"fig{number}" for number in range(1, 8))
"""All figures; the first is a drawing, the others come from the notebook of their name."""

NOTEBOOK_NAMES = FIGURE_NAMES[1:]

CHECKED = ("printed", *NOTEBOOK_NAMES)
"""What claims are checked by: bare numbers, and each notebook."""


def nu_label(nu: float) -> str:
    """Write a frequency for a file name: 4 decimals, more only where this one needs them.

    Frequencies have at most 10 decimals (`gearmesh.study.frequencies.read_nu` sees to it), so
    no two share a label, and a label stays the same whatever other frequencies there are.
    """
    whole, decimals = f"{nu:.10f}".split(".")
    return f"{whole}.{decimals.rstrip('0'):0<4}"


def case_file(variant: str, nu: float) -> Path:
    """Return the file of one case, such as ``results/cases/c-material/nu-0.6600.nc``."""
    return CASES / variant / f"nu-{nu_label(nu)}.nc"


def batch_file(name: str) -> Path:
    """Return the file that hands the cases of one job on to the datasets."""
    return BATCHES / f"{name}.nc"


def figure_files(name: str) -> tuple[Path, Path]:
    """Return the PNG and the SVG file of a figure."""
    return FIGURES / f"{name}.png", FIGURES / f"{name}.svg"


def notebook(name: str) -> Path:
    """Return a notebook's source, without outputs."""
    return NOTEBOOKS / f"{name}.ipynb"


def executed_notebook(name: str) -> Path:
    """Return a notebook's executed copy."""
    return EXECUTED_NOTEBOOKS / f"{name}.ipynb"


def notebook_page(name: str) -> Path:
    """Return a notebook's executed copy as a page of the report."""
    return REPORT.parent / "notebooks" / f"{name}.html"


def check_file(name: str) -> Path:
    """Return the results of the checks that a notebook makes."""
    return CHECKS / f"{name}.json"
