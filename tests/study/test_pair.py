"""The pair: its parameters, what follows from them, and where their values come from."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.errors import InputError
from gearmesh.study.alternatives import KG_PER_N_S2_MM
from gearmesh.study.derived import derived
from gearmesh.study.loading import load_study
from gearmesh.study.pair import Pair

NU_OF_THE_TEXT = 0.66


def listed(pair):
    return {parameter.name: parameter for parameter in pair.parameters}


def test_the_stiffnesses_are_those_of_the_paper(pair):
    assert f"{pair.stiffness_mean:.5e}" == "3.28954e+05"
    assert f"{pair.stiffness_min:.4e}" == "2.3516e+05"


def test_only_the_mean_stiffness_gives_the_printed_damping_ratio(pair):
    assert f"{pair.damping_ratio:.5f}" == "0.06168"
    assert f"{pair.damping_ratio:.3f}" == "0.062"
    mass = pair.reduced_mass / KG_PER_N_S2_MM
    others = (pair.mesh_stiffness_max, pair.stiffness_min)
    ratios = [pair.damping / (2 * math.sqrt(c * mass)) for c in others]
    assert [f"{ratio:.3f}" for ratio in ratios] == ["0.056", "0.073"]


def test_five_times_the_damping_has_the_printed_ratio(pair):
    assert f"{5 * pair.damping:.4f}" == "19.7685"
    assert f"{5 * pair.damping_ratio:.4f}" == "0.3084"
    assert f"{5 * pair.damping_ratio:.2f}" == "0.31"


def test_the_natural_frequency_follows_from_the_mean_stiffness(pair):
    assert f"{pair.natural_frequency:.4e}" == "1.0263e+04"
    assert f"{pair.natural_frequency / (2 * math.pi):.0f}" == "1633"


def test_the_frequencies_relative_to_the_two_stiffnesses_are_the_printed_ones(pair):
    assert f"{NU_OF_THE_TEXT * pair.nu_min_ratio:.4f}" == "0.7806"
    assert f"{NU_OF_THE_TEXT * pair.nu_max_ratio:.4f}" == "0.5985"
    assert f"{1 / pair.nu_min_ratio:.4f}" == "0.8455"


def test_the_pressure_angle_gives_the_printed_contact_ratio(pair):
    assert f"{pair.standard_contact_ratio:.4f}" == "1.5691"
    assert f"{pair.standard_contact_ratio:.3f}" == f"{pair.contact_ratio:.3f}"
    assert f"{pair.base_radius / pair.module:.4f}" == "9.8668"


def test_the_printed_unit_of_the_mass_contradicts_the_printed_damping(pair):
    """Taken as kg, 3.123e-3 makes D 32 times the printed 0.062."""
    light = pair.replace(reduced_mass="3.123e-3 kg")
    assert light.damping_ratio == pytest.approx(math.sqrt(1000) * pair.damping_ratio)


def test_everything_that_follows_is_finite_and_positive(pair):
    values = [value for item in derived(pair) for value in np.ravel(item.value(pair))]
    assert all(0 < value < math.inf for value in values)


CONTRACT = """
    contact_ratio stiffness_ratio mesh_stiffness_max teeth reduced_mass damping damping_1 damping_2
    damping_3 damping_1m damping_2m damping_3m static_deflection backlash damping_length body_mass
    bearing_stiffness bearing_damping_ratio friction_coefficient eccentricity eccentricity_angle
    module pressure_angle profile_deviation stiffness_harmonics initial_phase revolutions
    kept_revolutions tolerance
