"""Orbits and branches with units, and the messages if there are none."""

import dataclasses

import numpy as np
import pytest
import xarray as xr

import gearmesh as gm
from gearmesh.interface.parameters import static_deflection


@pytest.fixture(scope="module")
def pair():
    return gm.paper()


@pytest.fixture(scope="module")
def orbit(pair):
    return gm.find_orbit(pair, "c-material", 0.7)


@pytest.mark.parametrize("changes", [{}, {"teeth": [21, 22]}])
def test_the_certificate_of_an_orbit_is_public(pair, changes):
    """The orbit stays in normal mesh, so y_min is its margin, and the forces are those of a run."""
    stated = pair.replace(**changes)
    orbit = gm.find_orbit(stated, "c-material", 0.7)
    course = orbit.to_dataset()
    run = gm.simulate(stated, "c-material", 0.7, revolutions=20)
    least = float(run.force_min) / pair.static_force
    assert orbit.least_force == pytest.approx(least, abs=1e-5)
    assert orbit.multiplier_error < 1e-7
    if changes:
        assert np.isnan(orbit.extremum_margin)
    else:
        assert orbit.extremum_margin == pytest.approx(float(course.y_min_rel), abs=1e-12)


def test_a_long_run_ends_on_the_stable_orbit(pair, orbit):
    run = gm.simulate(pair, "c-material", 0.7, revolutions=60)
    found = orbit.to_dataset()
    assert orbit.stable and not orbit.neutral
    assert float(run.strobe_y_rel[-1]) == pytest.approx(float(found.strobe_y_rel), abs=1e-8)
    assert float(run.strobe_v_rel[-1]) == pytest.approx(float(found.strobe_v_rel), abs=1e-8)
    assert float(run.y_max_rel) == pytest.approx(float(found.y_max_rel), abs=1e-8)


def test_an_orbit_closes_and_has_units(pair, orbit):
    found = orbit.to_dataset(samples_per_period=64)
    assert orbit.residual < 1e-11
    assert orbit.signature == ("normal_mesh",)
    assert orbit.multipliers.dtype == complex
    assert found.y.attrs["units"] == "mm"
    assert float(found.y_max) == float(found.y_max_rel) * pair.static_deflection
    period = 2 * np.pi / (0.7 * pair.natural_frequency)
    assert float(found.time[-1]) == pytest.approx(period * 63 / 64)
    assert np.array_equal(found.y_rel[0], found.strobe_y_rel)


@pytest.mark.parametrize("kind", ["orbit", "branch"])
def test_a_dataset_with_complex_multipliers_is_written_and_read_again(orbit, kind, tmp_path):
    found = orbit if kind == "orbit" else gm.follow(orbit, "nu", (0.69, 0.71))
    dataset, how = found.to_dataset(), {"engine": "netcdf4", "auto_complex": True}
    dataset.to_netcdf(tmp_path / "found.nc", **how)
    with xr.open_dataset(tmp_path / "found.nc", **how) as again:
        assert again.identical(dataset)
        assert again.multipliers.dtype == complex


def test_a_branch_passes_its_special_points_in_order(orbit):
    branch = gm.follow(orbit, "nu", (0.6, 1.2))
    kinds = [point.kind for point in branch.special]
    assert kinds == ["switching", "grazing_front", "grazing_front"]
    assert branch.special[0].nu == pytest.approx(0.6386, abs=5e-5)
    found = branch.to_dataset()
    assert float(found.nu.min()) == pytest.approx(0.6)
    assert float(found.nu.max()) == pytest.approx(1.2)
    assert found.stable.all()


def test_what_a_special_point_holds_is_an_orbit_there(pair, orbit):
    point = gm.follow(orbit, "nu", (0.6, 0.7)).special[0]
    again = gm.find_orbit(pair, "c-material", point.nu, start=point.orbit)
    assert float(again.to_dataset().y_max_rel) == pytest.approx(
        float(point.orbit.to_dataset().y_max_rel), abs=1e-9
    )


@pytest.mark.parametrize(
    ("name", "limits", "low"),
    [
        ("backlash", ("7.9 y_st", "8.1 y_st"), 0.079),
        ("nu", ("3200 rpm", 0.71), None),
        ("inertia", ("0.0054 kg m^2", "0.0055 kg m^2"), 0.0054),
        ("damping_2m", ("3.9 N s/mm", "4 N s/mm"), 3.9),
    ],
)
def test_what_has_one_value_is_followed_between_limits_with_units(pair, orbit, name, limits, low):
    found = gm.follow(orbit, name, limits).to_dataset()
    low = 3200.0 / pair.resonance_speed if low is None else low
    assert float(found[name].min()) == pytest.approx(low, rel=1e-12)


