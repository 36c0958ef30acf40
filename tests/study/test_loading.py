"""Studies from files: what they mean, and the messages about wrong ones."""

import string

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gearmesh.errors import InputError
from gearmesh.study.cases import Plan, Study
from gearmesh.study.loading import load, load_study
from gearmesh.study.pair import Pair

fuzz = settings(
    max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def test_replaced_parameters_are_read_like_those_of_a_file(paper):
    study = load_study(paper, ["backlash=55 um", "revolutions=9", "eccentricity=[1 um, 2 um]"])
    assert (study.pair.backlash, study.pair.revolutions) == (0.055, 9)
    assert study.pair.eccentricity == (0.001, 0.002)
    (backlash,) = (p for p in study.pair.parameters if p.name == "backlash")
    assert (backlash.kind, backlash.reason) == ("stated", "set on the command line")


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["backlash=5 um", "backlash=3 y_st"], "--set backlash=3 y_st: backlash: found twice"),
        (["torque=9 N m", "static_deflection=9 um"], "torque: stated beside static_deflection"),
        (["static_deflection=9 um", "torque=9 N m"], "torque: stated beside static_deflection"),
    ],
)
def test_no_replacement_is_dropped(paper, overrides, message):
    with pytest.raises(InputError, match=message):
        load_study(paper, overrides)


def test_values_follow_a_reference_that_is_replaced_on_the_command_line(paper):
    pair = load_study(paper, ["static_deflection=20 um"]).pair
    assert (pair.backlash, pair.damping_length) == (0.16, 0.01)


def test_a_replaced_value_may_be_left_open(paper):
    assert load_study(paper, ["damping_1="]).pair.damping_1 is None


MISTAKES = """
contact_ratio=2.5 | contact_ratio: found 2.5; allowed are 1 to 2, and up to 3 with
contact_ratio=0.9 | found 0.9; out of range; allowed is 1 to 3
contact_ratio=1,569 | found '1,569'; not a quantity; use a decimal point; expected: a plain number
contact_ratio=.nan | found nan; not finite
contact_ratio=.inf | found inf; not finite
contact_ratio=1e999 | found inf; not finite
contact_ratio= | found nothing; not a quantity
contact-ratio=1.5 | contact-ratio: no such parameter (did you mean 'contact_ratio'?)
stiffness_ratio=58.79 % of C_max | not a quantity
stiffness_ratio=0 | out of range
mesh_stiffness_max=400000 | found 400000; unit missing; expected: a stiffness with its unit
mesh_stiffness_max=4e5 N | unit 'N' is of another kind; expected: a stiffness
mesh_stiffness_max=4·10^5 N/mm | not a quantity
reduced_mass=3.123 mm | found '3.123 mm'; unit 'mm' is of another kind; expected: a mass
reduced_mass=-3 kg | found '-3 kg'; out of range; allowed is 1e-06 to 1e+06 kg
reduced_mass=3.123 kgs | unknown unit 'kgs'
teeth=21.5 | teeth: found 21.5; allowed is a whole number
teeth=[21, 22.5] | teeth: found a list of 2; allowed are whole numbers
revolutions='2.5' | revolutions: found '2.5'; allowed is a whole number
revolutions=[2] | revolutions: found a list of 1; allowed is a single value
teeth=twenty-one | not a quantity
teeth=true | found True; not a quantity
teeth=yes | found 'yes'; not a quantity
teeth=[21, 21, 21] | teeth: found a list of 3; allowed is one value, or two for wheels 3 and 2
damping=3.95 | unit missing; expected: a damping coefficient
damping=3.95 N/mm | of another kind
damping_2m=-1 N s/mm | damping_2m: found '-1 N s/mm'; out of range; allowed is 0 to 1e+06
damping_4=1 N s/mm | damping_4: no such parameter (did you mean 'damping
Damping=3.95 N s/mm | Damping: no such parameter (did you mean 'damping'?)
pressure_angle=20 | unit missing; expected: an angle
pressure_angle=20 mm | of another kind
backlash=40um. | not a quantity
backlash=0,04 mm | found '0,04 mm'; not a quantity; use a decimal point; expected: a length
backlash=0 um | out of range
backlash=[1 um, 2 um] | backlash: found a list of 2; allowed is a single value
backlash=8 C_s | found '8 C_s'; unit 'N/mm' is of another kind; expected: a length
backlash=8 st | unknown unit 'st'
backlash={value: 40 um} | found a mapping; not a quantity
backlash=40 um: 3 | found a mapping; not a quantity
backlsh=40 um | backlsh: no such parameter (did you mean 'backlash'?)
backlash=*a | aliases (*) are not supported
backlash=!!python/object/apply:os.system [ls] | tags (!) are not supported
backlash=[40 um | expected ',' or ']'
body_mass=100 | unit missing; expected: a mass
bearing_damping_ratio=3 | out of range; allowed is 0 to 1
friction_coefficient=-0.05 | found -0.05; out of range
eccentricity=[1 um, 2 kg] | found a list of 2; item '2 kg' is wrong: unit 'kg' is of another kind
eccentricity_3=1 um | eccentricity_3: no such parameter (did you mean 'eccentricity'?)
eccentricity_angle=400 deg | out of range
initial_phase=90 deg | unit 'deg' where none belongs
initial_displacement=1 | unit missing; expected: a length
initial_velocity=1 mm/s | unit 'mm/s' is of another kind; expected: a length
stiffness_harmonics=2.5 | allowed is a whole number
profile_deviation=1 um | found '1 um'; allowed is a list
profile_deviation=[[1 um]] | profile_deviation.0.1: missing; expected: (cos, sin) amplitudes
profile_deviation=[[1 um, 0 um, 0 um]] | profile_deviation.0: found a list of 3; allowed are at
profile_deviation=[[1 um, 0 kg]] | item '0 kg' is wrong: unit 'kg' is of another kind
revolutions=0 | out of range
revolutions=1e9 | out of range
kept_revolutions=6 | kept_revolutions: found 6; allowed are at most the 5
samples_per_period=none | not a quantity
tolerance=0 | out of range
tolerance=1 | out of range
tol=1e-8 | tol: no such parameter
nu=0.6 | nu: not a parameter; the file of a study states it
nu.start=0.6 | nu.start: not a parameter; the file of a study states it
variants=all | variants: not a parameter; the file of a study states it
title=x | title: not a parameter; the file of a study states it
base=other.yaml | base: not a parameter; the file of a study states it
assumed.backlash=40 um | assumed.backlash: no such parameter (did you mean 'backlash'?)
run.revolutions=7 | run.revolutions: no such parameter (did you mean 'revolutions'?)
printed=5 | printed: no such parameter; 'gearmesh parameters' lists all parameters
static_force=5 N | static_force: no such parameter; it is computed as C_s y_st
stiffness_mean=3 N/mm | stiffness_mean: no such parameter; it is computed as C_max
backlash | allowed is NAME=VALUE, as in backlash='40 um'
=3 | allowed is NAME=VALUE
a..b=3 | a..b: no such parameter
teeth.number=3 | teeth.number: no such parameter
"""


