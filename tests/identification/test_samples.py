"""Samples of the open parameters, measured by the ledger's own checks on real runs."""

from dataclasses import replace

import numpy as np
import pytest
import yaml
from project import Project

from gearmesh.data import paths
from gearmesh.data.paths import Places
from gearmesh.dynamics.response_curves import WIDTH
from gearmesh.identification import layout, table
from gearmesh.identification.factors import KINDS
from gearmesh.identification.sampling import design, store, survey
from gearmesh.identification.sampling.curves import ACCURACY, SampledCurve, scan_all
from gearmesh.identification.settings import load_settings
from gearmesh.model.variants import variant
from gearmesh.reproduction import thresholds
from gearmesh.solvers.simulation import simulate

SETTINGS = paths.CONFIG / "identify.yaml"
PLACES = Places("tiny")


@pytest.fixture
def sample(pair):
    return design.stated(pair)


def test_the_sample_of_a_study_is_the_study(pair, sample):
    again = design.pair_of(sample, pair)
    for variant_name in ("c-material", "d-both"):
        one, other = (p.problem(variant(variant_name), 0.7) for p in (pair, again))
        for name in one.__slots__:
            value = getattr(one, name)
            if isinstance(value, int | float | tuple) and value != ():
                value = pytest.approx(value, rel=1e-12)
            assert getattr(other, name) == value, name


def test_a_sample_keeps_its_values_where_others_are_replaced(pair, sample):
    """The study states its backlash as a multiple of y_st; the sample does not."""
    drawn = design.pair_of(sample | {"backlash": 3.0}, pair)
    assert drawn.replace(teeth=24).backlash == drawn.backlash == pytest.approx(0.03)
    (backlash,) = (p for p in drawn.parameters if p.name == "backlash")
    assert (backlash.kind, backlash.reason) == ("stated", "")


def test_samples_fill_their_ranges(root, pair):
    settings = load_settings(root / SETTINGS)
    survey_design = settings.designs["survey"].model_copy(update={"points": 256})
    places = design.unit_points(survey_design)
    drawn = design.samples(places, survey_design, settings, pair)
    for name in survey_design.vary:
        if name == "kind":
            counts = [sum(s["kind"] == kind for s in drawn) for kind in KINDS]
            assert min(counts) >= 80
            continue
        bounds = settings.ranges[name]
        filled = np.histogram([bounds.unit(s[name]) for s in drawn], 8, (0, 1))[0]
        assert filled.sum() == 256 and filled.min() >= 28, name
        assert drawn[0]["eccentricity_3"] == 0.0


def test_coarse_scans_locate_thresholds_as_the_ledger_does(pair, sample):
    names = ["c-lubricant", "c-material", "c-material-5x"]
    curves = {name: SampledCurve(sample, pair, name) for name in names}
    scan_all(list(curves.values()))
    found = thresholds.locate_on(curves, pair)
    closely = {name: thresholds.curve_of(pair, name) for name in names}
    expected = thresholds.locate_on(closely, pair)
    for observable, name in (
        ("first_jump", "c-lubricant"),
        ("second_jump", "c-lubricant"),
        ("loop_end", "c-material"),
        ("loop_end", "c-material-5x"),
    ):
        within = ACCURACY + WIDTH
        assert found[observable][name] == pytest.approx(expected[observable][name], abs=within)
    crossing = "exceedance", "c-material-5x"
    np.testing.assert_allclose(*(f[crossing[0]][crossing[1]] for f in (found, expected)),
                               atol=ACCURACY)  # fmt: skip
    assert sum(c.runs for c in curves.values()) < 0.6 * sum(c.runs for c in closely.values())


@pytest.mark.parametrize("kind", ["up", "down"])
def test_a_sweep_goes_on_from_its_neighbour(pair, sample, kind):
    curve = SampledCurve(sample | {"kind": kind}, pair, "b-lubricant")
    scan_all([curve])
    first, second = (float(nu) for nu in curve.grid[:2])
    assert (first < second) == (kind == "up")
    start, following = curve.at([first, second])
    by_hand = replace(pair.problem(variant("b-lubricant"), second), initial_state=start.final_state)
    assert following.y_max == simulate([by_hand], pair.tolerance)[0].y_max
    # Off the grid a run starts from the same neighbour as its next place on the grid.
    between = 0.5 * (first + second)
    assert curve.problem(between).initial_state == start.final_state


def test_an_initial_velocity_is_one_of_the_mesh(pair, sample):
    curve = SampledCurve(sample | {"initial_velocity": 0.4}, pair, "b-material")
    (response,) = curve.at([0.7])
    assert response.strobe_v[0] == pytest.approx(0.4)
    assert response.strobe_y[0] == pytest.approx(1.0)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_sample_does_not_depend_on_its_group(pair, sample, monkeypatch):
    drawn = [sample, sample | {"damping_length": 0.3}, sample | {"kind": "up"}]
    together = list(survey.measure(drawn, pair))
    monkeypatch.setattr(survey, "_GROUP", 1)
    alone = list(survey.measure(drawn, pair))
    assert [{k: repr(v) for k, v in row.items()} for row in together] == [
        {k: repr(v) for k, v in row.items()} for row in alone
    ]
    claims = {column.partition("|")[0] for column in together[0]}
    assert claims == set(survey.tested_claims())


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A few samples of each design, inferred from by the pipeline."""
    project = Project.create(tmp_path_factory.mktemp("identify") / "project", "config/tiny.yaml")
    settings = yaml.safe_load((project.folder / SETTINGS).read_text(encoding="utf-8"))
    for stated in settings["designs"].values():
        stated["points"] = 2
    settings["designs"]["survey"]["points"] = 8
    for name in ("natural_near", "natural_nearer"):  # no more than `near` and `nearer` show
        del settings["designs"][name]
    # One design on the full model is enough, and dear enough.
    settings["designs"]["run_out_alone"]["vary"] = ["eccentricity_angle"]
    (project.folder / SETTINGS).write_text(yaml.safe_dump(settings), encoding="utf-8")
    # Short runs, because only what becomes of them is of interest.
    project.edit("config/tiny.yaml", "title:", "revolutions: 1\ntitle:")
    project.finished = project.run("identify")
    return project


def test_the_pipeline_identifies(small, monkeypatch):
    assert small.finished.returncode == 0, small.finished.stdout
    monkeypatch.chdir(small.folder)
    settings = load_settings(SETTINGS)
    samples = store.read(layout.dataset(PLACES))
    assert {name: int(np.sum(samples.design == name)) for name in settings.designs} == {
        name: stated.points for name, stated in settings.designs.items()
    }
    found = table.read(layout.found(PLACES))
    assert list(found["claims"]) == survey.tested_claims()
    assert found["samples"] == {name: stated.points for name, stated in settings.designs.items()}


def test_a_run_that_was_stopped_goes_on(small):
    for made in (
        layout.batch_file(PLACES, "natural", 0),
        layout.dataset(PLACES),
        layout.found(PLACES),
    ):
        (small.folder / made).unlink()
    planned = small.plan("identify")
    assert planned >= {"samples-natural-000", "all_samples", "identified"}
    assert not [job for job in planned if job.startswith(("samples-survey", "samples-truth"))]


def test_the_default_target_does_not_identify(small):
    planned = small.plan("all")
    assert not [job for job in planned if job.startswith(("samples", "box", "identified-"))]
