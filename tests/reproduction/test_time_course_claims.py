"""What the checks of the claims measure on time courses."""

import math

import numpy as np
import pytest
import xarray as xr

from gearmesh.reproduction.claims import Evidence, NotInStudy, fig3, fig4, fig7

PERIODS, PER_PERIOD = 4, 256


def course(pair, **fields):
    """Make up a time course over a few periods: phase -> y_rel and a_rel."""
    phase = np.arange(PERIODS * PER_PERIOD) / PER_PERIOD
    half_width = 0.2845
    double = np.abs(phase - np.round(phase)) < half_width
    c_max, c_min = pair.mesh_stiffness_max, pair.stiffness_min
    made = {
        "time": (phase - pair.initial_phase) * 2.0,
        "y_rel": np.ones(phase.size),
        "stiffness": np.where(double, c_max, c_min),
        "regime": np.ones(phase.size, int),
        "force_friction": np.where(double, 0.0, np.where(phase % 1 < 0.5, 1.0, -1.0)),
    }
    made |= {name: value(phase) if callable(value) else value for name, value in fields.items()}
    if "a_rel" not in made:
        heavy = 1 + 2 * pair.reduced_mass / pair.body_mass
        made["a_rel"] = -heavy * made["stiffness"] / pair.stiffness_mean * made["y_rel"]
    data = {name: ("sample", value) for name, value in made.items()}
    return xr.Dataset(data | {"mesh_period": ((), 2.0)})


def test_corners_at_the_switches_are_measured_in_units_of_the_jump_of_stiffness(pair):
    found = fig4.corners(course(pair), Evidence(pair=pair))
    assert found["at the switches"] == pytest.approx(1.0)
    assert found["elsewhere"] == pytest.approx(0.0, abs=1e-12)


def test_a_smooth_trend_is_no_corner(pair):
    case = course(pair)
    case["a_rel"] = case["a_rel"] + 0.5 * np.sin(2 * np.pi * case["time"] / 2.0)
    found = fig4.corners(case, Evidence(pair=pair))
    assert found["at the switches"] == pytest.approx(1.0, abs=0.01)
    assert found["elsewhere"] < 0.01


def test_a_corner_away_from_the_switches_is_seen_unless_contact_is_lost_there(pair):
    case = course(pair)
    case["a_rel"] = case["a_rel"] + 0.3 * (np.arange(case.sizes["sample"]) >= 700)
    evidence = Evidence(pair=pair)
    assert fig4.corners(case, evidence)["elsewhere"] > 0.5
    case["regime"][698:703] = 0
    assert fig4.corners(case, evidence)["elsewhere"] == pytest.approx(0.0, abs=1e-12)


def test_without_a_switch_in_mesh_there_is_no_corner_to_measure(pair):
    case = course(pair, regime=lambda phase: np.zeros(phase.size, int))
    assert math.isnan(fig4.corners(case, Evidence(pair=pair))["at the switches"])


@pytest.mark.parametrize("lag", [0.0, 40.0, 185.0, 300.0])
def test_the_lag_behind_the_stiffness_is_that_of_the_first_harmonic(pair, lag):
    def y(phase):
        return 1 + np.cos(2 * np.pi * phase - np.radians(lag)) + 0.4 * np.cos(6 * np.pi * phase)

    found = fig7.lag(course(pair, y_rel=y), Evidence(pair=pair))
    assert (found - lag + 180) % 360 - 180 == pytest.approx(0.0, abs=1e-6)


def test_the_shift_of_phase_goes_the_short_way_round(pair):
    def shifted(degrees):
        return course(pair, y_rel=lambda p: np.cos(2 * np.pi * p - np.radians(degrees)))

    evidence = Evidence(
        pair=pair,
        time_courses={
            ("c-material", 0.61): shifted(350.0),
            ("c-material-5x", 0.61): shifted(8.0),
        },
    )
    assert fig7.phase_shift(evidence)[0]["shift"] == pytest.approx(18.0, abs=1e-6)


def friction(pair, force):
    case = course(pair, force_friction=force)
    courses = {(name, 0.61): case for name in ("c-material", "c-material-5x")}
    return fig7.friction_sense(Evidence(pair=pair, time_courses=courses))[0]


def test_friction_as_printed_is_seen(pair):
    case = course(pair)
    found = friction(pair, case["force_friction"].values)
    assert found["in double contact"] == {"c-material": 0.0, "c-material-5x": 0.0}
    assert found["phase of the change"]["c-material"] == pytest.approx(0.5, abs=0.01)


def test_friction_in_double_contact_or_turning_elsewhere_is_seen(pair):
    found = friction(pair, lambda phase: np.where(phase % 1 < 0.4, 1.0, -1.0))
    assert found["in double contact"]["c-material"] == 1.0
    no_friction = friction(pair, lambda phase: np.zeros(phase.size))
    assert math.isnan(no_friction["phase of the change"]["c-material"])


def test_a_time_course_is_found_by_its_frequency_or_lacking(pair):
    case = course(pair)
    evidence = Evidence(pair=pair, time_courses={("c-material", 0.61): case})
    assert evidence.time_course("c-material", 0.61) is case
    with pytest.raises(NotInStudy, match=r"c-material at 0\.6"):
        evidence.time_course("c-material", 0.6)


def test_the_range_of_branches_begins_at_its_lower_end(pair):
    thresholds = {
        "loop_end": {"c-material": 0.64},
        "turning_points_before": {"c-material": 2.0},
    }
    measured, _ = fig3.further_branches(Evidence(pair=pair, thresholds=thresholds))
    assert measured == {"end": 0.64, "turning points before": 2.0}
