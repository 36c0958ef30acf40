"""Deviations of flanks, a start in six coordinates and tables alone, as a study states them."""

import math
import re

import numpy as np
import pytest

import gearmesh as gm
from gearmesh.errors import InputError
from gearmesh.model.mesh import mesh_stiffness
from gearmesh.model.variants import variant
from gearmesh.study.pair import Pair


def terms_of(pair, **changes):
    return pair.replace(**changes).problem(variant("b-both"), 0.7).terms


def test_flanks_are_stated_in_static_deflections_and_base_pitches(pair):
    errors = [f"{(-1) ** tooth} um" for tooth in range(20)] + ["0 um"]
    terms = terms_of(
        pair,
        pitch_errors=[errors, []],
        tip_relief=["20 um", "0 um"],
        tip_relief_length="2 mm",
        backlash_follows_centres=True,
        restoring_power=1.5,
    )
    assert terms.pitch_errors_3[:2] == pytest.approx(
        np.array([1e-3, -1e-3]) / pair.static_deflection
    )
    assert terms.pitch_errors_2 == ()
    assert terms.tip_relief == pytest.approx((0.02 / pair.static_deflection, 0.0))
    base_pitch = 2.0 * math.pi * pair.base_radius / 21
    assert terms.tip_relief_length == pytest.approx((2.0 / base_pitch, 0.0))
    assert terms.backlash_follows_centres
    assert terms.restoring_power == 1.5


def test_errors_that_are_all_equal_are_none(pair):
    plain = pair.problem(variant("b-both"), 0.7).terms
    assert terms_of(pair, pitch_errors=[["3.3 um"] * 21, ["-1 um"] * 21]) == plain
    assert terms_of(pair, tip_relief_length="1 mm") == plain


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"pitch_errors": [["1 um"] * 21]}, "pitch_errors: found 1 lists; allowed are two"),
        (
            {"pitch_errors": [["1 um"] * 20, []]},
            "found 20 values for wheel 3; allowed are none, or",
        ),
        ({"pitch_errors": [["1 um"] * 20 + ["1 kg"], []]}, "unit 'kg' is of another kind"),
        (
            {"pitch_errors": [["9 mm"] + ["0 mm"] * 20, []]},
            "pitch_errors: found teeth that stand out by 8.57143 mm; allowed is less than the",
        ),
        ({"tip_relief": "20 um"}, "tip_relief_length: found 0 mm; allowed beside tip_relief is"),
        ({"tip_relief": "1 um", "tip_relief_length": "1 m"}, "at most the path of contact"),
        ({"restoring_power": 3}, "restoring_power: found 3; out of range; allowed is 1 to 2"),
        ({"initial_coordinates": ["1 um"] * 5}, "initial_coordinates: found 5 values; allowed are"),
        (
            {"initial_rates": ["0 um"] * 6, "initial_velocity": "1 um"},
            "initial_rates: stated beside initial_displacement or initial_velocity",
        ),
    ],
)
def test_what_does_not_fit_is_refused_in_one_line(pair, changes, message):
    with pytest.raises(InputError, match=re.escape(message)):
        pair.replace(**changes)


