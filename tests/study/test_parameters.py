"""Printed, derived and assumed parameters, and the problem that they state."""

import dataclasses
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.errors import InputError
from gearmesh.model.variants import VARIANTS, variant
from gearmesh.study.pair import DERIVATIONS, KG_PER_N_S2_MM, KINDS, Parameters, rows

NU_OF_THE_TEXT = 0.66


def test_p1_stiffnesses(parameters):
    assert f"{parameters.stiffness_mean:.5e}" == "3.28954e+05"
    assert f"{parameters.stiffness_min:.4e}" == "2.3516e+05"


def test_p2_damping_ratio_is_the_printed_one_only_with_the_mean_stiffness(parameters):
    assert f"{parameters.damping_ratio:.5f}" == "0.06168"
    assert f"{parameters.damping_ratio:.3f}" == "0.062"
    mass = parameters.reduced_mass / KG_PER_N_S2_MM
    others = (parameters.mesh_stiffness_max, parameters.stiffness_min)
    ratios = [parameters.damping / (2 * math.sqrt(c * mass)) for c in others]
    assert [f"{ratio:.3f}" for ratio in ratios] == ["0.056", "0.073"]


def test_p2_five_times_the_damping(parameters):
    assert f"{5 * parameters.damping:.4f}" == "19.7685"
    assert f"{5 * parameters.damping_ratio:.4f}" == "0.3084"
    assert f"{5 * parameters.damping_ratio:.2f}" == "0.31"


def test_p3_natural_frequency(parameters):
    assert f"{parameters.natural_frequency:.4e}" == "1.0263e+04"
    assert f"{parameters.natural_frequency / (2 * math.pi):.0f}" == "1633"


def test_p4_tunings_to_the_extreme_stiffnesses(parameters):
    assert f"{NU_OF_THE_TEXT * parameters.tuning_min:.4f}" == "0.7806"
    assert f"{NU_OF_THE_TEXT * parameters.tuning_max:.4f}" == "0.5985"


def test_p5_resonance_at_the_least_stiffness(parameters):
    assert f"{1 / parameters.tuning_min:.4f}" == "0.8455"


def test_p6_pressure_angle_gives_the_printed_contact_ratio(parameters):
    """A pair of equal standard wheels, whose addendum is one module."""
    angle, teeth = parameters.pressure_angle, parameters.teeth
    pitch_radius, tip_radius = teeth / 2, teeth / 2 + 1  # in modules
    base_radius = pitch_radius * math.cos(angle)
    path = 2 * (math.sqrt(tip_radius**2 - base_radius**2) - pitch_radius * math.sin(angle))
    contact_ratio = path / (math.pi * math.cos(angle))
    assert f"{contact_ratio:.4f}" == "1.5691"
    assert f"{contact_ratio:.3f}" == f"{parameters.contact_ratio:.3f}"
    assert f"{parameters.base_radius / parameters.module:.4f}" == "9.8668"


def test_the_misprinted_mass_unit_contradicts_the_printed_damping(parameters):
    """3.123e-3 taken as kg would make D 32 times the printed 0.062."""
    light = parameters.replace({"printed.reduced_mass": "3.123e-3 kg"})
    assert light.damping_ratio == pytest.approx(math.sqrt(1000) * parameters.damping_ratio)


CONTRACT = """
    printed.contact_ratio printed.stiffness_ratio printed.mesh_stiffness_max printed.reduced_mass
    printed.teeth printed.damping assumed.static_deflection assumed.backlash
    assumed.damping_length assumed.body_mass assumed.bearing_stiffness
    assumed.bearing_damping_ratio assumed.friction_coefficient assumed.eccentricity_3
    assumed.eccentricity_2 assumed.eccentricity_angle assumed.module assumed.initial_phase
    run.revolutions run.kept_revolutions solver.tolerance
"""


def test_every_parameter_says_what_it_is():
    found = [row for section in KINDS for row in rows(section)]
    assert set(CONTRACT.split()) <= {f"{row.section}.{row.name}" for row in found}
    assert all(row.symbol and row.unit and row.description for row in found)
    assert len({row.symbol for row in found}) == len(found)


def test_derivations_are_finite_and_positive(parameters):
    assert all(0 < item.value(parameters) < math.inf for item in DERIVATIONS)


