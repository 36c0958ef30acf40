"""Where everything is, relative to the project's root: committed files, and a study's results."""

from dataclasses import dataclass
from pathlib import Path

CONFIG = Path("config")
PAPER = CONFIG / "paper.yaml"
SMOKE = CONFIG / "smoke.yaml"
CLAIMS = CONFIG / "claims.yaml"
NOTEBOOKS = Path("notebooks")
GLOSSARY = Path("docs/glossary.md")
CAPTIONS = Path("workflow/report")
RESULTS = Path("results")

FIGURE_NAMES = tuple(f"fig{number}" for number in range(1, 8))
"""All figures; the first is a drawing, the others come from the notebook of their name."""

NOTEBOOK_NAMES = FIGURE_NAMES[1:]

CHECKED = ("printed", *NOTEBOOK_NAMES)
"""The checks of claims: one for the printed numbers, and one for each notebook."""


MECHANISMS = (
    *("basins", "phases", "sweeps", "design_map", "bands", "lyapunov", "special_curves"),
    "attractors",
)
"""Datasets about what lies behind the curves, besides the branches and their special points."""

WHY = "why"
"""The notebook about it."""

WHY_FIGURES = ("branches", "basins", "sweeps", "special_curves", "lyapunov", "design_map")
"""Its figures."""


def nu_label(nu: float) -> str:
    """Write a frequency for a file name: 4 decimals, more only where this one needs them.

    Frequencies have at most 10 decimals (`gearmesh.study.frequencies.read_nu` ensures it), so
    no two share a label, and a label stays the same whatever other frequencies there are.
    """
    whole, decimals = f"{nu:.10f}".split(".")
    return f"{whole}.{decimals.rstrip('0'):0<4}"


def case_name(variant: str, nu: float | str) -> str:
    """Return the file of a case below the folder of cases: ``c-material/nu-0.6600.nc``."""
    return f"{variant}/nu-{nu if isinstance(nu, str) else nu_label(nu)}.nc"


def notebook(name: str) -> Path:
    """Return a notebook's source, without outputs."""
    return NOTEBOOKS / f"{name}.ipynb"


@dataclass(frozen=True)
class Places:
    """The results of one study, all in one folder.

    Names may be wildcards of Snakemake: ``places.batch("{letter}")``.

    Attributes
    ----------
    study : str
        Name of the study.
    """

    study: str

    @property
    def folder(self) -> Path:
        """The folder, ``results/paper``."""
        return RESULTS / self.study

    @property
    def cases(self) -> Path:
        """Folder of the case files."""
        return self.folder / "cases"

    @property
    def resonance(self) -> Path:
        """Every scalar of the cases over (variant, nu)."""
        return self.folder / "datasets" / "resonance.nc"

    @property
    def bifurcation(self) -> Path:
        """Every extremum and stroboscopic point over (variant, nu)."""
        return self.folder / "datasets" / "bifurcation.nc"

    @property
    def branches(self) -> Path:
        """Branches of orbits over ν_s."""
        return self.folder / "datasets" / "branches.nc"

    @property
    def special_points(self) -> Path:
        """Special points of the branches, a list."""
        return self.folder / "datasets" / "special_points.json"

    @property
    def thresholds(self) -> Path:
        """Thresholds, located by refinement in ν_s."""
        return self.folder / "datasets" / "thresholds.json"

    @property
    def ledger(self) -> Path:
        """All checked claims."""
        return self.folder / "claims.json"

    @property
    def verdict(self) -> Path:
        """A line for each figure, and the count of claims."""
        return self.folder / "verdict.txt"

    @property
    def report(self) -> Path:
        """The report page."""
        return self.folder / "report" / "index.html"

    @property
    def explorer(self) -> Path:
        """The page with which the results can be explored."""
        return self.folder / "report" / "explorer.html"

    @property
    def hashes(self) -> Path:
        """The SHA-256 of all results."""
        return self.folder / "manifest.sha256"

    @property
    def crate(self) -> Path:
        """The provenance of the study, as an RO-Crate; the crate is the folder of the study."""
        return self.folder / "ro-crate-metadata.json"

    @property
    def inputs(self) -> Path:
        """Folder of the copies of what the study was made from."""
        return self.folder / "inputs"

    @property
    def as_expected(self) -> Path:
        """A file that exists if all claims have the statuses that the ledger expects."""
        return self.folder / "checks" / "as_expected.txt"

    @property
    def verification(self) -> Path:
        """What `make verify` found, if it was run."""
        return self.folder / "verification.json"

    @property
    def again(self) -> Path:
        """Input of all jobs whose manifest does not hold; newer than everything, so they run."""
        return self.folder / ".again"

    @property
    def scratch(self) -> Path:
        """Folder of temporary files, which every run empties."""
        return self.folder / ".scratch"

    def case(self, variant: str, nu: float | str) -> Path:
        """Return the file of one case."""
        return self.cases / case_name(variant, nu)

    def batch(self, letter: str) -> Path:
        """Return the batch file of a letter of Tab. 1, from which the datasets are made."""
        return self.folder / "batches" / f"{letter}.nc"

    @property
    def why_files(self) -> list[Path]:
        """The figures of the notebook about what lies behind the curves."""
        return [file for name in WHY_FIGURES for file in self.figure_files(name)]

    @property
    def of_why(self) -> list[Path]:
        """All that the report reads about what lies behind the curves."""
        datasets = [self.mechanism(name) for name in MECHANISMS]
        stated = [self.branches, self.special_points, self.thresholds]
        return [*stated, *datasets, *self.why_files]

    def mechanism(self, name: str) -> Path:
        """Return a dataset about what lies behind the curves."""
        return self.folder / "datasets" / f"{name}.nc"

    def figure_files(self, name: str) -> tuple[Path, Path]:
        """Return the PNG and the SVG file of a figure."""
        return self.folder / "figures" / f"{name}.png", self.folder / "figures" / f"{name}.svg"

    def executed_notebook(self, name: str) -> Path:
        """Return a notebook's executed copy."""
        return self.folder / "notebooks" / f"{name}.ipynb"

    def notebook_page(self, name: str) -> Path:
        """Return a notebook's executed copy as a page of the report."""
        return self.report.parent / "notebooks" / f"{name}.html"

    def check(self, name: str) -> Path:
        """Return the checked claims of a figure."""
        return self.folder / "checks" / f"{name}.json"

    def manifest(self, job: str) -> Path:
        """Return the hashes of the files that a job wrote and read."""
        return self.folder / "manifests" / f"{job}.sha256"

    def log(self, job: str) -> Path:
        """Return what a job printed."""
        return self.folder / "logs" / f"{job}.log"

    def benchmark(self, job: str) -> Path:
        """Return the time and the memory that a job took, as Snakemake measured them."""
        return self.folder / "benchmarks" / f"{job}.tsv"
