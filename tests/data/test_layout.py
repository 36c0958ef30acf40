"""The layout of a case file, on a run whose numbers are given."""

import hashlib
from dataclasses import MISSING, fields, replace

import numpy as np
import pytest

from gearmesh.data import casefile, manifest, paths, provenance
from gearmesh.data.paths import Places
from gearmesh.model.variants import variant
from gearmesh.solvers.response import Response, Samples
from gearmesh.study.cases import Case

COUNT = 5
SAMPLES = Samples(
    **{
        field.name: np.arange(COUNT) + 10.0 * number
        for number, field in enumerate(fields(Samples))
        if field.name != "regime" and field.default is MISSING
    },
    regime=np.array([1, 0, -1, 0, 1]),
)
RUN = Response(
    *("ok", 9.5, 0.66, 1234),
    extremum_time=np.array([3.0, 4.0]),
    extremum_y=np.array([1.5, 0.25]),
    extremum_kind=np.array([1, -1], np.int8),
    strobe_y=np.array([1.0, 2.0, 3.0]),
    strobe_v=np.array([0.5, 0.0, -0.5]),
    y_max=1.5,
    y_min=0.25,
    y_rms=0.75,
    contact_loss_fraction=0.125,
    inverse_mesh_fraction=0.0625,
    n_contact_losses=3,
    turning_points_per_period=2.0,
    y_max_error=1e-9,
    y_min_error=2e-9,
    sensitive=True,
    samples=SAMPLES,
)
SCALE = {
    "y": "mm", "v": "mm", "a": "mm", "time": "s", "extremum_time": "s", "extremum_y": "mm",
    "strobe_y": "mm", "strobe_v": "mm", "y_max": "mm", "y_min": "mm", "y_rms": "mm",
    "y_max_error": "mm", "y_min_error": "mm", "stiffness": "N/mm", "modified_stiffness": "N/mm",
    "force_dynamic": "N", "force_friction": "N",
}  # fmt: skip
"""The unit of each variable that has one."""


def test_a_record_is_in_units_and_in_static_deflections(pair):
    columns = casefile.record(RUN, pair)
    omega = np.sqrt(pair.stiffness_mean * 1e3 / pair.reduced_mass)  # 1 N/mm is 1e3 kg/s^2
    scales = {
        "mm": pair.static_deflection,
        "s": 1.0 / omega,
        "N/mm": pair.stiffness_mean,
        "N": pair.stiffness_mean * pair.static_deflection,
    }
    given = {field.name: getattr(RUN, field.name) for field in fields(RUN)} | {
        field.name: getattr(SAMPLES, field.name) for field in fields(SAMPLES)
    }
    for field in (*casefile.FIELDS, *casefile.SAMPLE_FIELDS):
        if field.name == "status":
            assert columns["status"] == 0
        elif field.name == "mesh_period":
            assert columns["mesh_period"] == pytest.approx(9.5 / omega, rel=1e-14)
        else:
            scale = scales[SCALE[field.name]] if field.name in SCALE else 1.0
            expected = np.asarray(given[field.name]) * scale
            np.testing.assert_allclose(
                columns[field.name], expected, rtol=1e-14, err_msg=field.name
            )
            twin = SCALE.get(field.name) == "mm"
            assert (f"{field.name}_rel" in columns) == twin
            if twin:
                np.testing.assert_array_equal(columns[f"{field.name}_rel"], given[field.name])
    assert not {field.name for field in casefile.LOAD_FIELDS} & columns.keys()
    assert {columns[name].dtype for name in ("regime", "extremum_kind", "sensitive")} == {
        np.dtype("i1")
    }
    unknown = casefile.record(replace(RUN, sensitive=None), pair)
    assert unknown["sensitive"] == -1


def test_without_its_time_course_a_record_holds_the_rest(pair):
    columns = casefile.record(RUN, pair)
    rest = casefile.without_time_course(columns)
    courses = {"time", "stiffness", "modified_stiffness", "force_dynamic", "force_friction"}
    courses |= {"regime", *"yva", *(f"{name}_rel" for name in "yva")}
    assert columns.keys() - rest.keys() == courses
    names = {field.name for field in casefile.fields_in(rest)}
    assert names == {field.name for field in casefile.FIELDS}
    assert [field.name for field in casefile.fields_in(["force_max", "y_max_rel", "y"])] == [
        *("y_max", "force_max"),
    ]


