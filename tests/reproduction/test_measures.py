"""What each claim measures, on thresholds that are given, and on formulas written out."""

import math

import numpy as np
import pytest
import xarray as xr

from gearmesh.reproduction.claims import (
    Evidence,
    NotInStudy,
    fig2,
    fig3,
    fig4,
    fig5,
    fig6,
    fig7,
)

LUBRICANT = ("c-lubricant", "d-lubricant", "h-lubricant")


@pytest.fixture
def measured(pair):
    """Return what a measure finds in thresholds."""

    def run(measure, **thresholds):
        return measure(Evidence(pair=pair, thresholds=thresholds))

    return run


def of(*values, names=LUBRICANT):
    return dict(zip(names, values, strict=True))


def test_the_checks_belong_to_variants_of_tab_1():
    assert tuple(fig2.LUBRICANT) == LUBRICANT
    assert ["b-lubricant", *LUBRICANT] == fig2.ALL_LUBRICANT
    assert [name[0] for name in fig2.IN_MATERIAL] == [*"ccddhh"]


def test_fig_2_steps_differences_and_jumps(measured):
    steps = {name: {"nu": 0.7, "step": 0.1 * i} for i, name in enumerate(fig2.IN_MATERIAL)}
    found, detail = measured(fig2.continuous_curves, largest_step=steps)
    assert found == {name: 0.1 * i for i, name in enumerate(fig2.IN_MATERIAL)}
    assert "in y_st" in detail
    differences = of(0.1, 0.2, None, names="cdh")
    found, detail = measured(fig2.material_or_both, material_or_both=differences)
    assert (found["c"], found["d"]) == (0.1, 0.2) and math.isnan(found["h"]) and detail
    first, second = (of(*at, names=fig2.ALL_LUBRICANT) for at in ((1, 2, 3, 4), (5, 6, 7, 8)))
    found, detail = measured(fig2.jump_frequencies, first_jump=first, second_jump=second)
    assert found == {"near 0.66": first, "near 0.8": second} and detail
    found, detail = measured(
        fig2.agreement_between_jumps, course_spread={"below": 0.1, "above": 0.4}
    )
    assert found == {"ratio": pytest.approx(0.25), "below": 0.1, "above": 0.4} and detail


def test_fig_2_peaks_inverse_mesh_and_jumps_of_the_linear_curves(measured, pair):
    peaks = {name: {"nu": nu, "y_max": 3.0} for name, nu in of(0.77, 0.80, 0.82).items()}
    _, detail = measured(fig2.rounded_peaks, peak=peaks, second_jump=of(0.7, 0.7, 0.7))
    assert detail == "distances in ν_s; peaks at c 0.770, d 0.800, h 0.820"
    backlash = pair.backlash / pair.static_deflection
    found, detail = measured(fig2.no_inverse_mesh, lowest=of(-1.0, -2.0, 0.5))
    assert found == pytest.approx(of(backlash - 1.0, backlash - 2.0, backlash + 0.5)) and detail
    jumps = {"b-material": [{"nu": 0.9}, {"nu": 0.7}], "b-both": []}
    found, detail = measured(fig2.linear_jumps, jumps=jumps)
    assert found == {"b-material": 2, "b-both": 0}
    assert detail == "number of jumps; at ν_s 0.700, 0.900"
    _, detail = measured(fig2.linear_jumps, jumps={"b-material": [], "b-both": []})
    assert detail == "number of jumps; at ν_s none"


