import json
import math

import numpy as np
import pytest
import xarray as xr
import yaml
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.data import paths
from gearmesh.errors import InputError
from gearmesh.reproduction.claims import (
    DEVIATES,
    NOT_TESTABLE,
    REPRODUCED,
    Claim,
    Entry,
    Evidence,
    NotInStudy,
    checking,
    collect,
    fig2,
    fig3,
    fig4,
    fig5,
    fig6,
    fig7,
    holds,
    load_ledger,
    printed,
    read_entries,
    verdict,
    write_entries,
)
from gearmesh.reproduction.claims.checking import check_figure
from gearmesh.study.loading import load_study

FIGURES = ("printed", *paths.NOTEBOOK_NAMES)


def claim(**changes):
    fields = {
        "id": "F2.1",
        "where": "Fig. 2",
        "figure": "fig2",
        "statement": "It is so.",
        "kind": "shape",
        "expected": {"at_most": 1.0},
    }
    return Claim(**{**fields, **changes})


@pytest.fixture(scope="module")
def parameters():
    return load_study(paths.PAPER).pair


@pytest.fixture(scope="module")
def ledger():
    return load_ledger(paths.CLAIMS)


# --- the ledger of the paper


def test_every_claim_has_its_measure_and_every_measure_its_claim(ledger):
    assert [c.id for c in ledger] == list(checking.MEASURES)


def test_a_claim_is_checked_by_the_figure_it_belongs_to(ledger):
    modules = {"printed": printed, "fig2": fig2, "fig3": fig3, "fig4": fig4}
    modules |= {"fig5": fig5, "fig6": fig6, "fig7": fig7}
    for c in ledger:
        assert c.id in modules[c.figure].MEASURES


def test_the_printed_numbers_hold(ledger, parameters):
    entries = check_figure("printed", Evidence(parameters=parameters), ledger)
    assert {e.id: e.status for e in entries} == {f"P{n}": REPRODUCED for n in range(1, 10)}


@pytest.mark.parametrize(
    ("change", "broken"),
    [
        ({"printed.damping": "4.2 N s/mm"}, {"P3"}),
        ({"printed.stiffness_ratio": 0.6}, {"P1", "P2", "P3", "P4"}),
        ({"derived.pressure_angle": "21 deg"}, {"P6"}),
        # Constant stiffness excites nothing: there is no tongue to find.
        ({"printed.stiffness_ratio": 1.0}, {"P1", "P2", "P3", "P4", "P5", "P8"}),
        ({"printed.contact_ratio": 1.7}, {"P1", "P3", "P4", "P7"}),
    ],
)
def test_another_parameter_breaks_the_printed_numbers_it_enters(ledger, parameters, change, broken):
    evidence = Evidence(parameters=parameters.replace(change))
    entries = check_figure("printed", evidence, ledger)
    assert {e.id for e in entries if e.status == DEVIATES} == broken


# --- reading the ledger

GOOD = {
    "where": "Fig. 2",
    "figure": "fig2",
    "statement": "It is so.",
    "kind": "threshold",
    "expected": 0.66,
    "tolerance": 0.02,
}


def written(tmp_path, content):
    path = tmp_path / "claims.yaml"
    path.write_text(content if isinstance(content, str) else yaml.safe_dump(content), "utf-8")
    return path


def test_a_claim_is_read_with_its_id(tmp_path):
    (read,) = load_ledger(written(tmp_path, {"F2.1": GOOD}))
    assert (read.id, read.expected, read.tolerance) == ("F2.1", 0.66, 0.02)
    assert read.expected_status == REPRODUCED