def test_a_point_that_a_branch_does_not_have_is_one_line(orbit):
    branch = gm.follow(orbit, "nu", (0.69, 0.71))
    assert branch.at(np.int64(-1)).nu == pytest.approx(0.71)
    with pytest.raises(gm.InputError, match="point: found 1000000; allowed is a whole number"):
        branch.at(10**6)


def test_a_branch_is_resampled_at_values_with_units(pair, orbit):
    branch = gm.follow(orbit, "nu", (0.68, 0.72))
    speed = f"{0.69 * pair.resonance_speed!r} rpm"
    found = branch.resampled([0.71, speed, np.float64(0.7)]).to_dataset()
    assert found.nu.values.tolist() == pytest.approx([0.69, 0.7, 0.71], rel=1e-12)
    alone = gm.find_orbit(pair, orbit.variant.name, 0.69).to_dataset()
    assert float(found.y_max_rel[0]) == pytest.approx(float(alone.y_max_rel), abs=1e-11)
    assert branch.resampled(0.7).at(0).nu == 0.7
    with pytest.raises(gm.NoOrbit, match="none of the values of nu"):
        branch.resampled([0.5])
    for wrong, shown in (
        ("fast", "'fast'"),
        ([0.7, -1.0], "-1"),
        (["7 mm"], "'7 mm'"),
        ([True, 0.7], "True"),
        ([0.7, float("nan")], "nan"),
    ):
        with pytest.raises(gm.InputError, match=f"^nu: found {shown}"):
            branch.resampled(wrong)


def test_a_parameter_of_the_general_solver_is_resampled(pair):
    branch = gm.follow(gm.find_orbit(pair, "c-material", 0.62), "damping", (3.0, 6.0))
    found = branch.resampled(["4 N s/mm", 5.0])
    for point, value in enumerate((4.0, 5.0)):
        there = gm.find_orbit(pair.replace(damping=f"{value} N s/mm"), "c-material", 0.62)
        assert found.at(point).found.y_max == pytest.approx(there.found.y_max, abs=1e-10)


def test_a_parameter_with_a_unit_is_followed(pair):
    orbit = gm.find_orbit(pair, "c-material", 0.62)
    branch = gm.follow(orbit, "damping", ("3 N s/mm", "6 N s/mm"))
    found = branch.to_dataset()
    assert found.damping.attrs["units"] == "N*s/mm"
    assert float(found.damping.min()) == pytest.approx(3.0)
    middle = int(found.sizes["point"]) // 2
    there = pair.replace(damping=f"{float(found.damping[middle])!r} N s/mm")
    alone = gm.find_orbit(there, "c-material", 0.62)
    assert float(found.y_max_rel[middle]) == pytest.approx(
        float(alone.to_dataset().y_max_rel), abs=1e-9
    )


def test_lengths_follow_a_static_deflection_that_changes(pair):
    orbit = gm.find_orbit(pair, "c-material", 0.9)
    found = gm.follow(orbit, "static_deflection", ("10 um", "13 um")).to_dataset()
    expected = (found.y_max_rel * found.static_deflection).values
    np.testing.assert_allclose(found.y_max.values, expected, rtol=1e-12)


EDGES = {
    "friction_coefficient": (0.0, 0.1),
    "stiffness_ratio": (0.5, 1.0),
    "bearing_damping_ratio": (0.0, 0.1),
    "damping": (0.0, 5.0),
}
"""Ranges that reach to where a parameter has no meaning beyond."""


@pytest.mark.parametrize("name", EDGES)
def test_a_branch_reaches_its_limits_exactly(pair, name):
    low, high = EDGES[name]
    branch = gm.follow(gm.find_orbit(pair, "c-material", 0.9), name, (low, high))
    assert branch.ends == ("limit", "limit")
    assert branch.to_dataset()[name].values[[0, -1]].tolist() == [low, high]
    last = branch.at(-1)
    assert getattr(last.pair, name) == high
    alone = gm.find_orbit(last.pair, "c-material", 0.9)
    assert alone.found.y_max == pytest.approx(last.found.y_max, abs=1e-9)


def test_a_curve_of_special_points_reaches_its_limits_and_begins_inside_them(pair, orbit):
    point = gm.follow(orbit, "nu", (0.6, 0.7)).special[0]
    curve = gm.follow_special(point, ("nu", "friction_coefficient"), ((0.55, 0.7), (0.0, 0.05)))
    assert curve.found.ends == ("limit", "limit")
    assert curve.found.values[[0, -1], 1].tolist() == [0.0, 0.05]
    with pytest.raises(gm.NoOrbit, match="outside 1 to"):
        gm.follow_special(point, ("nu", "damping"), ((1.0, 1.2), (1.0, 5.0)))