def test_fig_3(measured):
    maxima, minima = of(1.1, 1.2, 1.3), of(1.0, 1.1, 1.2)
    found, detail = measured(fig3.bifurcation_onset, onset_maxima=maxima, onset_minima=minima)
    assert found == {"y_max": maxima, "y_min": minima} and detail
    found, detail = measured(fig3.contact_loss, lowest=of(-1.0, -2.0, -3.0))
    assert found == of(-1.0, -2.0, -3.0) and detail
    spreads = {name: {"below": b, "above": 4.0} for name, b in of(1.0, 2.0, 6.0).items()}
    found, detail = measured(fig3.order_below, maxima_spread=spreads)
    assert found == {"ratio": of(0.25, 0.5, 1.5), "below": of(1.0, 2.0, 6.0)} and detail
    bands = {name: {"smooth": s, "growth": 9.0, "more": 1} for name, s in of(1.0, 2.0, 3.0).items()}
    found, detail = measured(fig3.orderly_bands, band=bands)
    assert found == {"smooth": of(1.0, 2.0, 3.0), "growth": of(9.0, 9.0, 9.0)}
    assert "y_st" in detail
    gained = {name: {"first": f, "second": 2 * f} for name, f in of(0.1, 0.2, 0.3).items()}
    found, detail = measured(fig3.loss_at_jumps, loss_gained=gained)
    assert found == {"first": of(0.1, 0.2, 0.3), "second": of(0.2, 0.4, 0.6)} and detail
    found, detail = measured(fig3.orderly_decline, largest_rise=of(0.1, 0.2, 0.3))
    assert found == of(0.1, 0.2, 0.3) and detail
    found, detail = measured(
        fig3.further_branches,
        turning_points_before={"c-material": 4.0},
        loop_end={"c-material": 0.64},
    )
    assert found == {"end": 0.64, "turning points before": 4.0} and detail


def test_fig_4(measured, pair):
    spread = {"0.60": 0.3, "1.05": None, "1.20": 0.5}
    found, detail = measured(fig4.stroboscopic_spread, strobe_spread={"c-lubricant": spread})
    assert (found["0.60"], found["1.20"]) == (0.3, 0.5) and math.isnan(found["1.05"]) and detail
    found, detail = measured(
        fig4.bifurcation_is_heterodyne,
        onset_strobes=of(1.1, 1.2, 1.3),
        onset_maxima=of(1.15, 1.1, 1.3),
    )
    assert found == pytest.approx(of(0.05, 0.1, 0.0)) and detail
    turned = fig4.by_quantity({"0.60": {"a": 1, "b": 2}, "1.05": {"a": 3, "b": 4}})
    assert turned == {"a": {"0.60": 1, "1.05": 3}, "b": {"0.60": 2, "1.05": 4}}


def test_figs_5_and_6(measured):
    found, detail = measured(
        fig5.loops_vanish,
        turning_points_before={"c-material": 4.0},
        turning_points_beyond={"c-material": 2.0},
        loop_end={"c-material": 0.6412345},
    )
    assert found == {"before": 4.0, "beyond": 2.0}
    assert detail.endswith("ν_s = 0.6412")
    place = {"c-material": 0.2945, "c-material-5x": 0.6855}
    for measure, distance in ((fig5.loops_melt, 0.01), (fig6.corner_of_more_damped, 0.03)):
        found, detail = measured(measure, loop_place=place)
        assert found == pytest.approx(distance) and detail
    # The distance goes the short way round, and the switches are those of the contact ratio.
    found, _ = measured(fig5.loops_melt, loop_place={"c-material": 0.2845 - 1.01})
    assert found == pytest.approx(0.01)
    ends = {"c-material": 0.64, "c-material-5x": 0.61}
    found, detail = measured(fig6.loop_ends, loop_end=ends)
    assert found == {"k": 0.64, "5k": 0.61, "lead of 5k": pytest.approx(0.03)} and detail


@pytest.mark.parametrize(
    ("intervals", "nearest"),
    [
        ([[0.55, 0.60], [0.64, 0.7]], (0.55, 0.60)),
        ([[0.55, 0.57], [0.64, 0.7]], (0.64, 0.7)),
        ([[0.5, 0.55], [0.6, 0.62], [0.611, 0.7]], (0.6, 0.62)),
    ],
)
def test_the_interval_of_exceedance_is_the_nearest_one(measured, intervals, nearest):
    found, detail = measured(fig6.more_damped_exceeds, exceedance={"c-material-5x": intervals})
    assert (found["from"], found["to"]) == nearest and detail
    found, _ = measured(fig6.more_damped_exceeds, exceedance={"c-material-5x": []})
    assert math.isnan(found["from"]) and math.isnan(found["to"])


def sampled(pair, **fields):
    """Make up four mesh periods of 100 samples."""
    phase = np.arange(400) / 100 + 0.005
    double = np.abs(phase - np.round(phase)) < 0.2845
    made = {
        "time": (phase - pair.initial_phase) * 3.0,
        "y_rel": 1.0 + 0.1 * np.cos(2 * np.pi * phase),
        "stiffness": np.where(double, pair.mesh_stiffness_max, pair.stiffness_min),
        "regime": np.ones(phase.size, int),
        "force_friction": np.where(
            double, 0.1 * (phase % 1 < 0.5), np.where(phase % 1 < 0.5, 2.0, -2.0)
        ),
    } | fields
    if "a_rel" not in made:
        heavy = 1 + 2 * pair.reduced_mass / pair.body_mass
        made["a_rel"] = -heavy * made["stiffness"] / pair.stiffness_mean * made["y_rel"]
    data = {name: ("sample", value) for name, value in made.items()}
    return xr.Dataset(data | {"mesh_period": ((), 3.0)})


