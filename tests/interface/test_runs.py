"""The public functions: what they return, from any folder, and what they refuse."""

import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

import gearmesh as gm
from gearmesh.model.variants import variant
from gearmesh.solvers.simulation import simulate


@pytest.fixture(scope="module")
def pair():
    return gm.paper()


@pytest.fixture(scope="module")
def run(pair):
    return gm.simulate(pair, "c-lubricant", nu=0.66)


def test_every_public_name_is_there():
    assert set(gm.__all__) <= set(dir(gm))
    for name in gm.__all__:
        assert getattr(gm, name).__doc__


def test_a_run_is_what_the_solver_gives(pair, run):
    [response] = simulate([pair.problem(variant("c-lubricant"), 0.66)], 1e-10, 256)
    assert np.array_equal(run.y_rel, response.samples.y)
    assert np.array_equal(run.strobe_v_rel, response.strobe_v)
    assert float(run.y_max_rel) == response.y_max
    assert float(run.y_max) == response.y_max * pair.static_deflection
    assert run.sizes["time"] == 21 * 256


def test_time_is_the_coordinate_of_the_samples(run):
    assert run.y.dims == ("time",)
    assert run.time.attrs["units"] == "s"
    assert np.all(np.diff(run.time) > 0)


def test_every_variable_has_a_unit_and_a_name(run):
    for variable in run.variables.values():
        assert variable.attrs["units"]
        assert variable.attrs["long_name"]


def test_the_first_plot_of_a_new_user_works(run):
    pytest.importorskip("matplotlib").use("agg")
    [line] = run.y.plot()
    assert line.get_xdata().size == run.sizes["time"]


def test_settings_of_a_run(pair):
    run = gm.simulate(pair, "d-both", 0.8, revolutions=2, kept=2, samples_per_period=16)
    assert run.sizes["time"] == 2 * 21 * 16
    assert run.sizes["boundary"] == 43


@pytest.mark.parametrize("start", [(1.5, 0.2), ("15 um", "0.2 y_st"), ("1.5 y_st", "2 um")])
def test_an_initial_condition_in_static_deflections_or_with_units(pair, start):
    run = gm.simulate(pair, "c-material", 0.7, start=start, revolutions=1)
    assert float(run.strobe_y_rel[0]) == pytest.approx(1.5, abs=1e-12)
    assert float(run.strobe_v_rel[0]) == pytest.approx(0.2, abs=1e-12)


@pytest.mark.parametrize("changes", [{}, {"eccentricity": "20 um", "body_mass": "3.123 kg"}])
@pytest.mark.parametrize("name", ["b-material", "c-lubricant"])
def test_a_continued_run_equals_an_uninterrupted_one(pair, name, changes):
    """With run-out the shafts' angle has to go on too: it once was 0.041 y_st off."""
    pair = pair.replace(**changes)
    first = gm.simulate(pair, name, 0.9, revolutions=1)
    second = gm.simulate(pair, name, 0.9, revolutions=1, start=first)
    whole = gm.simulate(pair, name, 0.9, revolutions=2, kept=2)
    assert np.array_equal(second.strobe_y_rel, whole.strobe_y_rel[21:])
    assert np.array_equal(second.y_rel, whole.y_rel[21 * 256 :])
    count = second.sizes["extremum"]
    assert np.array_equal(second.extremum_y_rel, whole.extremum_y_rel[-count:])


def test_a_sweep_is_its_single_runs(pair):
    nu = [0.7, 0.62, 0.9]
    found = gm.sweep(pair, ["c-material", "b-both"], nu, over={"backlash": ["30 um", "8 y_st"]})
    assert found.y_max.dims == ("variant", "nu", "backlash")
    assert list(found.nu.values) == nu
    assert list(found.backlash.values) == [0.03, 0.08]
    assert found.backlash.attrs["units"] == "mm"
    alone = gm.simulate(pair.replace(backlash="30 um"), "b-both", 0.62)
    cell = found.sel(variant="b-both", nu=0.62, backlash=0.03)
    assert float(cell.y_max) == float(alone.y_max)
    count = alone.sizes["extremum"]
    assert np.array_equal(cell.extremum_y_rel[:count], alone.extremum_y_rel)
    assert np.isnan(cell.extremum_y_rel[count:]).all()


@pytest.mark.parametrize("direction", [None, "up"])
@pytest.mark.parametrize(
    ("name", "values"), [("tolerance", [1e-3, 1e-12]), ("samples_per_period", [4, 64])]
)
def test_a_sweep_over_a_setting_gives_each_run_its_own(pair, name, values, direction):
    settings = {"revolutions": 1, "direction": direction, "loads": True}
    found = gm.sweep(pair, "c-material", [0.9], over={name: values}, **settings).squeeze()
    for i, value in enumerate(values):
        one = gm.sweep(pair.replace(**{name: value}), "c-material", [0.9], **settings).squeeze()
        for measured in ("y_max", "transmission_error_range"):
            assert found[measured][i] == one[measured]
    assert found.transmission_error_range[0] != found.transmission_error_range[1]


