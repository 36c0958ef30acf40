"""Statements of a value with its kind and its reason, in a file."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.errors import InputError
from gearmesh.study.loading import load_study
from gearmesh.study.reading.provenance import GIVEN_KINDS, Statement, read_statement


def parameter(study, name):
    return next(p for p in study.pair.parameters if p.name == name)


@pytest.mark.parametrize("kind", GIVEN_KINDS)
def test_a_statement_has_a_value_a_kind_and_a_reason(write, kind):
    file = write(
        f"base: paper.yaml\nbacklash: {{value: 3 y_st, kind: {kind}, reason: ' measured '}}"
    )
    found = parameter(load_study(file), "backlash")
    assert (found.value, found.kind, found.reason) == (0.03, kind, "measured")


def test_a_bare_value_and_a_mapping_without_kind_are_stated(write):
    study = load_study(write("base: paper.yaml\nbacklash: 30 um\nmodule: {value: 2 mm}"))
    for name, value in (("backlash", 0.03), ("module", 2.0)):
        found = parameter(study, name)
        assert (found.value, found.kind, found.reason) == (value, "stated", "")


def test_a_bare_list_is_a_value(write):
    study = load_study(write("base: paper.yaml\neccentricity: [1 um, 0.2 y_st]"))
    assert study.pair.eccentricity == (0.001, 0.002)
    assert parameter(study, "eccentricity").kind == "stated"


def test_a_setting_of_a_run_says_nothing_about_the_gear(study):
    for name in ("revolutions", "kept_revolutions", "samples_per_period", "tolerance"):
        assert parameter(study, name).kind == "setting"
    assert parameter(study, "initial_velocity").kind == "setting"
    # The paper's study assumes an initial phase, with a reason.
    assert parameter(study, "initial_phase").kind == "assumed"


def test_what_no_file_mentions_has_its_default(study):
    assert parameter(study, "damping_1").kind == "default"
    assert parameter(study, "damping_1").value is None


MISTAKES = [
    ("{value: 40 um, kin: assumed}", "backlash.kin: unknown key (did you mean 'kind'?)"),
    ("{value: 40, unit: um}", "backlash.unit: unknown key; allowed are value, kind, reason"),
    ("{kind: assumed, reason: x}", "backlash.value: missing; a mapping states value, kind and"),
    ("{value: , kind: assumed, reason: x}", "backlash.value: missing"),
    ("{}", "backlash.value: missing"),
    ("{value: 40 um, kind: guessed}", "backlash.kind: found 'guessed'; allowed are printed, der"),
    ("{value: 40 um, kind: default}", "backlash.kind: found 'default'; allowed are"),
    ("{value: 40 um, kind: setting}", "backlash.kind: found 'setting'; allowed are"),
    ("{value: 40 um, kind: [assumed]}", "backlash.kind: found a list of 1; allowed are"),
    ("{value: 40 um, kind: }", "backlash.kind: found nothing; allowed are"),
    ("{value: 40 um, kind: assumed}", "backlash.reason: missing; kind assumed needs one line"),
    ("{value: 40 um, kind: printed}", "backlash.reason: missing; kind printed needs one line"),
    ("{value: 40 um, kind: derived}", "backlash.reason: missing; kind derived needs one line"),
    ("{value: 40 um, kind: assumed, reason: ' '}", "backlash.reason: missing"),
    ("{value: 40 um, reason: 3}", "backlash.reason: found 3; allowed is one line"),
    ('{value: 40 um, reason: "a\\nb"}', "backlash.reason: found 'a\\nb'; allowed is one line"),
    ("{value: {value: 40 um}}", "backlash: found a mapping; not a quantity"),
    ("{value: 40}", "backlash: found 40; unit missing"),
]


@pytest.mark.parametrize(("stated", "message"), MISTAKES)
def test_a_wrong_statement_is_reported_in_one_line(refused, stated, message):
    assert refused(f"base: paper.yaml\nbacklash: {stated}").startswith(message)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
)
ENTRIES = st.dictionaries(
    st.sampled_from(["value", "kind", "reason"]) | st.text(max_size=6),
    JSON | st.sampled_from(GIVEN_KINDS),
    max_size=4,
)


@given(JSON | ENTRIES)
def test_any_data_is_a_statement_or_an_input_error_of_one_line(data):
    try:
        statement = read_statement("backlash", data)
    except InputError as error:
        assert str(error).startswith("backlash.")
        assert len(str(error).splitlines()) == 1
        return
    assert isinstance(statement, Statement)
    assert statement.kind in GIVEN_KINDS
    assert bool(statement.reason) or statement.kind == "stated"
    assert "\n" not in statement.reason