def test_the_branch_of_twice_the_period_begins_at_a_flip(pair):
    branch = gm.follow(gm.find_orbit(pair, "c-lubricant", 0.7), "nu", (0.64, 0.72))
    flip = [point for point in branch.special if point.kind == "flip"][-1]
    doubled = gm.follow(flip.double_period(), "nu", (0.64, 0.72))
    assert doubled.orbit.periods == 2
    assert min(abs(point.nu - flip.nu) for point in doubled.special) < 1e-8
    fold = dataclasses.replace(flip, kind="fold")
    with pytest.raises(gm.InputError, match="only at a flip"):
        fold.double_period()


def test_the_end_of_the_loops_for_every_damping_is_one_curve(pair, orbit):
    point = gm.follow(orbit, "nu", (0.6, 0.7)).special[0]
    limits = ((0.55, 0.70), ("3.9 N s/mm", "19.7685 N s/mm"))
    curve = gm.follow_special(point, ("nu", "damping"), limits).to_dataset()
    # The ledger finds 0.6165 for five times the damping, after five revolutions.
    assert float(curve.nu[curve.damping.argmax("point")]) == pytest.approx(0.6165, abs=1e-4)


def test_an_orbit_in_contact_without_damping_is_neutral(pair):
    orbit = gm.find_orbit(pair, "c-lubricant", 1.15)
    assert orbit.neutral
    assert not orbit.stable


def test_an_orbit_that_is_not_there_says_why(pair):
    with pytest.raises(
        gm.NoOrbit, match=r"no orbit of period 2 at nu = 0\.7: .* leads to an orbit of period 1"
    ):
        gm.find_orbit(pair, "c-material", 0.7, periods=2, start=(1.0, 0.0))
    with pytest.raises(gm.NoOrbit, match="after 21 mesh periods"):
        gm.find_orbit(pair.replace(eccentricity="10 um"), "c-material", 0.7)


