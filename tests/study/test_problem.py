"""The dimensionless problem that a pair states for one variant and frequency."""

import dataclasses
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.errors import InputError
from gearmesh.model.mesh import mesh_stiffness
from gearmesh.model.variants import VARIANTS, variant
from gearmesh.solvers.simulation import simulate

EACH = ("damping_1", "damping_2", "damping_3", "damping_1m", "damping_2m", "damping_3m")

KNOWN = {
    "static_deflection": "10 um",
    "backlash": "40 um",
    "damping_length": "5 um",
    "body_mass": "31.23 kg",
    "bearing_stiffness": "328953.96 N/mm",
    "eccentricity": ["20 um", "0 um"],
    "module": "3 mm",
    "profile_deviation": [["1 um", "-2 um"]],
    "initial_phase": 0.25,
    "revolutions": 7,
}


def test_the_problem_is_dimensionless(pair):
    problem = pair.replace(**KNOWN).problem(variant("g-both"), 0.66)
    ratio = 2 * pair.damping_ratio
    assert problem.nu == 0.66
    assert problem.stiffness_min / problem.stiffness_max == pytest.approx(0.5879)
    assert 0.569 * problem.stiffness_max + 0.431 * problem.stiffness_min == pytest.approx(1.0)
    assert problem.material == pytest.approx((ratio, 2 * ratio, 4 * ratio))
    assert problem.lubricant == problem.material
    assert problem.backlash == pytest.approx(4.0)
    assert problem.body_mass == pytest.approx(10.0)
    assert problem.bearing_stiffness == pytest.approx(1.0)
    assert (problem.eccentricity_3, problem.eccentricity_2) == (pytest.approx(2.0), 0.0)
    assert problem.base_radius == pytest.approx(9.8668 * 300, rel=1e-5)
    assert problem.deviation == (pytest.approx((0.1, -0.2)),)
    assert (problem.initial_phase, problem.revolutions) == (0.25, 7)


@pytest.mark.parametrize("name", VARIANTS)
def test_the_problem_is_damped_where_the_variant_says(pair, name):
    chosen = variant(name)
    problem = pair.problem(chosen, 1.0)
    assert tuple(k > 0 for k in problem.material) == chosen.material_powers
    assert tuple(k > 0 for k in problem.lubricant) == chosen.lubricant_powers


def test_a_factor_multiplies_all_damping(pair):
    single = pair.problem(variant("c-material"), 0.61)
    strong = pair.problem(variant("c-material-5x"), 0.61)
    assert strong.material == pytest.approx(tuple(5 * k for k in single.material))
    assert dataclasses.replace(strong, material=single.material) == single


@pytest.mark.parametrize("name", VARIANTS)
def test_each_damping_is_the_common_one_unless_it_is_stated(pair, name):
    """Bit for bit: a stated k_i that equals k changes no result."""
    each = pair.replace(**dict.fromkeys(EACH, f"{pair.damping!r} N s/mm"))
    assert each.problem(variant(name), 0.66) == pair.problem(variant(name), 0.66)


@pytest.mark.parametrize("name", EACH)
def test_a_damping_of_its_own_changes_one_term_only(pair, name):
    common = pair.problem(variant("g-both"), 0.66)
    changed = pair.replace(**{name: f"{2 * pair.damping!r} N s/mm"}).problem(
        variant("g-both"), 0.66
    )
    law = "lubricant" if name.endswith("m") else "material"
    place = int(name.removeprefix("damping_").removesuffix("m")) - 1
    expected = list(getattr(common, law))
    expected[place] *= 2
    assert getattr(changed, law) == pytest.approx(tuple(expected), rel=1e-15)
    assert dataclasses.replace(changed, **{law: getattr(common, law)}) == common


def test_a_damping_of_its_own_may_be_zero_and_does_not_act_where_the_variant_has_none(pair):
    changed = pair.replace(damping_1="0 N s/mm", damping_1m="9 N s/mm")
    problem = changed.problem(variant("b-material"), 0.66)
    assert (problem.material, problem.lubricant) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def test_one_eccentricity_serves_both_wheels(pair):
    assert pair.replace(eccentricity="3 um").eccentricity == (0.003, 0.003)
    assert pair.replace(eccentricity=["3 um", "4 um"]).eccentricity == (0.003, 0.004)
    problem = pair.replace(eccentricity=["3 um", "4 um"]).problem(variant("b-both"), 0.66)
    assert (problem.eccentricity_3, problem.eccentricity_2) == pytest.approx((0.3, 0.4))


@pytest.mark.parametrize("value", [[], ["1 um"], ["1 um"] * 3, [["1 um", "1 um"], "1 um"]])
def test_another_number_of_eccentricities_is_refused(pair, value):
    with pytest.raises(InputError) as caught:
        pair.replace(eccentricity=value)
    count = f"a list of {len(value)}" if value else "an empty list"
    assert str(caught.value) == (
        f"eccentricity: found {count}; allowed is one value, or two for wheels 3 and 2"
    )


def test_a_run_starts_in_static_equilibrium_unless_another_start_is_stated(pair):
    assert pair.problem(variant("b-both"), 0.7).initial_state is None
    at_rest = pair.replace(initial_velocity="0 mm")
    assert at_rest.problem(variant("b-both"), 0.7).initial_state is None
    moved = pair.replace(initial_displacement="1.5 y_st", initial_velocity="-0.4 y_st")
    (response,) = simulate([moved.problem(variant("b-both"), 0.7)], moved.tolerance)
    assert response.strobe_y[0] == pytest.approx(1.5)
    assert response.strobe_v[0] == pytest.approx(-0.4)