@pytest.mark.parametrize("direction", ["up", "down"])
def test_a_sweep_in_a_direction_goes_on_from_run_to_run(pair, direction):
    nu = [0.70, 0.72, 0.71]
    found = gm.sweep(pair, "b-lubricant", nu, direction=direction, revolutions=2)
    run = None
    for x in sorted(nu, reverse=direction == "down"):
        run = gm.simulate(pair, "b-lubricant", x, revolutions=2, start=run)
        assert float(found.y_max.sel(variant="b-lubricant", nu=x)) == float(run.y_max)


WRONG = {
    "variant": lambda pair: gm.simulate(pair, "c-lubicant", 0.66),
    "nu": lambda pair: gm.simulate(pair, "c-both", 0.0),
    "nu not a number": lambda pair: gm.simulate(pair, "c-both", float("nan")),
    "kept more than run": lambda pair: gm.simulate(pair, "c-both", 0.7, revolutions=1, kept=2),
    "start": lambda pair: gm.simulate(pair, "c-both", 0.7, start=1.0),
    "start in kg": lambda pair: gm.simulate(pair, "c-both", 0.7, start=("1 kg", 0)),
    "start that is no run": lambda pair: gm.simulate(pair, "c-both", 0.7, start=xr.Dataset()),
    "tolerance": lambda pair: gm.simulate(pair, "c-both", 0.7, tolerance=1.0),
    "twice": lambda pair: gm.sweep(pair, "c-both", [0.7, 0.7]),
    "direction": lambda pair: gm.sweep(pair, "c-both", [0.7, 0.8], direction="left"),
    "over": lambda pair: gm.sweep(pair, "c-both", 0.7, over={"backlsh": [1]}),
    "over a text": lambda pair: gm.sweep(pair, "c-both", 0.7, over={"backlash": "40 um"}),
    "over two values": lambda pair: gm.sweep(
        pair, "c-both", 0.7, over={"eccentricity": [["0 um", "1 um"]]}
    ),
    "over nothing": lambda pair: gm.sweep(pair, "c-both", 0.7, over={"backlash": []}),
    "over a number": lambda pair: gm.sweep(pair, "c-both", 0.7, over=5),
    "over one value": lambda pair: gm.sweep(pair, "c-both", 0.7, over={"backlash": 5}),
    "over no name": lambda pair: gm.sweep(pair, "c-both", 0.7, over={3: [1]}),
    "variant None": lambda pair: gm.simulate(pair, None, 0.66),
    "variants 5": lambda pair: gm.sweep(pair, 5, 0.66),
    "a list of variants": lambda pair: gm.simulate(pair, ["c-both"], 0.66),
    "a list of nu": lambda pair: gm.simulate(pair, "c-both", [0.66]),
    "nested nu": lambda pair: gm.sweep(pair, "c-both", [[0.66], [0.7, 0.8]]),
    "nu as a mapping": lambda pair: gm.sweep(pair, "c-both", {"nu": 0.66}),
    "pair None": lambda _: gm.simulate(None, "c-both", 0.66),
    "pair by name": lambda _: gm.sweep("paper", "c-both", 0.66),
    "pair of a map": lambda _: gm.campbell("paper", "c-both", 0.66),
    "quantity": lambda pair: gm.campbell(pair, "c-both", 0.66, quantity=["y"], revolutions=1),
    "order": lambda pair: gm.campbell(pair, "c-both", 0.66, highest_order="5"),
    "no file": lambda _: gm.load(None),
    "no chart": lambda _: gm.read_pitch_chart(5),
    "a width of many numbers": lambda pair: gm.geometry(
        module="3 mm", teeth=21, face_width=np.ones(99)
    ),
    "no run": lambda _: gm.spectrum(None),
    "run as a start": lambda pair: gm.sweep(pair, "c-both", 0.7, start=xr.Dataset()),
    "no frequency": lambda pair: gm.sweep(pair, "c-both", []),
    "variant twice": lambda pair: gm.sweep(pair, ["c-both", "c-both"], 0.7),
    "no variant": lambda pair: gm.sweep(pair, [], 0.7),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_argument_is_one_line(pair, name):
    with pytest.raises(gm.InputError) as caught:
        WRONG[name](pair)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 200


def test_the_library_loads_neither_snakemake_nor_matplotlib_nor_posix_modules(tmp_path):
    code = (
        "import sys, gearmesh as gm\n"
        "gm.simulate(gm.paper(), 'c-both', 0.7, revolutions=1)\n"
        "heavy = {'snakemake', 'matplotlib', 'papermill', 'jinja2'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, timeout=120)


def test_the_library_imports_where_posix_modules_are_missing(tmp_path):
    """As on Windows, which has no fcntl."""
    code = (
        "import sys\n"
        "sys.modules.update(dict.fromkeys(['fcntl', 'resource', 'pwd', 'grp', 'termios']))\n"
        "import gearmesh as gm\n"
        "assert float(gm.simulate(gm.paper(), 'c-both', 0.7, revolutions=1).y_max) > 0\n"
    )
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, timeout=120)


def test_what_a_run_of_a_sweep_has_no_extremum_for_is_none(pair):
    """Runs with fewer extrema than the longest are filled with `none`, never with a minimum."""
    ds = gm.sweep(pair, ["c-material"], [0.61, 0.9])
    counted = ds.extremum_y.notnull().sum("extremum")
    assert counted.min() < counted.max()
    assert ((ds.extremum_kind == 0) == ds.extremum_y.isnull()).all()