def test_a_run_that_failed_has_its_status_and_nothing_else(pair):
    columns = casefile.record(Response("diverged", 9.5), pair)
    assert columns["status"] == 2
    assert (columns["n_contact_losses"], columns["sensitive"]) == (-1, -1)
    assert np.isnan([columns[name] for name in ("y_max", "mesh_period", "y_max_rel")]).all()
    assert columns["strobe_y"].shape == (5 * 21 + 1,)
    assert columns["extremum_kind"].tolist() == [0]
    for name in ("strobe_y", "strobe_v", "extremum_y", "extremum_time"):
        assert np.isnan(columns[name]).all()
    assert casefile.boundaries(pair.replace(revolutions=7)) == 148


def test_the_attributes_of_a_variable(pair):
    known = {field.name: field for field in casefile.ALL_FIELDS}
    field = known["y_max"]
    assert field.relative == "y_max_rel"
    assert known["status"].relative is None
    assert casefile.variable_attributes(field) == {
        "units": "mm",
        "long_name": "maximum of y over the kept revolutions",
    }
    assert casefile.variable_attributes(field, relative=True) == {
        "units": "1",
        "long_name": "maximum of y over the kept revolutions, in static deflections y_st",
    }
    flags = casefile.variable_attributes(known["regime"])
    assert flags["flag_values"].tolist() == [1, 0, -1]
    assert flags["flag_values"].dtype == np.dtype("i1")
    assert flags["flag_meanings"] == "normal_mesh contact_loss inverse_mesh"
    stated = casefile.variable(known["sensitive"], "sensitive", np.array(1), ())
    assert stated.attributes["_FillValue"] == -1
    assert stated.attributes["flag_values"].tolist() == [0, 1]
    twin = casefile.variable(field, "y_max_rel", np.array(1.0), ())
    assert (twin.attributes["units"], "_FillValue" in twin.attributes) == ("1", False)
    assert casefile.EXTREMUM_KINDS == {1: "maximum", -1: "minimum", 0: "none"}


def test_the_digest_of_a_case_counts_its_samples_only_if_it_holds_them(pair):
    more = pair.replace(samples_per_period=512)
    short, course = (Case(variant("c-material"), 0.66, time_course=t) for t in (False, True))
    digests = {(p, c): casefile.case_digest(p, c) for p in (pair, more) for c in (short, course)}
    assert digests[pair, short] == digests[more, short]
    assert len({digests[p, c] for p, c in digests if c is course} | {digests[pair, short]}) == 3
    other = replace(course, nu=0.67)
    assert casefile.case_digest(pair, other) != digests[pair, course]
    assert casefile.case_digest(pair, replace(course, loads=True)) != digests[pair, course]
    assert casefile.case_digest(pair, replace(course, direction="up")) == digests[pair, course]


def test_the_digest_of_a_case_changes_with_the_sources_of_the_physics(pair, monkeypatch):
    case = Case(variant("c-material"), 0.66)
    digests = set()
    for physics in ("one", "another"):
        monkeypatch.setattr(provenance, "physics_digest", lambda physics=physics: physics)
        casefile._common_digest.cache_clear()
        casefile.case_digest.cache_clear()
        digests.add(casefile.case_digest(pair, case))
    assert len(digests) == 2
    monkeypatch.undo()
    casefile._common_digest.cache_clear()
    casefile.case_digest.cache_clear()


def test_the_attributes_of_a_file_say_what_it_is(pair):
    case = Case(variant("c-material"), 0.66)
    stated = casefile.attributes(pair, case)
    assert (stated["variant"], stated["nu_s"], stated["Conventions"]) == (
        *("c-material", 0.66, "CF-1.11"),
    )
    assert stated["title"] == "gear mesh, variant c-material, nu_s = 0.66"
    assert stated["case_sha256"] == casefile.case_digest(pair, case)
    assert stated["parameters_sha256"] == pair.digest()
    assert "sweep_direction" not in stated
    assert casefile.attributes(pair, replace(case, direction="up"))["sweep_direction"] == "up"
    assert {f"{name}_version" for name in provenance.versions()} <= stated.keys()


def test_a_file_is_read_as_it_was_written(tmp_path, pair):
    path, again = tmp_path / "new" / "case.nc", tmp_path / "again.nc"
    columns = casefile.record(RUN, pair)
    casefile.write_case(path, {"title": "one", "nu_s": 0.66}, columns)
    stated, found = casefile.read_case(path)
    assert (stated["title"], stated["nu_s"]) == ("one", 0.66)
    assert found.keys() == columns.keys()
    for name, values in columns.items():
        np.testing.assert_array_equal(found[name], values, err_msg=name)
        assert found[name].dtype == values.dtype
    casefile.write_case(again, stated, found)
    assert again.read_bytes() == path.read_bytes()