def test_corners_follow_their_definition(pair):
    """A jump is the change between two samples minus the mean of the changes around it."""
    plain = sampled(pair)
    bodies = pair.replace(body_mass=["20 kg", "60 kg"])
    mobility = {pair: 1 + 2 * pair.reduced_mass / pair.body_mass}
    mobility[bodies] = 1 + pair.reduced_mass / 20 + pair.reduced_mass / 60
    extra = np.zeros(400)
    extra[250:] = 0.4  # in the middle of single contact
    case = plain.assign(a_rel=plain["a_rel"] + extra)
    a, c, y = (case[name].values for name in ("a_rel", "stiffness", "y_rel"))
    switches = [i for i in range(1, 398) if c[i + 1] != c[i]]
    jump = {
        i: a[i + 1] - a[i] - 0.5 * (a[i] - a[i - 1] + a[i + 2] - a[i + 1]) for i in range(1, 398)
    }
    near = {i + d for i in switches for d in (-1, 0, 1)}
    for one, share in mobility.items():
        caused = {
            i: -share * (c[i + 1] - c[i]) / one.stiffness_mean * 0.5 * (y[i] + y[i + 1])
            for i in switches
        }
        ratio = sum(jump[i] * np.sign(caused[i]) for i in switches)
        ratio /= sum(abs(value) for value in caused.values())
        found = fig4.corners(case, Evidence(pair=one))
        assert found["at the switches"] == pytest.approx(ratio)
        greatest = max(abs(jump[i]) for i in jump if i not in near)
        median = np.median([abs(jump[i]) for i in switches])
        assert found["elsewhere"] == pytest.approx(greatest / median)
        assert found["elsewhere"] > 0.1


def test_corners_need_a_switch_and_a_place_elsewhere_in_mesh(pair):
    evidence = Evidence(pair=pair)
    for regime in (np.zeros(400, int), -np.ones(400, int)):
        assert all(
            math.isnan(v) for v in fig4.corners(sampled(pair, regime=regime), evidence).values()
        )
    # Meshing in the four samples around one switch only: nothing elsewhere.
    regime = np.zeros(400, int)
    regime[26:30] = 1
    found = fig4.corners(sampled(pair, regime=regime), evidence)
    assert math.isnan(found["at the switches"]) and math.isnan(found["elsewhere"])


def test_corners_of_the_three_frequencies(pair):
    case = sampled(pair)
    courses = {("c-lubricant", nu): case for nu in (0.60, 1.05, 1.20)}
    found, detail = fig4.phase_plane_corners(Evidence(pair=pair, time_courses=courses))
    assert [*found] == ["at the switches", "elsewhere"]
    assert [*found["elsewhere"]] == ["0.60", "1.05", "1.20"]
    assert detail


def of_both(case, other=None):
    return {("c-material", 0.61): case, ("c-material-5x", 0.61): case if other is None else other}


def test_friction_is_measured_within_double_contact(pair):
    case = sampled(pair)
    found, detail = fig7.friction_sense(Evidence(pair=pair, time_courses=of_both(case)))
    assert found["in double contact"]["c-material"] == pytest.approx(0.05)
    assert found["phase of the change"]["c-material-5x"] == pytest.approx(0.495)
    assert detail
    # The outermost samples of double contact do not count; the next ones do.
    force = case["force_friction"].values.copy()
    double = np.flatnonzero(case["stiffness"].values == pair.mesh_stiffness_max)
    edges = [i for i in double if not {i - 1, i + 1} <= {*double} and 0 < i < 399]
    force[edges] = 1.5
    case["force_friction"] = ("sample", force)
    found, _ = fig7.friction_sense(Evidence(pair=pair, time_courses=of_both(case)))
    assert found["in double contact"]["c-material"] == pytest.approx(0.05)
    # The first pulse ends with edges[0], and the second begins with edges[1].
    for next_one in (edges[0] - 1, edges[1] + 1):
        counted = force.copy()
        counted[next_one] = 1.0
        case["force_friction"] = ("sample", counted)
        found, _ = fig7.friction_sense(Evidence(pair=pair, time_courses=of_both(case)))
        assert found["in double contact"]["c-material"] == pytest.approx(0.5)
    case["force_friction"] = ("sample", np.zeros(400))
    found, _ = fig7.friction_sense(Evidence(pair=pair, time_courses=of_both(case)))
    assert math.isnan(found["in double contact"]["c-material"])
    assert math.isnan(found["phase of the change"]["c-material"])


