"""Case files: layout, and the same bytes for the same input."""

import json
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

from gearmesh.data import casefile
from gearmesh.errors import InputError
from gearmesh.model.variants import variant
from gearmesh.solvers import simulation as integrator
from gearmesh.solvers.response import Response
from gearmesh.study.cases import Case

CASE = Case(variant("c-lubricant"), 0.66, time_course=True)

LISTED = {
    "extremum": {"extremum_time", "extremum_y", "extremum_kind"},
    "boundary": {"strobe_y", "strobe_v"},
    "": {
        *("y_max", "y_min", "y_rms", "contact_loss_fraction", "inverse_mesh_fraction"),
        *("n_contact_losses", "turning_points_per_period", "status"),
    },
    "sample": {
        *("time", "y", "v", "a", "stiffness", "modified_stiffness", "force_dynamic"),
        *("force_friction", "regime"),
    },
}
"""The variables that others rely on."""


@pytest.fixture(scope="module")
def response(pair) -> Response:
    problem = pair.problem(CASE.variant, CASE.nu)
    return integrator.simulate([problem], pair.tolerance, 256)[0]


@pytest.fixture
def written(tmp_path, pair, response):
    path = tmp_path / "case.nc"
    attributes = casefile.attributes(pair, CASE)
    casefile.write_case(path, attributes, casefile.record(response, pair))
    return path


def test_xarray_opens_it_without_options_and_finds_all_that_is_listed(written, response):
    case = xr.open_dataset(written)
    for dimension, names in LISTED.items():
        for name in names:
            assert case[name].dims == ((dimension,) if dimension else ())
    assert case.sizes["boundary"] == 106
    assert case.sizes["sample"] == 21 * 256
    assert case.sizes["extremum"] == response.extremum_y.size


def test_every_variable_has_unit_and_name_and_lengths_stand_twice(written, pair):
    case = xr.open_dataset(written)
    for name, variable in case.variables.items():
        assert variable.attrs["long_name"], name
        assert variable.attrs["units"] in ("1", "s", "mm", "N", "N/mm"), name
        if variable.attrs["units"] == "mm":
            scale = pair.static_deflection
            np.testing.assert_array_equal(variable, case[f"{name}_rel"] * scale)
            assert case[f"{name}_rel"].attrs["units"] == "1"


def test_flags_follow_cf(written):
    case = xr.open_dataset(written)
    for name in ("status", "extremum_kind", "regime", "sensitive"):
        stated = case[name].attrs
        assert len(stated["flag_values"]) == len(stated["flag_meanings"].split())
        assert set(np.unique(case[name])) <= set(stated["flag_values"].tolist())


def test_attributes_say_how_it_was_made(written, pair):
    stated = xr.open_dataset(written).attrs
    assert stated["Conventions"] == "CF-1.11"
    assert (stated["variant"], stated["nu_s"]) == ("c-lubricant", 0.66)
    assert json.loads(stated["parameters"])["backlash"] == pair.backlash
    assert stated["parameters_sha256"] == pair.digest()
    assert stated["solver_tolerance"] == pair.tolerance
    for name in ("gearmesh_version", "numba_version", "numpy_version", "physics_sources_sha256"):
        assert stated[name]


def test_another_process_writes_the_same_bytes(written, tmp_path):
    again = tmp_path / "again.nc"
    script = (
        "from gearmesh.data import casefile; import sys;"
        "stated, columns = casefile.read_case(sys.argv[1]);"
        "casefile.write_case(sys.argv[2], stated, columns)"
    )
    subprocess.run([sys.executable, "-c", script, written, again], check=True)
    assert again.read_bytes() == written.read_bytes()


def test_a_damaged_file_is_refused(written, tmp_path):
    harmed = tmp_path / "harmed.nc"
    for length in (0, 1, 100):
        harmed.write_bytes(written.read_bytes()[:length])
        with pytest.raises(InputError, match="missing or damaged"):
            casefile.read_case(harmed)


def test_a_case_depends_on_what_acts_on_it_only(pair):
    conservative = Case(variant("a-conservative"), 0.66)
    more = pair.replace(damping="5 N s/mm")
    assert casefile.case_digest(more, conservative) == casefile.case_digest(pair, conservative)
    assert casefile.case_digest(more, CASE) != casefile.case_digest(pair, CASE)


def test_a_failed_case_is_written_with_its_reason(tmp_path, pair):
    path = tmp_path / "failed.nc"
    failed = casefile.record(Response("step_limit", 9.5), pair)
    casefile.write_case(path, casefile.attributes(pair, CASE), failed)
    case = xr.open_dataset(path)
    meanings = case["status"].attrs["flag_meanings"].split()
    assert meanings[int(case["status"])] == "step_limit"
    assert case["extremum_kind"].values.tolist() == [casefile.NO_EXTREMUM]
    assert np.isnan(case["extremum_y"]).all()
    assert case.sizes["boundary"] == 106
    assert np.isnan(case["y_max"])


def test_a_file_that_cannot_be_written_is_told_and_leaves_nothing(tmp_path, pair, response):
    (tmp_path / "file").touch()
    columns = casefile.record(response, pair)
    with pytest.raises(InputError, match=r"file/case\.nc: cannot be written"):
        casefile.write_case(tmp_path / "file" / "case.nc", {}, columns)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