def test_a_velocity_alone_starts_from_the_static_deflection(pair):
    moved = pair.replace(initial_velocity="0.4 y_st").problem(variant("b-material"), 0.7)
    (response,) = simulate([moved], pair.tolerance)
    assert response.strobe_y[0] == pytest.approx(1.0)
    assert response.strobe_v[0] == pytest.approx(0.4)


@pytest.mark.parametrize("name", ["d-both", "g-lubricant"])
def test_a_start_that_is_stated_as_static_equilibrium_is_it(pair, name):
    stated = pair.replace(initial_displacement="1 y_st")
    one, other = (p.problem(variant(name), 0.7) for p in (pair, stated))
    assert other.initial_state is not None
    first, second = (simulate([p], pair.tolerance)[0] for p in (one, other))
    assert second.y_max == pytest.approx(first.y_max, rel=1e-6)


LENGTHS = ("static_deflection", "backlash", "damping_length", "module")


@given(st.floats(0.1, 10.0))
def test_the_unit_of_length_cancels(pair, factor):
    """Lengths that are all multiplied by one factor state the same problem."""
    one = pair.replace(eccentricity=["0 um", "3 um"])
    changes = {name: f"{factor * getattr(one, name)!r} mm" for name in LENGTHS}
    many = one.replace(**changes, eccentricity=["0 um", f"{3 * factor!r} um"])
    problems = [p.problem(variant("d-both"), 0.7) for p in (one, many)]
    for field in dataclasses.fields(problems[0]):
        first, second = (getattr(problem, field.name) for problem in problems)
        assert second == pytest.approx(first), field.name


def test_two_wheels_and_every_term_reach_the_problem(pair):
    c_s = pair.stiffness_mean
    radii = pair.base_radii
    stated = pair.replace(
        teeth=[20, 40],
        body_mass=["2 kg", "5 kg"],
        bearing_stiffness_z=["1 C_s", "2 C_s"],
        torsional_damping=["1 N*m*s/rad", "2 N*m*s/rad"],
        torque_harmonics=[
            {"wheel": 3, "order": 1, "cos": 0.1},
            {"wheel": 2, "shaft": 2, "sin": 0.2},
        ],
        tooth_factors=[{"wheel": 2, "tooth": 3, "factor": 0.5}],
        backlash_harmonics=[{"wheel": 3, "shaft": 1, "cos": "2 um"}],
        restoring_3=0.1,
        restoring_fourier=[[0.2, 0.0], [0.0, 0.1]],
        non_adhesive=True,
        damping_follows_stiffness="sqrt",
        stiffness_fourier=[[0.1, 0.2]],
    )
    problem = stated.problem(variant("c-both"), 0.7)
    wheel_3, wheel_2 = problem.wheels
    assert (wheel_3.teeth, wheel_2.teeth) == (20, 40)
    assert wheel_2.base_radius == pytest.approx(2.0 * wheel_3.base_radius)
    assert (wheel_3.inertia, wheel_2.inertia) == (2.0, 2.0)
    assert wheel_2.body_mass == pytest.approx(5.0 / pair.reduced_mass)
    assert wheel_2.bearing_stiffness[1] == pytest.approx(2.0)
    assert wheel_3.bearing_stiffness[0] == pytest.approx(pair.bearing_stiffness / c_s)
    terms = problem.terms
    assert terms.torque_harmonics_3 == ((1.0, 0.1, 0.0),)
    assert terms.torque_harmonics_2 == ((2.0 / 40, 0.0, 0.2),)
    assert terms.tooth_factors == ((2, 3, 0.5),)
    assert terms.backlash_harmonics[0].cosine == pytest.approx(2e-3 / pair.static_deflection)
    assert terms.backlash_harmonics[0].order == 1.0 / 20
    assert terms.restoring_fourier == ((0.2, 0.0), (0.0, 0.1))
    assert (terms.restoring_3, terms.non_adhesive, terms.damping_power) == (0.1, True, 0.5)
    # Force of a damper of the rotation on the base circle, in N s/mm, over C_s / Omega_s.
    damper = 1000.0 / stated.base_radii[0] ** 2
    assert terms.torsional_damping[0] == pytest.approx(damper * pair.natural_frequency / c_s)
    assert problem.periods == 5 * 20
    assert radii[0] == radii[1]


def test_tables_set_the_static_stiffness(pair):
    table = pair.replace(stiffness_table=["3e5 N/mm", "4e5 N/mm", "3.5e5 N/mm", "2e5 N/mm"])
    assert table.stiffness_mean == pytest.approx(3.125e5)
    tooth_pair = pair.replace(tooth_pair_stiffness=["1e5 N/mm", "3e5 N/mm", "1e5 N/mm"])
    assert tooth_pair.stiffness_mean == pytest.approx(pair.contact_ratio * 2e5)
    problem = tooth_pair.problem(variant("c-both"), 0.7)
    phases = np.linspace(0.0, 1.0, 4001)
    mean = np.mean([mesh_stiffness(problem, phase) for phase in phases[:-1]])
    assert mean == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"torque_harmonics": [{"cos": 0.1}]}, "order: found none of order and shaft"),
        ({"stiffness_table": ["1 N/mm"]}, "two values or more"),
        (
            {"stiffness_fourier": [[0.1, 0.0]], "stiffness_harmonics": 3},
            "stiffness_fourier: stated beside stiffness_harmonics",
        ),
        ({"tooth_factors": [{"tooth": 1}]}, "factor: missing"),
        ({"damping_follows_stiffness": "cubic"}, "allowed is 'none', 'sqrt' or 'linear'"),
    ],
)
def test_a_wrong_term_is_reported_in_one_line(pair, changes, message):
    with pytest.raises(InputError, match=re.escape(message)):
        pair.replace(**changes)