@pytest.mark.parametrize("mistake", MISTAKES.strip().splitlines())
def test_a_wrong_replacement_is_reported_in_one_line(paper, mistake):
    override, _, expected = mistake.partition(" | ")
    with pytest.raises(InputError) as caught:
        load_study(paper, [override])
    assert expected in str(caught.value)
    assert f"--set {override}" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_wrong_value_of_the_file_is_not_blamed_on_the_command_line(write):
    file = write("base: paper.yaml\nbacklash: 4 kg")
    with pytest.raises(InputError) as caught:
        load_study(file, ["module=2 mm"])
    assert str(caught.value).startswith(f"{file}: backlash: found '4 kg'")


BAD_FILES = {
    "empty": (b"", "the file is empty"),
    "only a comment": (b"# nothing\n", "the file is empty"),
    "no mapping": (b"- 1\n- 2\n", "found no keys"),
    "a word": (b"gears", "found no keys"),
    "key twice": (b"base: paper.yaml\nnu:\n  step: 1\n  step: 1\n", "line 4, column 3: key 'step'"),
    "tab": (b"nu:\n\tstep: 3\n", "line 2, column 1"),
    "indent": (b"nu:\n  a: 1\n b: 2\n", "line 3"),
    "open quote": (b'title: "abc\n', "line 2"),
    "two documents": (b"a: 1\n---\nb: 2\n", "line 2, column 1: found a second document; all"),
    "number as key": (b"1: 2\n", "line 1, column 1: a key is not a text"),
    "list as key": (b"[a, b]: 2\n", "line 1, column 1: a key is not a text"),
    "merge key": (b"a: &x {b: 1}\nc:\n  <<: *x\n", "aliases (*) are not supported"),
    "latin 1": ("title: Zähne".encode("latin-1"), "byte 8 is not UTF-8"),
    "utf-16": ("title: x".encode("utf-16"), "byte 0 is not UTF-8"),
    "nul": (b"title: \0", "not YAML"),
    "deep": (b"a: " + b"[" * 5000, "more than 12 levels"),
    "huge": (b"#" * 1_000_001, "larger than"),
    "no base": (b"base: missing.yaml", "missing.yaml: cannot be read (No such file"),
    "base with nul": (b'base: "a\\0b"', "cannot be read (embedded null byte)"),
    "base a list": (b"base: [paper.yaml]", "base: found a list of 1; allowed is the name of a fi"),
    "itself": (b"base: study.yaml", "inherit in a circle"),
    "nothing stated": (b"title: x", "contact_ratio: missing; expected: contact ratio"),
    "code": (b"title: !!python/name:os.system", "tags (!) are not supported"),
    "old section": (b"base: paper.yaml\nprinted: {teeth: 3}", "printed: unknown key"),
    "derived": (
        b"base: paper.yaml\nstatic_force: 1 N",
        "static_force: unknown key; it is computed",
    ),
    "near key": (b"base: paper.yaml\nbacklsh: 1 um", "backlsh: unknown key (did you mean 'backla"),
    "comma": (b"base: paper.yaml\ninitial_phase: 0,66", "initial_phase: found '0,66'; not a quant"),
    "line break in key": (b'base: paper.yaml\n"back\\nlash": 1', "back lash: unknown key"),
    "long key": (b"base: paper.yaml\n" + b"k" * 900 + b": 1", "k: unknown key"),
    "long value": (b"base: paper.yaml\nbacklash: " + b"9" * 100_000 + b"!", "…; not a quantity"),
    "no reference": (b"backlash: 8 y_st", "static_deflection: missing; backlash is stated in y_s"),
}