def test_values_written_with_units_are_read_back(parameters):
    changes = {
        "assumed.eccentricity_angle": "33.3 deg",
        "assumed.profile_deviation": [["1 um", "0 um"], ["0.1 um", "-0.3 um"]],
    }
    changed = parameters.replace(changes)
    assert changed != parameters
    assert Parameters.model_validate(changed.texts()) == changed


@given(
    st.floats(1e-5, 4.0).map(lambda x: float(f"{x:.12g}")),
    st.sampled_from(["backlash", "static_deflection", "eccentricity_3"]),
)
def test_the_digest_sees_values_not_units(parameters, value, name):
    key = f"assumed.{name}"
    in_mm = parameters.replace({key: f"{value!r} mm"})
    in_um = parameters.replace({key: f"{value * 1e3:.12g} um"})
    other = parameters.replace({key: f"{value * (1 + 1e-9):.12g} mm"})
    assert in_mm.digest() == in_um.digest() != other.digest()


def test_replace_names_the_key(parameters):
    with pytest.raises(InputError, match=r"assumed\.backlsh: unknown key .*backlash"):
        parameters.replace({"assumed.backlsh": "40 um"})
    with pytest.raises(InputError, match=r"assumed\.backlash: found '4 kg'"):
        parameters.replace({"assumed.backlash": "4 kg"})
    with pytest.raises(InputError, match="tooth: unknown key"):
        parameters.replace({"tooth.count": 3})


KNOWN = {
    "assumed.static_deflection": "10 um",
    "assumed.backlash": "40 um",
    "assumed.damping_length": "5 um",
    "assumed.body_mass": "31.23 kg",
    "assumed.bearing_stiffness": "328953.96 N/mm",
    "assumed.eccentricity_3": "20 um",
    "assumed.module": "3 mm",
    "assumed.profile_deviation": [["1 um", "-2 um"]],
    "assumed.initial_phase": 0.25,
    "run.revolutions": 7,
}


def test_problem_is_dimensionless(parameters):
    problem = parameters.replace(KNOWN).problem(variant("g-both"), 0.66)
    ratio = 2 * parameters.damping_ratio
    assert problem.nu == 0.66
    assert problem.stiffness_min / problem.stiffness_max == pytest.approx(0.5879)
    assert 0.569 * problem.stiffness_max + 0.431 * problem.stiffness_min == pytest.approx(1.0)
    assert problem.material == pytest.approx((ratio, 2 * ratio, 4 * ratio))
    assert problem.lubricant == problem.material
    assert problem.backlash == pytest.approx(4.0)
    assert problem.body_mass == pytest.approx(10.0)
    assert problem.bearing_stiffness == pytest.approx(1.0)
    assert problem.eccentricity_3 == pytest.approx(2.0)
    assert problem.base_radius == pytest.approx(9.8668 * 300, rel=1e-5)
    assert problem.deviation == (pytest.approx((0.1, -0.2)),)
    assert (problem.initial_phase, problem.revolutions) == (0.25, 7)


@pytest.mark.parametrize("name", VARIANTS)
def test_problem_damps_where_the_variant_says(parameters, name):
    chosen = variant(name)
    problem = parameters.problem(chosen, 1.0)
    assert tuple(k > 0 for k in problem.material) == chosen.material_powers
    assert tuple(k > 0 for k in problem.lubricant) == chosen.lubricant_powers


def test_factor_multiplies_all_damping(parameters):
    single = parameters.problem(variant("c-material"), 0.61)
    strong = parameters.problem(variant("c-material-5x"), 0.61)
    assert strong.material == pytest.approx(tuple(5 * k for k in single.material))
    assert dataclasses.replace(strong, material=single.material) == single


def test_length_unit_cancels(parameters):
    """Everything that is a length ten times as large states the same problem."""
    lengths = [
        "static_deflection", "backlash", "damping_length",
        "eccentricity_3", "eccentricity_2", "module",
    ]  # fmt: skip
    assumed = parameters.replace({"assumed.eccentricity_2": "3 um"}).assumed
    scaled = {f"assumed.{name}": f"{10 * getattr(assumed, name)!r} mm" for name in lengths}
    one = parameters.replace({"assumed.eccentricity_2": "3 um"}).problem(variant("d-both"), 0.7)
    ten = parameters.replace(scaled).problem(variant("d-both"), 0.7)
    for field in dataclasses.fields(one):
        assert getattr(ten, field.name) == pytest.approx(getattr(one, field.name))