@pytest.mark.parametrize(
    ("slip", "told"),
    [
        ({"tolerence": 0.1}, "tolerence: unknown key (did you mean 'tolerance'?)"),
        ({"kind": "hunch"}, "kind: found 'hunch'"),
        ({"figure": "fig1"}, "figure: found 'fig1'"),
        ({"statement": None}, "statement: found nothing"),
        ({"expected": "0.66 or so"}, "expected: found '0.66 or so'; allowed is a number"),
        ({"expected": True}, "expected: found True; allowed is a number"),
        ({"expected": {"at_least": 2, "at_most": 1}}, "at_least: 2 is above at_most, 1"),
        ({"expected": {"at_most": 1}}, "tolerance: needed for an expected number only"),
        ({"expected": {"near": {}}}, "expected.at_least: missing"),
        ({"tolerance": None}, "tolerance: needed for an expected number only"),
        ({"tolerance": -0.1}, "tolerance: found -0.1; allowed is a number >= 0"),
        ({"tolerance": {"near": 0.1}}, "tolerance: expected names no quantity 'near'"),
        ({"expected": {"a": 1.0}, "tolerance": {}}, "tolerance: needed for an expected number"),
        ({"expected_status": "deviates"}, "reason: needed for an expected_status"),
        ({"reason": "just so"}, "reason: needed for an expected_status"),
        ({"expected_status": "perhaps"}, "expected_status: found 'perhaps'"),
    ],
)
def test_a_slip_in_the_ledger_is_told_in_one_line(tmp_path, slip, told):
    path = written(tmp_path, {"F2.1": {**GOOD, **slip}})
    with pytest.raises(InputError) as caught:
        load_ledger(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: F2.1")
    assert told in message
    assert "\n" not in message


@pytest.mark.parametrize(
    "content", ["", "- F2.1\n", "F2.1: soon\n", "F2.1: {}\nF2.1: {}\n", "F2.1: [\n", "2.1: {}\n"]
)
def test_a_ledger_of_another_shape_is_refused_in_one_line(tmp_path, content):
    path = written(tmp_path, content)
    with pytest.raises(InputError) as caught:
        load_ledger(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_wrong_id_is_refused(tmp_path):
    with pytest.raises(InputError, match="Figure 2"):
        load_ledger(written(tmp_path, {"Figure 2": GOOD}))


# --- what counts as holding


@pytest.mark.parametrize(
    ("expected", "tolerance", "measured", "outcome"),
    [
        (0.66, 0.02, 0.645, True),
        (0.66, 0.02, 0.64, True),  # on the limit
        (0.66, 0.02, 0.639, False),
        (0.66, 0.02, None, False),
        (0.66, 0.02, math.nan, False),
        (0.66, 0.02, {"c": 0.65, "d": 0.67}, True),
        (0.66, 0.02, {"c": 0.65, "d": 0.70}, False),
        (0.66, 0.02, {"c": 0.65, "d": None}, False),
        (0.66, 0.02, {}, False),
        ({"at_most": 1}, None, 1.0, True),
        ({"at_most": 1}, None, 1.1, False),
        ({"at_least": 1}, None, math.inf, False),
        ({"at_least": 0.8, "at_most": 0.9}, None, 0.85, True),
        ({"a": 1.0, "b": {"at_least": 2}}, 0.1, {"a": 1.05, "b": 3, "c": "for the eye"}, True),
        ({"a": 1.0, "b": {"at_least": 2}}, 0.1, {"a": 1.05, "b": 1}, False),
        ({"a": 1.0, "b": {"at_least": 2}}, 0.1, {"a": 1.05}, False),
        ({"a": 1.0, "b": 2.0}, {"a": 0.1, "b": 0.5}, {"a": {"c": 1.0, "d": 1.1}, "b": 1.5}, True),
    ],
)
def test_what_was_measured_holds_within_the_tolerance(expected, tolerance, measured, outcome):
    assert holds(claim(expected=expected, tolerance=tolerance), measured) is outcome


@given(st.floats(-10, 10), st.floats(0, 5), st.floats(0, 5))
def test_what_holds_within_a_tolerance_holds_within_a_wider_one(measured, narrow, more):
    if holds(claim(expected=1.0, tolerance=narrow), measured):
        assert holds(claim(expected=1.0, tolerance=narrow + more), measured)


# --- statuses


@pytest.fixture
def measuring(monkeypatch, parameters):
    """Let F2.1 measure what a test says, and check a claim with it."""

    def run(measure, **changes):
        monkeypatch.setitem(checking.MEASURES, "F2.1", measure)
        return checking.check(claim(**changes), Evidence(parameters=parameters))

    return run


def test_a_claim_that_holds_is_reproduced(measuring):
    entry = measuring(lambda evidence: (0.5, "half of it"))
    assert (entry.status, entry.measured, entry.detail) == (REPRODUCED, 0.5, "half of it")
    assert not entry.unexpected


def test_a_claim_that_does_not_hold_deviates_with_its_number(measuring):
    entry = measuring(lambda evidence: (1.5, ""))
    assert (entry.status, entry.measured) == (DEVIATES, 1.5)
    assert entry.unexpected


def test_a_deviation_can_be_expected_and_then_success_is_unexpected(measuring):
    known = {"expected_status": DEVIATES, "reason": "as explained"}
    assert not measuring(lambda evidence: (1.5, ""), **known).unexpected
    assert measuring(lambda evidence: (0.5, ""), **known).unexpected


def test_what_the_study_lacks_is_not_judged(measuring):
    def lacking(evidence):
        raise NotInStudy("c-lubricant")

    entry = measuring(lacking)
    assert entry.status == NOT_TESTABLE
    assert entry.detail == "not in this study: c-lubricant"
    assert not entry.unexpected


def test_a_claim_without_a_check_is_an_input_error(parameters):
    with pytest.raises(InputError, match=r"F9\.9: no such check"):
        check_figure("fig2", Evidence(parameters=parameters), [claim(id="F9.9")])


def test_in_an_empty_study_nothing_is_testable_and_nothing_unexpected(ledger, parameters):
    evidence = Evidence(parameters=parameters)
    entries = [e for figure in FIGURES[1:] for e in check_figure(figure, evidence, ledger)]
    assert {e.status for e in entries} == {NOT_TESTABLE}
    assert verdict(entries).unexpected == ()


def entry(name, status=REPRODUCED, **changes):
    return Entry(**claim(id=name).model_dump(), status=status, **changes)


def test_entries_are_written_and_read_back(tmp_path):
    path = tmp_path / "checks" / "fig2.json"
    write_entries(path, [entry("F2.1", measured={"c": math.nan, "d": 0.123456789}, detail="ν_s")])
    (stored,) = json.loads(path.read_text("utf-8"))
    assert stored["measured"] == {"c": None, "d": 0.123457}
    assert stored.keys() >= {"id", "where", "statement", "kind", "expected", "tolerance"}
    assert stored.keys() >= {"measured", "status", "expected_status"}
    assert "reason" not in stored
    (read,) = read_entries(path)
    assert (read.id, read.status, read.detail) == ("F2.1", REPRODUCED, "ν_s")


@pytest.mark.parametrize("content", ["", "[{", "{}", '[{"id": "F2.1"}]', "[3]"])
def test_a_broken_file_of_checks_is_refused_in_one_line(tmp_path, content):
    path = tmp_path / "fig2.json"
    path.write_text(content)
    with pytest.raises(InputError) as caught:
        read_entries(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_all_checks_come_together_in_the_order_of_the_ledger(tmp_path):
    write_entries(tmp_path / "b.json", [entry("F2.2", DEVIATES)])
    write_entries(tmp_path / "a.json", [entry("F3.1"), entry("F2.1")])
    known = [claim(id=name) for name in ("F2.1", "F2.2", "F3.1", "F4.1")]
    entries = collect(known, tmp_path.glob("[ab].json"), tmp_path / "claims.json")
    assert [e.id for e in entries] == ["F2.1", "F2.2", "F3.1", "F4.1"]
    assert [e.status for e in read_entries(tmp_path / "claims.json")] == [
        REPRODUCED,
        DEVIATES,
        REPRODUCED,
        NOT_TESTABLE,
    ]
    found = verdict(entries)
    assert (found.reproduced, found.deviates, found.not_testable) == (2, 1, 1)
    # A claim that no notebook came to check must not pass for one that the study lacks.
    assert [e.id for e in found.unexpected] == ["F2.2", "F4.1"]
    assert str(found).splitlines() == [
        "claims: 2 reproduced, 1 deviating, 1 not testable",
        "  unexpected: F2.2 is deviates, expected reproduced",
        "  unexpected: F4.1 is not_testable, expected reproduced",
    ]


# --- measures of thresholds


LUBRICANT = ("b-lubricant", "c-lubricant", "d-lubricant", "h-lubricant")
MISSING = {
    "first_jump": dict.fromkeys(LUBRICANT),
    "second_jump": dict.fromkeys(LUBRICANT),
    "peak": {name: {"nu": None, "y_max": None} for name in LUBRICANT},
    "lowest": dict.fromkeys(LUBRICANT),
    "onset_maxima": dict.fromkeys(LUBRICANT),
    "onset_minima": dict.fromkeys(LUBRICANT),
    "onset_strobes": dict.fromkeys(LUBRICANT),
    "largest_rise": dict.fromkeys(LUBRICANT),
    "loss_gained": {name: {"first": None, "second": None} for name in LUBRICANT},
    "maxima_spread": {name: {"below": None, "above": None} for name in LUBRICANT},
    "strobe_spread": {name: {"0.60": None, "1.05": None, "1.20": None} for name in LUBRICANT},
    "largest_step": {name: {"nu": None, "step": None} for name in fig2.IN_MATERIAL},
    "jumps": {"b-material": [], "b-both": []},
    "material_or_both": dict.fromkeys("cdh"),
    "course_spread": {"below": None, "above": None},
    "loop_end": {"c-material": None, "c-material-5x": None},
    "loop_place": {"c-material": None, "c-material-5x": None},
    "turning_points_before": {"c-material": None, "c-material-5x": None},
    "turning_points_beyond": {"c-material": None, "c-material-5x": None},
    "exceedance": {"c-material-5x": []},
}


def test_thresholds_that_do_not_exist_deviate(ledger, parameters):
    evidence = Evidence(parameters=parameters, thresholds=MISSING)
    entries = [e for figure in FIGURES[1:6] for e in check_figure(figure, evidence, ledger)]
    assert {e.id for e in entries if e.status != DEVIATES} == {"F4.2"}  # needs time courses


def test_the_interval_of_exceedance_is_the_one_around_the_papers_place(parameters):
    intervals = [[0.6, 0.605], [0.608, 0.62], [0.7, 0.8]]
    evidence = Evidence(
        parameters=parameters, thresholds={"exceedance": {"c-material-5x": intervals}}
    )
    assert fig6.more_damped_exceeds(evidence)[0] == {"from": 0.608, "to": 0.62}


@pytest.mark.parametrize(("place", "distance"), [(0.2845, 0.0), (0.7135, 0.002), (0.98, 0.2645)])
def test_the_distance_of_a_loop_from_the_nearest_switch(parameters, place, distance):
    evidence = Evidence(parameters=parameters, thresholds={"loop_place": {"c-material": place}})
    assert fig5.distance_to_switch(evidence, "c-material") == pytest.approx(distance)


def test_peaks_are_measured_from_the_jump_and_from_the_peak_of_c(parameters):
    peaks = {"c-lubricant": 0.77, "d-lubricant": 0.80, "h-lubricant": 0.82}
    evidence = Evidence(
        parameters=parameters,
        thresholds={
            "peak": {name: {"nu": nu, "y_max": 3.0} for name, nu in peaks.items()},
            "second_jump": {"c-lubricant": 0.77, "d-lubricant": 0.78, "h-lubricant": 0.79},
        },
    )
    measured, _ = fig2.rounded_peaks(evidence)
    assert measured["beyond the jump"] == pytest.approx({"d-lubricant": 0.02, "h-lubricant": 0.03})
    beyond_c = measured["beyond the peak of c"]
    assert beyond_c == pytest.approx({"d-lubricant": 0.03, "h-lubricant": 0.05})


# --- measures of time courses

PERIODS, PER_PERIOD = 4, 256


def course(parameters, **fields):
    """Make up a time course over a few periods: phase -> y_rel and a_rel."""
    phase = np.arange(PERIODS * PER_PERIOD) / PER_PERIOD
    half_width = 0.2845
    double = np.abs(phase - np.round(phase)) < half_width
    c_max, c_min = parameters.mesh_stiffness_max, parameters.stiffness_min
    made = {
        "time": (phase - parameters.initial_phase) * 2.0,
        "y_rel": np.ones(phase.size),
        "stiffness": np.where(double, c_max, c_min),
        "regime": np.ones(phase.size, int),
        "force_friction": np.where(double, 0.0, np.where(phase % 1 < 0.5, 1.0, -1.0)),
    }
    made |= {name: value(phase) if callable(value) else value for name, value in fields.items()}
    if "a_rel" not in made:
        heavy = 1 + 2 * parameters.reduced_mass / parameters.body_mass
        made["a_rel"] = -heavy * made["stiffness"] / parameters.stiffness_mean * made["y_rel"]
    data = {name: ("sample", value) for name, value in made.items()}
    return xr.Dataset(data | {"mesh_period": ((), 2.0)})


def test_corners_at_the_switches_are_measured_in_units_of_the_jump_of_stiffness(parameters):
    found = fig4.corners(course(parameters), Evidence(parameters=parameters))
    assert found["at the switches"] == pytest.approx(1.0)
    assert found["elsewhere"] == pytest.approx(0.0, abs=1e-12)


def test_a_smooth_trend_is_no_corner(parameters):
    case = course(parameters)
    case["a_rel"] = case["a_rel"] + 0.5 * np.sin(2 * np.pi * case["time"] / 2.0)
    found = fig4.corners(case, Evidence(parameters=parameters))
    assert found["at the switches"] == pytest.approx(1.0, abs=0.01)
    assert found["elsewhere"] < 0.01


def test_a_corner_away_from_the_switches_is_seen_unless_contact_is_lost_there(parameters):
    case = course(parameters)
    case["a_rel"] = case["a_rel"] + 0.3 * (np.arange(case.sizes["sample"]) >= 700)
    evidence = Evidence(parameters=parameters)
    assert fig4.corners(case, evidence)["elsewhere"] > 0.5
    case["regime"][698:703] = 0
    assert fig4.corners(case, evidence)["elsewhere"] == pytest.approx(0.0, abs=1e-12)


def test_without_a_switch_in_mesh_there_is_no_corner_to_measure(parameters):
    case = course(parameters, regime=lambda phase: np.zeros(phase.size, int))
    assert math.isnan(fig4.corners(case, Evidence(parameters=parameters))["at the switches"])


@pytest.mark.parametrize("lag", [0.0, 40.0, 185.0, 300.0])
def test_the_lag_behind_the_stiffness_is_that_of_the_first_harmonic(parameters, lag):
    def y(phase):
        return 1 + np.cos(2 * np.pi * phase - np.radians(lag)) + 0.4 * np.cos(6 * np.pi * phase)

    found = fig7.lag(course(parameters, y_rel=y), Evidence(parameters=parameters))
    assert (found - lag + 180) % 360 - 180 == pytest.approx(0.0, abs=1e-6)


def test_the_shift_of_phase_goes_the_short_way_round(parameters):
    def shifted(degrees):
        return course(parameters, y_rel=lambda p: np.cos(2 * np.pi * p - np.radians(degrees)))

    evidence = Evidence(
        parameters=parameters,
        time_courses={
            ("c-material", 0.61): shifted(350.0),
            ("c-material-5x", 0.61): shifted(8.0),
        },
    )
    assert fig7.phase_shift(evidence)[0]["shift"] == pytest.approx(18.0, abs=1e-6)


def friction(parameters, force):
    case = course(parameters, force_friction=force)
    courses = {(name, 0.61): case for name in ("c-material", "c-material-5x")}
    return fig7.friction_sense(Evidence(parameters=parameters, time_courses=courses))[0]


def test_friction_as_printed_is_seen(parameters):
    case = course(parameters)
    found = friction(parameters, case["force_friction"].values)
    assert found["in double contact"] == {"c-material": 0.0, "c-material-5x": 0.0}
    assert found["phase of the change"]["c-material"] == pytest.approx(0.5, abs=0.01)


def test_friction_in_double_contact_or_turning_elsewhere_is_seen(parameters):
    found = friction(parameters, lambda phase: np.where(phase % 1 < 0.4, 1.0, -1.0))
    assert found["in double contact"]["c-material"] == 1.0
    no_friction = friction(parameters, lambda phase: np.zeros(phase.size))
    assert math.isnan(no_friction["phase of the change"]["c-material"])


def test_a_time_course_is_found_by_its_frequency_or_lacking(parameters):
    case = course(parameters)
    evidence = Evidence(parameters=parameters, time_courses={("c-material", 0.61): case})
    assert evidence.time_course("c-material", 0.61) is case
    with pytest.raises(NotInStudy, match=r"c-material at 0\.6"):
        evidence.time_course("c-material", 0.6)


def test_the_range_of_branches_begins_at_its_lower_end(parameters):
    thresholds = {
        "loop_end": {"c-material": 0.64},
        "turning_points_before": {"c-material": 2.0},
    }
    measured, _ = fig3.further_branches(Evidence(parameters=parameters, thresholds=thresholds))
    assert measured == {"end": 0.64, "turning points before": 2.0}