@pytest.mark.parametrize("name", BAD_FILES)
def test_a_wrong_file_is_reported_in_one_line(refused, name):
    text, expected = BAD_FILES[name]
    message = refused(text)
    assert expected in message
    assert len(message) < 400


def test_a_file_that_cannot_be_opened_is_named(tmp_path):
    with pytest.raises(InputError, match=r"missing\.yaml: cannot be read \(No such file"):
        load_study(tmp_path / "missing.yaml")
    with pytest.raises(InputError, match="cannot be read \\(Is a directory"):
        load_study(tmp_path)


@pytest.mark.parametrize("path", [None, 5, b"paper.yaml", [], "", "a\0b"])
def test_what_is_no_name_of_a_file_is_reported_in_one_line(path):
    with pytest.raises(InputError, match=r"allowed is the name of a file|cannot be read"):
        load(path)


@pytest.mark.parametrize("claims", ["nope.yaml", ".", '"a\\0b"'])
def test_a_ledger_that_is_not_there_is_reported(write, claims):
    file = write(f"base: paper.yaml\nclaims: {claims}")
    with pytest.raises(InputError, match=r"study.yaml: claims: there is no file "):
        load(file)


def test_several_mistakes_are_counted(paper):
    with pytest.raises(InputError, match=r"found 3; unit missing.*\(and 1 more\)"):
        load_study(paper, ["backlash=3", "module=3"])


def test_a_study_that_is_written_in_another_order_is_the_same(write, study):
    data = {
        **{name: vars_of(statement) for name, statement in study.pair._statements.items()},
        **study.plan.model_dump(mode="json", exclude_none=True, exclude={"claims"}),
        "claims": study.plan.claims,
    }
    written = load_study(write(yaml.safe_dump(data, allow_unicode=True, sort_keys=True)))
    assert (written.pair, written.plan) == (study.pair, study.plan)
    assert written.pair.parameters == study.pair.parameters
    assert written.cases == study.cases


def vars_of(statement):
    return {"value": statement.value, "kind": statement.kind, "reason": statement.reason}


@fuzz
@given(data=st.data())
def test_damaged_text_is_a_study_or_an_input_error_of_one_line(write, paper, data):
    text = bytearray(paper.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(text) - 1))
        junk = data.draw(
            st.sampled_from([b"", b":", b"\t", b"[", b"-", b"\xff", b"'", b"0", b"\n", b"{"])
        )
        text[at : at + data.draw(st.integers(0, 3))] = junk
    try:
        assert isinstance(load_study(write(bytes(text))), Study)
    except InputError as error:
        assert len(str(error).splitlines()) == 1


KEYS = st.sampled_from([*Pair.model_fields, *Plan.model_fields, "name", "base"])
QUANTITIES = st.builds(
    "{}{}".format,
    st.integers() | st.floats(),
    st.sampled_from([" mm", " kg", " y_st", " m_red", "C_s", " N/mm", "%", " N s/mm", ",5 mm"]),
)
SCALARS = (
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(string.printable) | QUANTITIES
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(KEYS | st.text(max_size=5), inner, max_size=3)
        | st.fixed_dictionaries({"value": inner}, optional={"kind": inner, "reason": inner})
    ),
)


@fuzz
@given(key=KEYS | st.text(string.printable, max_size=20), value=VALUES)
def test_any_replaced_value_is_a_study_or_an_input_error_of_one_line(paper, key, value):
    flow = yaml.safe_dump(value, default_flow_style=True, allow_unicode=True)
    try:
        load_study(paper, [f"{key}={flow.removesuffix('...' + chr(10))}"])
    except InputError as error:
        assert len(str(error).splitlines()) == 1
        assert len(str(error)) < 2000


@fuzz
@given(own=st.dictionaries(KEYS | st.text(max_size=8), VALUES, min_size=1, max_size=4))
def test_any_keys_of_a_file_are_a_study_or_an_input_error_of_one_line(write, own):
    text = yaml.safe_dump({"base": "paper.yaml", **own}, allow_unicode=True)
    try:
        study = load_study(write(text))
    except InputError as error:
        assert len(str(error).splitlines()) == 1
        assert len(str(error)) < 2000
        return
    assert study.cases