def test_a_run_starts_from_the_six_coordinates_that_are_stated(pair):
    """The bodies start in their bearings unloaded; y follows from eq. (3)."""
    stated = {
        "initial_coordinates": ["0.3 y_st", "0.2 y_st", "0.1 y_st", "-0.1 y_st", "0 um", "1 um"],
        "initial_rates": ["0 um", "0.1 y_st", "0 um", "0 um", "0 um", "0 um"],
    }
    run = gm.simulate(pair.replace(**stated), "b-both", nu=0.7, revolutions=1)
    assert float(run.strobe_y_rel[0]) == pytest.approx(0.7)
    assert float(run.strobe_v_rel[0]) == pytest.approx(0.1)
    problem = pair.replace(**stated).problem(variant("b-both"), 0.7)
    assert problem.initial_state.coordinates == pytest.approx(
        (0.3, 0.2, 0.1, -0.1, 0.0, 1e-3 / pair.static_deflection, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0)
    )
    # With the coordinates of rest it is the run from rest. (y, v) at the call takes their place.
    rest = -0.5 * pair.static_force / pair.bearing_stiffness
    y_3, y_2 = f"{2 * rest!r} mm", f"{-2 * rest!r} mm"
    turned = f"{0.5 * (pair.static_deflection - 4 * rest)!r} mm"
    at_rest = pair.replace(initial_coordinates=[turned, turned, y_3, y_2, "0 mm", "0 mm"])
    plain = gm.simulate(pair, "b-both", nu=0.7, revolutions=1).strobe_y_rel.values
    found = gm.simulate(at_rest, "b-both", nu=0.7, revolutions=1).strobe_y_rel.values
    assert found == pytest.approx(plain, abs=1e-8)
    given = gm.simulate(at_rest, "b-both", nu=0.7, revolutions=1, start=(1.0, 0.0))
    assert given.strobe_y_rel.values == pytest.approx(plain, abs=1e-8)


@pytest.mark.parametrize(
    "table",
    [
        {"stiffness_table": ["3e5 N/mm", "4e5 N/mm", "2e5 N/mm"]},
        {"tooth_pair_stiffness": ["1e5 N/mm", "3e5 N/mm", "1e5 N/mm"]},
        {"tooth_pair_stiffness": ["2e5 N/mm", "2e5 N/mm"]},
    ],
)
def test_a_table_alone_states_the_stiffness(pair, table):
    stated = {
        name: statement
        for name, statement in pair.replace(**table)._statements.items()
        if name not in ("mesh_stiffness_max", "stiffness_ratio")
    }
    whole = Pair.from_statements(stated)
    rows = {row.name: row for row in whole.parameters}
    assert rows["mesh_stiffness_max"].kind == rows["stiffness_ratio"].kind == "derived"
    problem = whole.problem(variant("b-both"), 0.7)
    values = [mesh_stiffness(problem, phase) for phase in np.linspace(0.0, 1.0, 1201)]
    greatest = max(values) * whole.stiffness_mean
    assert whole.mesh_stiffness_max == pytest.approx(greatest, rel=1e-3)
    assert whole.stiffness_ratio == pytest.approx(min(values) / max(values), rel=1e-2)
    both = pair.replace(**table)
    assert problem.terms == both.problem(variant("b-both"), 0.7).terms
    assert both.mesh_stiffness_max == pair.mesh_stiffness_max


def test_a_pitch_chart_is_read_as_it_was_measured(tmp_path, pair):
    chart = tmp_path / "wheel.csv"
    chart.write_text("tooth,F_p\n1, 0.5\n2, -1.5\n3, 2\n", encoding="utf-8")
    assert gm.read_pitch_chart(chart) == ["0.5 um", "-1.5 um", "2.0 um"]
    chart.write_text("tooth,f_p\n1,2\n2,-2\n3,3\n4,1\n", encoding="utf-8")
    assert gm.read_pitch_chart(chart, "mm") == ["1.0 mm", "-2.0 mm", "0.0 mm", "0.0 mm"]
    chart.write_text("tooth,f_p\n" + "1,1\n" * 21, encoding="utf-8")
    assert terms_of(pair, pitch_errors=[gm.read_pitch_chart(chart), []]).pitch_errors_3 == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("tooth,error\n1,2\n", "found tooth, error; allowed is one column F_p or f_p"),
        ("", "found no teeth"),
        ("F_p\n1\n\nx\n", "line 4: found 'x'; allowed is a number"),
        ("tooth,F_p\n1\n", "line 2: found None"),
    ],
)
def test_a_chart_that_cannot_be_read_is_reported_in_one_line(tmp_path, text, message):
    chart = tmp_path / "wheel.csv"
    chart.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=re.escape(message)):
        gm.read_pitch_chart(chart)
    with pytest.raises(InputError, match="cannot be read: No such file"):
        gm.read_pitch_chart(tmp_path / "none.csv")
