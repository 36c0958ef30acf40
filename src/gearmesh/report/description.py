"""What a study is and how it was computed, as rows of text for the reports."""

import platform
import subprocess
from collections import Counter
from collections.abc import Iterable

import xarray as xr

from gearmesh.data import provenance
from gearmesh.report.presentation import number
from gearmesh.solvers.response import STATUSES
from gearmesh.study.cases import Study
from gearmesh.study.derived import derived as following
from gearmesh.study.pair import Parameter


def parameters(study: Study) -> list[Parameter]:
    """Return the parameters that the study states, or leaves at their defaults."""
    return [row for row in study.pair.parameters if row.value is not None]


def derived(study: Study) -> list[Parameter]:
    """Return the parameters that follow from the given ones, described by their formula."""
    return [
        Parameter(row.name, row.symbol, row.value(study.pair), row.unit, row.formula, "derived", "")
        for row in following(study.pair)
    ]


def computation(study: Study, resonance: xr.Dataset) -> Iterable[tuple[str, str]]:
    """Yield rows on the cases, the solver and the versions of the software."""
    pair, cases, nu = study.pair, study.cases, study.nu
    periods = pair.revolutions * pair.teeth_3
    kept = pair.kept_revolutions * pair.teeth_3
    yield "Cases", f"{len(cases)}, of which {sum(c.time_course for c in cases)} with time courses"
    yield "Status", _statuses(resonance)
    yield "Mesh frequency", f"{len(nu)} values of ν_s from {number(nu[0])} to {number(nu[-1])}"
    yield "Length", f"{periods} mesh periods from static equilibrium; the last {kept} are kept"
    yield "Method", "Taylor series of adaptive step; switches, contacts and extrema are located"
    yield "Tolerance", f"{number(pair.tolerance)} in a step, relative to y_st and y_st Ω_s"
    versions = {"Python": platform.python_version(), **provenance.versions()}
    yield "Versions", ", ".join(f"{name} {version}" for name, version in versions.items())
    yield "Commit", _commit()
    yield "Command", f"snakemake --config study={study.path}"
    yield "Parameters", f"SHA-256 {study.pair.digest()}"
    yield "Physics sources", f"SHA-256 {provenance.physics_digest()}"


def _statuses(resonance: xr.Dataset) -> str:
    counts = Counter(int(flag) for flag in resonance["status"].values.flat)
    named = [f"{counts[flag]} {name}" for flag, name in enumerate(STATUSES) if counts[flag]]
    return ", ".join(named).replace("_", " ")


def _commit() -> str:
    """Return the commit of the sources, and whether files differ from it."""

    def git(*arguments: str) -> str:
        command = ("git", "-C", str(provenance.PACKAGE), *arguments)
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    try:
        commit, changes = git("rev-parse", "HEAD"), git("status", "--porcelain")
    except (OSError, subprocess.CalledProcessError):
        return "not known: these sources are no Git repository"
    return f"{commit} with changes" if changes else commit