"""
"""Names that others rely on."""


def test_every_parameter_has_a_name_symbol_unit_and_description(pair):
    parameters = pair.parameters
    assert set(CONTRACT.split()) <= {parameter.name for parameter in parameters}
    assert all(p.symbol and p.unit and p.description and p.kind for p in parameters)
    assert len({p.symbol for p in parameters}) == len(parameters)
    assert [getattr(pair, p.name) for p in parameters] == [p.value for p in parameters]


def test_parameters_stand_in_the_same_order_however_the_file_orders_them(pair):
    shuffled = Pair.from_statements(dict(reversed(pair._statements.items())))
    assert shuffled.parameters == pair.parameters
    assert shuffled.digest() == pair.digest()


def test_the_paper_says_of_each_value_where_it_comes_from(pair):
    parameters = listed(pair)
    kinds = {name: parameter.kind for name, parameter in parameters.items()}
    assert {name for name, kind in kinds.items() if kind == "printed"} == {
        *("contact_ratio", "stiffness_ratio", "mesh_stiffness_max"),
        *("reduced_mass", "teeth", "damping"),
    }
    assert [name for name, kind in kinds.items() if kind == "derived"] == ["pressure_angle"]
    assert set(kinds.values()) == {"printed", "derived", "assumed", "default", "setting"}
    for parameter in parameters.values():
        has_reason = parameter.kind in ("printed", "derived", "assumed")
        assert bool(parameter.reason) == has_reason, parameter


def test_a_replaced_value_is_stated_and_all_others_keep_their_kind(pair):
    before, after = listed(pair), listed(pair.replace(backlash="40 um", teeth=24))
    changed = {name for name in before if before[name] != after[name]}
    assert changed == {"backlash", "teeth"}
    assert (after["backlash"].value, after["backlash"].kind) == (0.04, "stated")
    assert (after["backlash"].reason, after["teeth"].value) == ("", 24)


def test_a_pair_cannot_be_changed_in_place(pair):
    with pytest.raises(ValueError, match="frozen"):
        pair.backlash = 1.0
    backlash = pair.backlash
    pair.replace(backlash="1 mm")
    assert pair.backlash == backlash


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"backlsh": "40 um"}, "backlsh: unknown key (did you mean 'backlash'?)"),
        ({"torqe": "40 N m"}, "torqe: unknown key (did you mean 'torque'?)"),
        ({"xyz": 1}, "xyz: unknown key; 'gearmesh parameters' lists all parameters"),
        ({"backlash": "4 kg"}, "backlash: found '4 kg'; unit 'kg' is of another kind"),
        ({"backlash": 0.04}, "backlash: found 0.04; unit missing; expected: a length"),
        ({"teeth": 2}, "teeth: found 2; out of range; allowed is 3 to 1000"),
        ({"contact_ratio": None}, "contact_ratio: found nothing"),
        ({"kept_revolutions": 6}, "kept_revolutions: found 6; allowed are at most the 5"),
        (
            {"revolutions": 40, "kept_revolutions": 40, "teeth": 1000, "samples_per_period": 256},
            "kept_revolutions: found 40, which makes 10240000 samples (teeth × samples_per_period",
        ),
        ({"static_deflection": None}, "static_deflection: missing; backlash is stated in y_st"),
    ],
)
def test_a_wrong_replacement_is_reported_in_one_line(pair, changes, message):
    with pytest.raises(InputError) as caught:
        pair.replace(**changes)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


def test_values_follow_a_replaced_reference(pair):
    thicker = pair.replace(static_deflection="20 um")
    assert (thicker.backlash, thicker.damping_length) == (0.16, 0.01)
    heavier = pair.replace(reduced_mass="5 kg")
    assert heavier.body_mass == 5000.0
    stiff = pair.replace(bearing_stiffness="1 C_s")
    for changes in ({"mesh_stiffness_max": "8e5 N/mm"}, {"contact_ratio": 1.7}):
        changed = stiff.replace(**changes)
        assert changed.bearing_stiffness == pytest.approx(changed.stiffness_mean, rel=1e-14)
    fixed = pair.replace(backlash="80 um").replace(static_deflection="20 um")
    assert fixed.backlash == 0.08


def test_values_in_nested_lists_may_be_relative(pair):
    wavy = pair.replace(profile_deviation=[["0.1 y_st", "1 um"], ["0 um", "-0.2 y_st"]])
    assert wavy.profile_deviation == ((0.001, 0.001), (0.0, -0.002))
    thicker = wavy.replace(static_deflection="20 um")
    assert thicker.profile_deviation == ((0.002, 0.001), (0.0, -0.004))
    assert pair.replace(eccentricity=["1 y_st", "5 um"]).eccentricity == (0.01, 0.005)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("backlash", "8 m_red", "found '8 m_red'; unit 'kg' is of another kind"),
        ("backlash", "8 C_s", "found '8 C_s'; unit 'N/mm' is of another kind"),
        ("body_mass", "8 y_st", "found '8 y_st'; unit 'mm' is of another kind"),
        ("bearing_stiffness", "8 m_red", "unit 'kg' is of another kind"),
        ("friction_coefficient", "8 y_st", "unit 'mm' where none belongs"),
        ("eccentricity", ["1 y_st", "1 m_red"], "is wrong: unit 'kg' is of another kind"),
        ("backlash", "8 y_str", "no scale 'y_str', only y_st, m_red, C_s"),
        ("backlash", "8 Y_ST", "no scale 'Y_ST', only y_st, m_red, C_s"),
        ("backlash", "y_st", "not a quantity"),
        ("backlash", "-1 y_st", "out of range; allowed is 1e-06 to 100 mm"),
        ("backlash", "1e5 y_st", "out of range; allowed is 1e-06 to 100 mm"),
        ("static_deflection", "2 y_st", "static_deflection: found '2 y_st'; 'y_st' is not"),
        ("static_deflection", "2 m_red", "static_deflection: found '2 m_red'; 'm_red' is not"),
        ("reduced_mass", "2 m_red", "reduced_mass: found '2 m_red'; 'm_red' is not allowed here"),
    ],
)  # fmt: skip
def test_a_wrong_scale_is_reported_at_its_parameter(pair, name, value, message):
    with pytest.raises(InputError) as caught:
        pair.replace(**{name: value})
    assert message in str(caught.value)
    assert "more)" not in str(caught.value)


def test_a_wrong_reference_is_reported_once_and_not_at_what_is_relative_to_it(pair):
    with pytest.raises(InputError) as caught:
        pair.replace(static_deflection="10 kg")
    assert str(caught.value).startswith("static_deflection: found '10 kg'")
    assert "more)" not in str(caught.value)
    with pytest.raises(InputError, match=r"^contact_ratio: found 3.5; out of range"):
        pair.replace(bearing_stiffness="1 C_s", contact_ratio=3.5)


def test_a_copy_without_validation_forgets_how_its_values_were_stated(pair):
    """Else `replace` would bring the values of the original back."""
    copy = pair.model_copy(update={"backlash": 0.03})
    assert copy.replace(teeth=24).backlash == 0.03
    assert listed(copy)["backlash"].kind == "stated"
    assert pair.replace(teeth=24).backlash == 0.08


def test_a_pair_of_bare_values_can_be_replaced_too(pair):
    bare = Pair(**{name: value for name, value in texts(pair).items() if value is not None})
    assert bare.digest() == pair.digest()
    assert bare.replace(teeth=24).digest() == pair.replace(teeth=24).digest()
    assert {p.kind for p in bare.parameters} == {"stated", "default", "setting"}


def texts(pair):
    """Return the values of a pair with their units."""

    def text(value, unit):
        if isinstance(value, tuple):
            return [text(item, unit) for item in value]
        return value if unit == "1" or value is None else f"{value!r} {unit}"

    return {p.name: text(p.value, p.unit) for p in pair.parameters}


def test_values_that_are_written_with_units_are_read_back(pair):
    changed = pair.replace(
        eccentricity=["1 um", "2 um"],
        eccentricity_angle="33.3 deg",
        profile_deviation=[["1 um", "0 um"], ["0.1 um", "-0.3 um"]],
        damping_2m="1 N s/mm",
    )
    assert changed.digest() != pair.digest()
    stated = {name: value for name, value in texts(changed).items() if value is not None}
    assert Pair(**stated).digest() == changed.digest()


@given(
    st.floats(1e-5, 4.0).map(lambda x: float(f"{x:.12g}")),
    st.sampled_from(["backlash", "static_deflection", "eccentricity"]),
)
def test_the_digest_depends_on_values_and_not_on_units(pair, value, name):
    in_mm = pair.replace(**{name: f"{value!r} mm"})
    in_um = pair.replace(**{name: f"{value * 1e3:.12g} um"})
    other = pair.replace(**{name: f"{value * (1 + 1e-9):.12g} mm"})
    assert in_mm.digest() == in_um.digest() != other.digest()


@given(factor=st.floats(0.01, 1000.0).map(lambda x: float(f"{x:.12g}")), data=st.data())
def test_a_multiple_of_the_static_deflection_is_that_many_of_it(pair, factor, data):
    y_st = data.draw(st.floats(1e-4, 0.09).map(lambda x: float(f"{x:.12g}")))
    relative = pair.replace(static_deflection=f"{y_st!r} mm", damping_length=f"{factor!r} y_st")
    assert relative.damping_length == pytest.approx(factor * y_st, rel=1e-14)


OWN = """
base: paper.yaml
contact_ratio: 1.65
teeth: 24
stiffness_ratio: 0.62
mesh_stiffness_max: 5.2e5 N/mm
reduced_mass: 1.8 kg
damping: 2.5 N s/mm
"""


def test_a_study_of_ones_own_inherits_no_false_statement(root, tmp_path, pair):
    (tmp_path / "paper.yaml").write_bytes((root / "config" / "paper.yaml").read_bytes())
    (tmp_path / "my-gear.yaml").write_text(OWN)
    study = load_study(tmp_path / "my-gear.yaml")
    assert (study.name, study.title, study.claims) == ("my-gear", "my-gear", None)
    own = set(listed(pair)) & {line.partition(":")[0] for line in OWN.split("\n")}
    assert len(own) == 6
    for name, parameter in listed(study.pair).items():
        if name in own:
            assert (parameter.kind, parameter.reason) == ("stated", "")
            continue
        # What it inherits keeps its reason, and may be called printed only if it is the paper's.
        assert parameter.kind != "printed"
        assert parameter.reason == listed(pair)[name].reason
    assert study.pair.body_mass == 1800.0
    assert study.pair.stiffness_mean == pytest.approx(5.2e5 * (0.65 + 0.35 * 0.62))


@pytest.mark.parametrize("name", ["profile_deviation", "stiffness_fourier", "restoring_fourier"])
def test_harmonics_are_limited_in_one_line(pair, name):
    harmonic = ["1 um", "0 um"] if name == "profile_deviation" else [0.001, 0.0]
    assert len(getattr(pair.replace(**{name: [harmonic] * 100}), name)) == 100
    with pytest.raises(InputError, match=f"{name}: found a list of 2000; allowed are at most 100"):
        pair.replace(**{name: [harmonic] * 2000})