def test_the_phase_counts_from_the_middle_of_the_pulse(pair):
    case = sampled(pair)
    for one in (pair, pair.replace(initial_phase=0.25)):
        expected = (case["time"].values / 3.0 + one.initial_phase) % 1.0
        found = fig7.mesh_phase(case, Evidence(pair=one))
        np.testing.assert_allclose(found, expected, atol=1e-12)


def test_jumps_of_acceleration_and_the_shift_of_phase(pair):
    one = sampled(pair)
    phase = np.arange(400) / 100 + 0.005
    other = sampled(pair, y_rel=np.cos(2 * np.pi * phase - np.radians(30.0)))
    evidence = Evidence(pair=pair, time_courses=of_both(one, other))
    found, detail = fig7.jumps_of_acceleration(evidence)
    expected = fig4.corners(other, evidence)["elsewhere"]
    assert found["elsewhere"]["c-material-5x"] == pytest.approx(expected) and detail
    found, detail = fig7.phase_shift(evidence)
    assert found["shift"] == pytest.approx(30.0)
    assert detail.endswith("c-material 0.0°, c-material-5x 30.0°")
    # The other way round, and beyond half a turn.
    found, _ = fig7.phase_shift(Evidence(pair=pair, time_courses=of_both(other, one)))
    assert found["shift"] == pytest.approx(30.0)
    far = sampled(pair, y_rel=np.cos(2 * np.pi * phase - np.radians(230.0)))
    found, _ = fig7.phase_shift(Evidence(pair=pair, time_courses=of_both(one, far)))
    assert found["shift"] == pytest.approx(130.0)


def test_the_height_of_a_loop_is_the_least_difference_of_neighbouring_extrema(pair):
    def case(extrema, turning):
        return xr.Dataset(
            {"extremum_y_rel": ("extremum", extrema), "turning_points_per_period": ((), turning)}
        )

    looped = case([1.0, 2.0, 1.75, 3.0], 4.0)
    assert fig7.loop_height(looped) == pytest.approx(0.25)
    assert fig7.loop_height(case([1.0, 2.0, 1.75], 3.0)) == pytest.approx(0.25)
    assert fig7.loop_height(case([1.0, 2.0, 1.75], 2.0)) == 0.0
    courses = of_both(looped, case([1.0, 2.0, 1.5], 4.0))
    courses = {key: value.assign(y_rel=("sample", [1.0])) for key, value in courses.items()}
    found, detail = fig7.loop_depends_on_damping(Evidence(pair=pair, time_courses=courses))
    assert found == {"5k to k": 2.0, "c-material": 0.25, "c-material-5x": 0.5} and detail


def test_evidence_is_found_by_name_and_by_frequency(pair):
    empty = xr.Dataset({"y_max": ((), 1.0)})
    full = sampled(pair)
    evidence = Evidence(
        pair=pair,
        thresholds={"there": {"a": [1.0, None, {"b": None}], "d": 2.0}},
        time_courses={("a", 0.6): empty, ("b", 0.61): full, ("a", 0.61): full},
    )
    assert evidence.time_course("a", 0.61 + 5e-10) is full
    for name, nu in (("a", 0.6), ("a", 0.61 + 2e-9), ("a", 0.61 - 2e-9), ("c", 0.61)):
        with pytest.raises(NotInStudy, match=f"time course of {name} at"):
            evidence.time_course(name, nu)
    found = evidence.located("there", iter(["a"]))
    assert found["a"][0] == 1.0 and math.isnan(found["a"][1]) and math.isnan(found["a"][2]["b"])
    with pytest.raises(NotInStudy, match="there of b, c"):
        evidence.located("there", ["a", "b", "c"])
    with pytest.raises(NotInStudy, match="elsewhere of a"):
        evidence.located("elsewhere", ["a"])
