"""The command as people run it: exit statuses, one line for bad input, no traceback."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from gearmesh import __version__
from gearmesh.commands.main import main
from gearmesh.model.variants import VARIANTS


@pytest.fixture
def gearmesh(root, monkeypatch, capsys):
    """Return a function that runs the command in this process, in the root of the project."""

    def run(*arguments, cwd=root):
        monkeypatch.chdir(cwd)
        status = main([*map(str, arguments)])
        return subprocess.CompletedProcess(arguments, status, *capsys.readouterr())

    return run


@pytest.fixture
def process(root):
    """Return a function that runs the command as a process, in the root of the project."""

    def run(*arguments, cwd=root, **environment):
        return subprocess.run(
            [Path(sys.executable).with_name("gearmesh"), *map(str, arguments)],
            cwd=cwd,
            env=os.environ | environment,
            capture_output=True,
            text=True,
            encoding="utf-8",
            timeout=120,
        )

    return run


def refused(run):
    """Check that a run ended as bad input does, and return its message."""
    assert run.returncode == 2
    assert run.stdout == ""
    [line] = run.stderr.splitlines()
    assert line.startswith("gearmesh: error: ")
    return line


def test_help_and_version(process):
    assert "simulate" in process("--help").stdout
    assert "--set" in process("simulate", "--help").stdout
    assert process("--version").stdout == f"gearmesh {__version__}\n"


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
    explained = "\n".join(lines[23:])
    assert all(word in explained for word in ("linear", "quadratic", "cubic", "-5x"))


@pytest.mark.parametrize("command", ["variants", "parameters"])
def test_tables_fit_100_columns(gearmesh, command):
    assert max(map(len, gearmesh(command).stdout.splitlines())) <= 100


def test_parameters_lists_values_units_and_kinds(gearmesh):
    run = gearmesh("parameters", "--set", "backlash=55 um")
    lines = {line.split()[0]: line.split() for line in run.stdout.splitlines()}
    assert lines["reduced_mass"][1:5] == ["m_red", "3.123", "kg", "printed"]
    assert lines["backlash"][1:5] == ["s", "0.055", "mm", "stated"]
    assert lines["damping_ratio"][3:5] == ["1", "computed"]


def test_output_survives_a_terminal_without_greek(process):
    run = process("parameters", PYTHONIOENCODING="ascii")
    assert run.returncode == 0
    assert "teeth" in run.stdout


def test_a_mistake_ends_the_process_with_status_2(process):
    assert "did you mean 'backlash'?" in refused(process("parameters", "--set", "backlsh=40 um"))


def test_the_paper_s_pair_is_there_in_any_folder(gearmesh, tmp_path):
    assert gearmesh("parameters", cwd=tmp_path).stdout == gearmesh("parameters").stdout


SWEEP = ("sweep", "--variant", "b-both", "-o", "x.nc")
LONG = ("--revolutions", "10000", "--kept", "10000")
SIMULATE = ("simulate", "--variant", "c-lubricant", "--nu", "0.66")


def test_simulate_writes_a_case_with_its_time_course(gearmesh, tmp_path):
    file = tmp_path / "case.nc"
    run = gearmesh(*SIMULATE, "--set", "backlash=41 um", "-o", file)
    assert (run.returncode, run.stderr) == (0, "")
    assert "c-lubricant at nu_s = 0.66" in run.stdout
    with xr.open_dataset(file) as case:
        assert case.attrs["variant"] == "c-lubricant"
        assert case.attrs["nu_s"] == 0.66
        assert '"backlash":0.041' in case.attrs["parameters"]
        assert case.sizes["boundary"] == 106
        assert case["y"].size == 21 * 256
        assert float(case["y_max"]) >= float(case["y"].max())
    assert os.listdir(tmp_path) == ["case.nc"]


def test_simulate_at_a_speed_reports_the_loads(gearmesh, tmp_path):
    stated = ("--nu", "9000 rpm", "--set", "torque=120 N m", "--set", "revolutions=2")
    run = gearmesh("simulate", "--variant", "b-both", *stated, "-o", tmp_path / "case.nc")
    assert "b-both at nu_s = 1.928" in run.stdout
    with xr.open_dataset(tmp_path / "case.nc") as case:
        factor = float(case["dynamic_factor"])
        assert f"K_v = {factor:.4g}" in run.stdout
        radius = 0.003 * 21 / 2 * np.cos(np.radians(20))
        assert float(case["force_max"]) == pytest.approx(factor * 120 / radius)
        assert case["force_normal"].size == case["y"].size


def test_geometry_prints_what_a_study_takes(gearmesh):
    drawing = ("--module", "3 mm", "--teeth", "21", "--face-width", "20 mm")
    run = gearmesh("geometry", *drawing)
    assert max(map(len, run.stdout.splitlines())) <= 100
    stated = dict(line.split(": ") for line in run.stdout.split("for a study:\n")[1].splitlines())
    assert stated["contact_ratio"].startswith("1.5691")
    settings = [part for name, value in stated.items() for part in ("--set", f"{name}={value}")]
    shown = gearmesh("parameters", *settings).stdout
    rows = {line.split()[0]: line.split() for line in shown.splitlines()}
    assert rows["mesh_stiffness_max"][2] == f"{float(stated['mesh_stiffness_max'].split()[0]):.8g}"


def test_simulate_gives_the_same_bytes_again_and_says_what_it_replaces(gearmesh, tmp_path):
    file = tmp_path / "case.nc"
    assert gearmesh(*SIMULATE, "-o", file).returncode == 0
    first = file.read_bytes()
    assert "case.nc (replaced): " in gearmesh(*SIMULATE, "-o", file).stdout
    assert file.read_bytes() == first


def test_an_output_that_is_no_run_is_never_overwritten(gearmesh, tmp_path):
    file = tmp_path / "notes.nc"
    file.write_text("what was there before")
    assert "is no NetCDF file" in refused(gearmesh(*SIMULATE, "-o", file))
    assert file.read_text() == "what was there before"


def test_a_sensitive_run_says_so(gearmesh, tmp_path):
    run = gearmesh(
        *("simulate", "--variant", "a-conservative", "--nu", "0.65", "-o", tmp_path / "a.nc"),
    )
    assert "sensitive: this motion amplifies small errors" in run.stdout


def test_a_run_that_needs_too_much_memory_is_one_line(gearmesh, monkeypatch):
    def exhausted(_):
        raise MemoryError

    monkeypatch.setattr("gearmesh.commands.tables.variants", exhausted)
    run = gearmesh("variants")
    assert (run.returncode, run.stdout, run.stderr.count("\n")) == (1, "", 1)
    assert "not enough memory" in run.stderr


def test_settings_of_a_run_from_the_command_line(gearmesh, tmp_path):
    run = gearmesh(
        *(*SIMULATE, "-o", tmp_path / "a.nc"),
        *("--revolutions", "7", "--kept", "2", "--start", "12 um", "0.1"),
    )
    assert (run.returncode, run.stderr) == (0, "")
    with xr.open_dataset(tmp_path / "a.nc") as case:
        assert case.sizes["boundary"] == 7 * 21 + 1
        assert float(case["strobe_y"][0]) == pytest.approx(0.012)
        assert float(case["strobe_v_rel"][0]) == pytest.approx(0.1)


def test_sweep_writes_one_dataset(gearmesh, tmp_path):
    file = tmp_path / "sweep.nc"
    run = gearmesh(
        *("sweep", "--variant", "c-material", "--variant", "b-lubricant"),
        *("--nu", "0.6:0.65:0.01"),
        *("--direction", "down", "--revolutions", "2", "-o", file),
    )
    assert (run.returncode, run.stderr) == (0, "")
    with xr.open_dataset(file) as found:
        assert dict(found["y_max"].sizes) == {"variant": 2, "nu": 6}
        assert found["nu"].values.tolist() == [0.6, 0.61, 0.62, 0.63, 0.64, 0.65]


def test_orbit_prints_its_multipliers_and_writes_it(gearmesh, tmp_path):
    file = tmp_path / "orbit.nc"
    run = gearmesh("orbit", "--variant", "c-lubricant", "--nu", "0.9", "-o", file)
    assert (run.returncode, run.stderr) == (0, "")
    assert "period 1, stable" in run.stdout
    assert "regimes: normal mesh, contact loss" in run.stdout
    with xr.open_dataset(file) as orbit:
        moduli = np.hypot(orbit.multipliers_real, orbit.multipliers_imag)
    assert f"{float(moduli.max()):.10f}" in run.stdout
    assert "an orbit, which is no run" in refused(gearmesh("plot", file))


def test_branch_lists_its_special_points(gearmesh, tmp_path):
    file = tmp_path / "branch.nc"
    run = gearmesh(
        *("branch", "--variant", "c-material", "--nu", "0.7", "--range", "0.6", "0.75"),
        *("-o", file),
    )
    assert (run.returncode, run.stderr) == (0, "")
    [point] = (line.split() for line in run.stdout.splitlines() if line.startswith("switching"))
    assert float(point[1]) == pytest.approx(0.6386, abs=5e-5)
    with xr.open_dataset(file) as branch:
        assert float(branch.nu.min()) == pytest.approx(0.6)


def test_an_orbit_that_is_not_there_says_why(gearmesh):
    run = gearmesh("orbit", "--variant", "c-both", "--nu", "0.7", "--set", "eccentricity=9 um")
    assert run.returncode == 1
    assert "after 21 mesh periods" in run.stdout


@pytest.fixture(scope="module")
def two_runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    for name, nu in (("a.nc", "0.78"), ("b.nc", "0.80")):
        case = ["--variant", "c-lubricant", "--nu", nu, "-o", str(folder / name)]
        assert main(["simulate", *case]) == 0
    return folder


@pytest.mark.parametrize(("suffix", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml")])
def test_plot_draws_a_run(gearmesh, two_runs, tmp_path, suffix, start):
    picture = tmp_path / f"picture.{suffix}"
    assert gearmesh("plot", two_runs / "a.nc", "-o", picture).returncode == 0
    assert picture.read_bytes().startswith(start)


@pytest.mark.parametrize("command", ["plot", "compare"])
@pytest.mark.parametrize(
    ("output", "expected"),
    [
        ("y.txt", "found y.txt; allowed is a name that ends in .png, .svg, .pdf"),
        ("", "is a folder; allowed is the name of a file"),
        ("missing/y.png", "there is no folder missing"),
    ],
)
def test_a_wrong_picture_is_refused_before_anything(gearmesh, two_runs, command, output, expected):
    runs = [two_runs / "a.nc", two_runs / "b.nc"][: 1 + (command == "compare")]
    assert expected in refused(gearmesh(command, *runs, "-o", output, cwd=two_runs))


def test_compare_lists_what_differs(gearmesh, two_runs, tmp_path):
    run = gearmesh("compare", two_runs / "a.nc", two_runs / "b.nc", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert "nu_s: A 0.78, B 0.8" in run.stdout
    rows = {line.split()[0]: line.split() for line in run.stdout.splitlines() if line}
    with xr.open_dataset(two_runs / "b.nc") as second:
        assert float(rows["y_max"][4]) == pytest.approx(
            float(second["y_max"]), rel=5e-6
        )  # six digits
    assert (tmp_path / "a-b.png").exists()


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ((), "COMMAND"),
        (("simulat",), "simulat"),
        (("simulate", "--nu", "1", "-o", "x.nc"), "--variant"),
        (("simulate", "--varient", "a", "--nu", "1", "-o", "x.nc"), "did you mean '--variant'?"),
        (("simulate", "--variant", "c-lubicant", "--nu", "1", "-o", "x.nc"), "'c-lubricant'"),
        (("simulate", "--variant", "c-both", "--nu", "one", "-o", "x.nc"), "--nu: found 'one'"),
        (("simulate", "--variant", "c-both", "--nu", "0", "-o", "x.nc"), "allowed is 0.01 to 10"),
        (("simulate", "--variant", "c-both", "--nu", "nan", "-o", "x.nc"), "--nu: found 'nan'"),
        (("simulate", "--variant", "c-both", "--nu", "0,66", "-o", "x.nc"), "use a decimal point"),
        ((*SIMULATE, "-o", "missing/x.nc"), "there is no folder missing"),
        ((*SIMULATE, "-o", "."), "is a folder"),
        ((*SIMULATE, "-o", "x.csv"), "ends in .nc"),
        ((*SIMULATE, "-o", "x.nc", "--set", "backlash=40"), "unit missing"),
        ((*SIMULATE, "-o", "x.nc", "--set", "nu=0.7"), "nu: not a parameter"),
        ((*SIMULATE, "-o", "x.nc", "--set", "static_force=1 N"), "it is computed as"),
        ((*SIMULATE, "-o", "x.nc", "--set", "assumed.backlash=4 um"), "did you mean 'backlash'?"),
        ((*SIMULATE, "-o", "x.nc", "--config", "none.yaml"), "none.yaml: cannot be read"),
        ((*SIMULATE, "-o", "x.nc", "--kept", "9"), "kept_revolutions"),
        ((*SIMULATE, "-o", "x.nc", *LONG), "makes 53760000 samples"),
        ((*SWEEP, "--nu", "0.7", *LONG), "allowed are at most 10000000, here 1860 revolutions"),
        ((*SWEEP, "--nu", "0.6:1.2:0.0001", "--loads"), "6001 runs, which keep 32261376 samples"),
        ((*SIMULATE, "-o", "x.nc", "--revolutions", "two"), "--revolutions: found 'two'"),
        ((*SIMULATE, "-o", "x.nc", "--start", "1 kg", "0"), "1 kg"),
        (
            ("sweep", "--variant", "b-both", "--nu", "1:0.9:0.1", "-o", "x.nc"),
            "found 0.9, below start",
        ),
        ((*SWEEP, "--nu", "0.9:1:0"), "--nu: step: found '0'; out of range; allowed is 1e-09 to"),
        ((*SWEEP, "--nu", ".6:.7:nan"), "--nu: step: found 'nan'; not a quantity"),
        ((*SWEEP, "--nu", "0.9:1"), "allowed is START:STOP:STEP"),
        ((*SWEEP, "--nu", "600 rpm:3000 rpm:100"), "step '100'; allowed are three speeds, or"),
        ((*SWEEP, "--nu", "600 rpm:3000 rpm:0 rpm"), "step: found '0 rpm'; allowed is 1e-06 rpm"),
        ((*SWEEP, "--nu", "600 rpm:500 rpm:10 rpm"), "stop: found '500 rpm'; allowed is 600 rpm"),
        ((*SWEEP, "--nu", "600 rpm:1e9 rpm:10 rpm"), "stop: found '1e9 rpm'; ν_s = "),
        ((*SWEEP, "--nu", "0.7", "--nu", "0.8"), "--nu: found twice; allowed is once"),
        ((*SWEEP, "--nu", "0.7", "--variant", "b-both"), "--variant: found b-both twice"),
        ((*SIMULATE, "-o", "x.nc", "--output", "y.nc"), "--output: found twice"),
        (("orbit", *SIMULATE[1:], "--periods", "1", "--periods", "1"), "--periods: found twice"),
        (("parameters", "--config", "a.yaml", "--config", "b.yaml"), "--config: found twice"),
        (("parameters", "--set", "teeth=20", "--set", "teeth=30"), "teeth: found twice"),
        ((*SIMULATE, "-o", f"{'x' * 300}.nc"), "cannot be written (File name too long)"),
        ((*SIMULATE, "-o", "x\0.nc"), "cannot be written (embedded null byte)"),
        ((*SIMULATE, "-o", "x.nc", "--kept", "9" * 5000), "--kept: found '999"),
        (("orbit", *SIMULATE[1:], "--periods", "9" * 5000), "--periods: found '999"),
        (("parameters", "--config", "a\0b"), "cannot be read (embedded null byte)"),
        (("plot", "none.nc"), "none.nc: cannot be read: No such file"),
        (("plot", "config/paper.yaml"), "not a NetCDF file"),
        (("parameters", "--config", "."), "cannot be read"),
        (("parameters", "--set", "backlsh=40 um"), "did you mean 'backlash'?"),
        (("parameters", "--set", "line\nbreak"), "NAME=VALUE"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(gearmesh, root, tmp_path, arguments, expected):
    shutil.copytree(root / "config", tmp_path / "config")
    assert expected in refused(gearmesh(*arguments, cwd=tmp_path))
    assert os.listdir(tmp_path) == ["config"]