def test_a_manifest_is_a_list_of_hashes(tmp_path):
    names = ("b.nc", "a.nc", "c.txt")
    for name in names:
        (tmp_path / name).write_text(name)
    path, hashes = (
        tmp_path / "job.sha256",
        {n: hashlib.sha256(n.encode()).hexdigest() for n in names},
    )
    files = [tmp_path / name for name in names]
    manifest.write(path, tmp_path, "0123", files[:2], files[2:])
    assert path.read_text() == (
        f"# made of 0123\n{hashes['a.nc']}  a.nc\n{hashes['b.nc']}  b.nc\n"
        f"# read\n{hashes['c.txt']}  c.txt\n"
    )
    manifest.write(path, tmp_path, "4567", files[:1], [])
    assert path.read_text() == f"# made of 4567\n{hashes['b.nc']}  b.nc\n"
    held = manifest.read(path)
    assert (held.made_of, held.read) == ("4567", {})
    # A file is read once, so the hash is that of the first time.
    known = manifest.Hashes(tmp_path)
    assert known.of(name for name in ("a.nc", "none")) == {"a.nc": hashes["a.nc"], "none": None}
    (tmp_path / "a.nc").write_text("other")
    (tmp_path / "none").write_text("there now")
    assert known.of(["a.nc", "none"]) == {"a.nc": hashes["a.nc"], "none": None}


def test_figures_notebooks_and_what_the_report_reads():
    places = Places("mine")
    assert paths.NOTEBOOK_NAMES == ("fig2", "fig3", "fig4", "fig5", "fig6", "fig7")
    assert ("printed", *paths.NOTEBOOK_NAMES) == paths.CHECKED
    assert paths.notebook("fig2").as_posix() == "notebooks/fig2.ipynb"
    names = [path.relative_to(places.folder).as_posix() for path in places.of_why]
    assert names[:3] == [
        *("datasets/branches.nc", "datasets/special_points.json", "datasets/thresholds.json"),
    ]
    assert names[3] == "datasets/basins.nc" and len(names) == 3 + 8 + 12
    assert names[-12:] == [
        f"figures/{name}.{kind}" for name in paths.WHY_FIGURES for kind in ("png", "svg")
    ]
    # A label may be a wildcard of Snakemake.
    assert paths.case_name("c-material", "{nu}") == "c-material/nu-{nu}.nc"


def test_the_loads_of_a_run_stand_beside_its_numbers(pair):
    """In these samples neither the stiffness nor the regime jumps."""
    still = replace(SAMPLES, regime=np.ones(COUNT, int), stiffness=np.ones(COUNT), extremes=None)
    run = replace(RUN, samples=still, located_contact_force=-0.5)
    problem = pair.problem(variant("c-material"), 0.66)
    columns = casefile.record(run, pair, problem)
    force = still.force_normal
    assert columns["dynamic_factor"] == force[-1]
    newtons = {
        "force_max": force[-1],
        "force_min": force[0],
        "least_contact_force": -0.5,
        "force_bearing_3_max": still.force_bearing_3[-1],
        "force_bearing_2_max": still.force_bearing_2[-1],
        "force_normal": force,
        "force_bearing_3": still.force_bearing_3,
    }
    for name, value in newtons.items():
        np.testing.assert_allclose(columns[name], value * pair.static_force, rtol=1e-14)
    assert columns["transmission_error_rms_rel"] == pytest.approx(np.sqrt(2.0))  # of 0 to 4
    assert columns["transmission_error_range"] == pytest.approx(4.0 * pair.static_deflection)
    assert columns["transmission_error_rel"].tolist() == still.transmission_error.tolist()
    assert [field.name for field in casefile.fields_in(columns)][-len(casefile.LOAD_FIELDS) :] == [
        field.name for field in casefile.LOAD_FIELDS
    ]
    failed = casefile.record(Response("diverged", 9.5), pair, problem)
    assert np.isnan([failed[field.name] for field in casefile.LOAD_FIELDS]).all()
    assert "force_normal" not in failed
    rest = casefile.without_time_course(columns)
    assert {"force_normal", "transmission_error_rel"} <= columns.keys() - rest.keys()
