"""The files against the CF conventions, by a checker of others."""

from pathlib import Path

import pytest
from compliance_checker.runner import CheckSuite, ComplianceChecker

from gearmesh.data.paths import Places


def faults(path: Path, tmp_path: Path) -> str:
    """Return the report of a strict check against CF-1.11; empty if the file passes."""
    CheckSuite.load_all_available_checkers()
    report = tmp_path / "report.txt"
    passed, failed = ComplianceChecker.run_checker(
        str(path), ["cf:1.11"], 1, "strict", output_filename=str(report), output_format="text"
    )
    return "" if passed and not failed else report.read_text()


@pytest.mark.parametrize("name", ["case", "resonance", "bifurcation"])
def test_a_file_follows_the_cf_conventions_strictly(small_run, small_study, tmp_path, name):
    places = Places(small_study.name)
    case = places.case("c-material", 0.66)
    path = {"case": case, "resonance": places.resonance, "bifurcation": places.bifurcation}[name]
    assert faults(small_run / path, tmp_path) == ""


def test_the_checker_notices_what_is_missing(small_run, small_study, tmp_path):
    import netCDF4

    path = tmp_path / "case.nc"
    path.write_bytes((small_run / Places(small_study.name).case("c-material", 0.66)).read_bytes())
    with netCDF4.Dataset(path, "a") as file:
        file["y_max"].units = "furlong of y"
    assert "y_max" in faults(path, tmp_path)
