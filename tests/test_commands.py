"""The command as people run it: exit statuses, one line for bad input, no traceback."""

import os
import shutil
import subprocess
import sys

import pytest

from gearmesh import __version__
from gearmesh.model.damping import VARIANTS


@pytest.fixture
def gearmesh(root):
    """Return a function that runs the command in the root of the project."""

    def run(*arguments, cwd=root, **environment):
        return subprocess.run(
            [sys.executable, "-m", "gearmesh", *map(str, arguments)],
            cwd=cwd,
            env=os.environ | environment,
            capture_output=True,
            text=True,
            encoding="utf-8",
            timeout=120,
        )

    return run


def refused(run):
    """Check that a run ended as bad input does, and return what it said."""
    assert run.returncode == 2
    assert run.stdout == ""
    [line] = run.stderr.splitlines()
    assert line.startswith("gearmesh: error: ")
    return line


def test_help_and_version(gearmesh):
    assert "simulate" in gearmesh("--help").stdout
    assert "--set" in gearmesh("simulate", "--help").stdout
    assert gearmesh("--version").stdout == f"gearmesh {__version__}\n"


def test_help_imports_nothing_heavy(root):
    code = (
        "import sys, contextlib, gearmesh.commands.main\n"
        "with contextlib.suppress(SystemExit): gearmesh.commands.main.main(['--help'])\n"
        "sys.exit(bool({'numba', 'numpy', 'pint', 'pydantic'} & set(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, timeout=60)
    assert run.returncode == 0


def test_variants_is_table_1(gearmesh):
    lines = gearmesh("variants").stdout.splitlines()
    table = {line.split()[0]: line.split()[1:8] for line in lines[1:23]}
    assert set(table) == set(VARIANTS)
    assert table["h-lubricant"] == ["•", "0", "0", "0", "0", "×", "×"]


def test_parameters_lists_values_units_and_kinds(gearmesh):
    run = gearmesh("parameters", "--set", "assumed.backlash=55 um")
    lines = {line.split()[0]: line.split() for line in run.stdout.splitlines()}
    assert lines["printed.reduced_mass"][1:5] == ["m_red", "3.123", "kg", "printed"]
    assert lines["assumed.backlash"][1:5] == ["s", "0.055", "mm", "assumed"]
    assert lines["damping_ratio"][3:5] == ["1", "derived"]


def test_output_survives_a_terminal_without_greek(gearmesh):
    run = gearmesh("parameters", PYTHONIOENCODING="ascii")
    assert run.returncode == 0
    assert "printed.teeth" in run.stdout


SIMULATE = ("simulate", "--variant", "c-lubricant", "--nu", "0.66")


def test_simulate_writes_a_case_with_its_time_course(gearmesh, tmp_path):
    xarray = pytest.importorskip("xarray")
    file = tmp_path / "case.nc"
    file.write_text("what was there before")
    run = gearmesh(*SIMULATE, "--set", "assumed.backlash=41 um", "-o", file)
    assert (run.returncode, run.stderr) == (0, "")
    assert "c-lubricant at nu_s = 0.66" in run.stdout
    with xarray.open_dataset(file) as case:
        assert case.attrs["variant"] == "c-lubricant"
        assert case.attrs["nu_s"] == 0.66
        assert '"backlash":0.041' in case.attrs["parameters"]
        assert case.sizes["boundary"] == 106
        assert case["y"].size == 21 * 256
        assert float(case["y_max"]) >= float(case["y"].max())
    assert os.listdir(tmp_path) == ["case.nc"]


def test_simulate_gives_the_same_bytes_again(gearmesh, tmp_path):
    for name in ("a.nc", "b.nc"):
        assert gearmesh(*SIMULATE, "-o", tmp_path / name).returncode == 0
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ((), "COMMAND"),
        (("simulat",), "simulat"),
        (("simulate", "--nu", "1", "-o", "x.nc"), "--variant"),
        (("simulate", "--variant", "c-lubicant", "--nu", "1", "-o", "x.nc"), "'c-lubricant'"),
        (("simulate", "--variant", "c-both", "--nu", "one", "-o", "x.nc"), "--nu: found 'one'"),
        (("simulate", "--variant", "c-both", "--nu", "0", "-o", "x.nc"), "allowed is 0.01 to 10"),
        (("simulate", "--variant", "c-both", "--nu", "nan", "-o", "x.nc"), "--nu: found 'nan'"),
        ((*SIMULATE, "-o", "missing/x.nc"), "there is no folder missing"),
        ((*SIMULATE, "-o", "."), "is a folder"),
        ((*SIMULATE, "-o", "x.nc", "--set", "assumed.backlash=40"), "unit missing"),
        ((*SIMULATE, "-o", "x.nc", "--config", "none.yaml"), "none.yaml: cannot be read"),
        (("parameters", "--config", "."), "cannot be read"),
        (("parameters", "--set", "assumed.backlsh=40 um"), "did you mean 'backlash'?"),
        (("parameters", "--set", "line\nbreak"), "KEY=VALUE"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(gearmesh, root, tmp_path, arguments, expected):
    shutil.copytree(root / "config", tmp_path / "config")
    assert expected in refused(gearmesh(*arguments, cwd=tmp_path))
    assert os.listdir(tmp_path) == ["config"]


def test_without_a_study_at_hand(gearmesh, tmp_path):
    assert "--config" in refused(gearmesh("parameters", cwd=tmp_path))