WRONG = {
    "periods": lambda pair, orbit: gm.find_orbit(pair, "c-material", 0.7, periods=0),
    "variant": lambda pair, orbit: gm.find_orbit(pair, "c-mterial", 0.7),
    "parameter": lambda pair, orbit: gm.follow(orbit, "backlsh", (0, 1)),
    "parameter of many numbers": lambda pair, orbit: gm.follow(orbit, "profile_deviation", (0, 1)),
    "whole number": lambda pair, orbit: gm.follow(orbit, "teeth", (10, 30)),
    "pair": lambda pair, orbit: gm.find_orbit("paper", "c-material", 0.7),
    "nu in a list": lambda pair, orbit: gm.find_orbit(pair, "c-material", [0.66]),
    "a run as a start": lambda pair, orbit: gm.find_orbit(
        pair, "c-material", 0.7, start=orbit.to_dataset()
    ),
    "an orbit as the start of a run": lambda pair, orbit: gm.simulate(
        pair, "c-material", 0.7, start=orbit
    ),
    "no orbit": lambda pair, orbit: gm.follow(None, "nu", (0.6, 0.7)),
    "a list of names": lambda pair, orbit: gm.follow(orbit, ["nu"], (0.6, 0.7)),
    "endless": lambda pair, orbit: gm.follow(orbit, "nu", (-np.inf, np.inf)),
    "no limits": lambda pair, orbit: gm.follow(orbit, "nu", None),
    "limit None": lambda pair, orbit: gm.follow(orbit, "nu", (None, 1)),
    "one limit": lambda pair, orbit: gm.follow(orbit, "nu", (0.6,)),
    "limit below 0": lambda pair, orbit: gm.follow(orbit, "damping", (-1, 10)),
    "an open parameter": lambda pair, orbit: gm.follow(orbit, "final_speed", (1, 10)),
    "no samples": lambda pair, orbit: orbit.to_dataset(0),
    "samples below 0": lambda pair, orbit: orbit.to_dataset(-3),
    "half a sample": lambda pair, orbit: orbit.to_dataset(2.5),
    "an orbit as a special point": lambda pair, orbit: gm.follow_special(
        orbit, ("nu", "damping"), ((0.6, 0.7), (1, 10))
    ),
    "limits": lambda pair, orbit: gm.follow(orbit, "nu", (1.2, 0.6)),
    "limits that are almost one": lambda pair, orbit: gm.follow(orbit, "nu", (0.7, 0.7 + 1e-14)),
    "no values": lambda pair, orbit: gm.follow(orbit, "nu", (0.6, 0.8)).resampled([]),
    "limit in kg": lambda pair, orbit: gm.follow(orbit, "backlash", ("1 kg", "2 kg")),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_argument_is_one_line(pair, orbit, name):
    with pytest.raises(gm.InputError) as caught:
        WRONG[name](pair, orbit)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize(
    ("names", "limits"),
    [
        (("nu",), ((0.6, 0.7),)),
        (("nu", "damping", "backlash"), ((0.6, 0.7), (1, 10), (0.01, 0.1))),
        ("nu", ((0.6, 0.7), (1, 10))),
        (("nu", "nu"), ((0.6, 0.7), (0.6, 0.7))),
        (("nu", "damping"), ((0.6, 0.7),)),
        (("nu", "damping"), None),
        (("nu", "damping"), ((0.6, 0.7), None)),
    ],
)
def test_wrong_parameters_of_a_curve_are_one_line(orbit, names, limits):
    point = gm.SpecialPoint("fold", 0.7, {"nu": 0.7}, orbit)
    with pytest.raises(gm.InputError, match=r"found .*; allowed ") as caught:
        gm.follow_special(point, names, limits)
    assert "\n" not in str(caught.value)


def test_a_curve_on_which_nothing_changes_with_a_parameter_is_not_closed(pair):
    """In static deflections no motion depends on the torque, so nu never changes."""
    branch = gm.follow(gm.find_orbit(pair, "c-lubricant", 0.7), "nu", (0.7, 0.9))
    fold = next(point for point in branch.special if point.kind == "fold")
    curve = gm.follow_special(fold, ("nu", "torque"), ((0.4, 1.4), ("30 N m", "300 N m")))
    assert curve.found.ends == ("limit", "limit")
    found = curve.to_dataset()
    assert found.torque.values[[0, -1]].tolist() == [30.0, 300.0]
    assert np.ptp(found.nu.values) < 1e-9
    np.testing.assert_allclose((found.y_max / found.torque).values, found.y_max[0] / 30.0)


def test_lengths_change_also_if_both_ends_have_the_static_deflection_of_the_pair(pair):
    at_ends = np.array([[1.0], [1.1], [1.0]]) * pair.torque
    found = static_deflection(pair, ("torque",), at_ends)
    np.testing.assert_allclose(found, pair.static_deflection * np.array([1.0, 1.1, 1.0]))
    assert static_deflection(pair, ("torque",), at_ends[[0, 2]]) == pair.static_deflection


@pytest.mark.parametrize(
    ("name", "limits"), [("restoring_3", (0.0, 0.2)), ("restoring_power", (1.0, 1.2))]
)
def test_a_term_that_appears_on_the_way_acts(pair, orbit, name, limits):
    """The orbit is one of the reduced system, which does not have these terms."""
    branch = gm.follow(orbit, name, limits)
    assert branch.ends == ("limit", "limit")
    last = branch.at(-1)
    alone = gm.find_orbit(last.pair, "c-material", 0.7)
    assert last.found.y_max == pytest.approx(alone.found.y_max, abs=1e-9)
    assert abs(last.found.y_max - orbit.found.y_max) > 0.01


def test_a_curve_in_two_parameters_feels_a_term_that_appears(pair):
    branch = gm.follow(gm.find_orbit(pair, "c-lubricant", 0.7), "nu", (0.64, 0.72))
    flip = next(point for point in branch.special if point.kind == "flip")
    curve = gm.follow_special(flip, ("nu", "restoring_3"), ((0.6, 0.72), (0.0, 0.01)))
    assert curve.found.ends == ("limit", "limit")
    nu, last = curve.found.values[-1]
    stiffer = gm.find_orbit(pair.replace(restoring_3=float(last)), "c-lubricant", nu - 0.005)
    beside = gm.follow(stiffer, "nu", (nu - 0.01, nu + 0.005))
    assert [point.nu for point in beside.special] == pytest.approx([nu], abs=1e-8)


def test_a_term_that_needs_other_coordinates_is_said(pair, orbit):
    with pytest.raises(gm.NoOrbit, match="other coordinates are needed"):
        gm.follow(orbit, "eccentricity", ("0 um", "10 um"))


@pytest.mark.parametrize(("variant", "nu"), [("b-material", 0.8), ("c-lubricant", 0.9)])
def test_switches_move_across_the_initial_phase(pair, variant, nu):
    """The initial phase of the paper's pair is a switch of C(t), which the contact ratio moves."""
    branch = gm.follow(gm.find_orbit(pair, variant, nu), "contact_ratio", (1.3, 1.9))
    assert branch.ends == ("limit", "limit")
    for point in (0, -1):
        there = branch.at(point)
        alone = gm.find_orbit(there.pair, variant, nu, start=there)
        assert there.found.y_max == pytest.approx(alone.found.y_max, abs=1e-9)


def test_a_grazing_at_which_the_branch_bends_sharply_is_located(pair):
    """Polynomials across the grazing miss by more than the corrector may move a point."""
    branch = gm.follow(gm.find_orbit(pair, "c-material", 0.9), "backlash", ("2 um", "100 um"))
    (point,) = branch.special
    assert point.kind == "grazing_back"
    assert point.parameters["backlash"] == pytest.approx(-float(point.orbit.found.y_min) * 0.01)
