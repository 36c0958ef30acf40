"""The ledger: how it is read, and what counts as reproduced."""

import json
import math

import pytest
import yaml
from entries import shape_claim as claim
from entries import shape_entry as entry
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.errors import InputError
from gearmesh.reproduction.claims import (
    DEVIATES,
    NOT_TESTABLE,
    REPRODUCED,
    Claim,
    Evidence,
    NotInStudy,
    checking,
    collect,
    holds,
    load_ledger,
    read_entries,
    verdict,
    write_entries,
)
from gearmesh.reproduction.claims.checking import check_figure

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
    ("mistake", "expected"),
    [
        ({"tolerence": 0.1}, "tolerence: unknown key (did you mean 'tolerance'?)"),
        ({"id": "F2.2"}, "id: unknown key; F2.1 is the id"),
        ({"kind": "hunch"}, "kind: found 'hunch'"),
        ({"figure": "fig1"}, "figure: found 'fig1'"),
        ({"statement": None}, "statement: found nothing"),
        ({"expected": "0.66 or so"}, "expected: found '0.66 or so'; allowed is a number"),
        ({"expected": True}, "expected: found True; allowed is a number"),
        ({"expected": {"at_least": 2, "at_most": 1}}, "at_least: 2 is above at_most, 1"),
        ({"expected": {"at_most": 1}}, "tolerance: needed for expected numbers"),
        ({"expected": {}, "tolerance": None}, "expected.at_least: missing"),
        ({"expected": {"near": {}}}, "expected.at_least: missing"),
        ({"tolerance": None}, "tolerance: needed for expected numbers"),
        ({"tolerance": -0.1}, "tolerance: found -0.1; allowed is a number >= 0"),
        ({"tolerance": {"near": 0.1}}, "tolerance: found a mapping; allowed is a number, as for"),
        ({"tolerance": {}}, "tolerance: found a mapping; allowed is a number, as for expected"),
        (
            {"expected": {"a": 1.0}, "tolerance": {"near": 0.1}},
            "tolerance: expected names no quantity 'near'",
        ),
        ({"expected": {"a": 1.0}, "tolerance": {}}, "tolerance: needed for expected numbers"),
        ({"expected_status": "deviates"}, "reason: needed if, and only if"),
        ({"reason": "just so"}, "reason: needed if, and only if"),
        ({"expected_status": "perhaps"}, "expected_status: found 'perhaps'"),
    ],
)
def test_a_mistake_in_the_ledger_is_reported_in_one_line(tmp_path, mistake, expected):
    path = written(tmp_path, {"F2.1": {**GOOD, **mistake}})
    with pytest.raises(InputError) as caught:
        load_ledger(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: F2.1")
    assert expected in message
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


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(["at_least", "at_most", "a"]) | st.text(), inner)
    ),
    max_leaves=6,
)


@given(name=st.sampled_from([*Claim.model_fields, "x"]), value=JSON)
def test_any_value_of_a_claim_is_read_or_an_input_error_of_one_line(tmp_path_factory, name, value):
    path = written(tmp_path_factory.getbasetemp(), {"F2.1": {**GOOD, name: value}})
    try:
        (read,) = load_ledger(path)
    except InputError as error:
        assert str(error).startswith(f"{path}: ")
        assert len(str(error).splitlines()) == 1
        return
    assert read.id == "F2.1"
    assert read.targets()


def test_a_wrong_id_is_refused(tmp_path):
    with pytest.raises(InputError, match="Figure 2"):
        load_ledger(written(tmp_path, {"Figure 2": GOOD}))


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


@pytest.fixture
def measuring(monkeypatch, pair):
    """Let F2.1 measure the value that a test gives, and check a claim with it."""

    def run(measure, **changes):
        monkeypatch.setitem(checking.MEASURES, "F2.1", measure)
        return checking.check(claim(**changes), Evidence(pair=pair))

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


def test_a_claim_without_a_check_is_an_input_error(pair):
    with pytest.raises(InputError, match=r"F9\.9: no such check"):
        check_figure("fig2", Evidence(pair=pair), [claim(id="F9.9")])


def test_a_claim_on_a_threshold_that_is_not_located_is_not_testable_and_unexpected(measuring):
    why = "the run of c-lubricant at nu_s = 1.15: step_limit"
    gone = {"onset_maxima": {"c-lubricant": {"not_located": why}, "d-lubricant": None}}

    def depends(evidence):
        return Evidence(pair=evidence.pair, thresholds=gone).located("onset_maxima", names), ""

    names = ["d-lubricant", "c-lubricant"]
    entry = measuring(depends)
    assert (entry.status, entry.measured) == (NOT_TESTABLE, None)
    assert entry.detail == f"not located: onset_maxima of c-lubricant: {why}"
    assert entry.unexpected
    assert verdict([entry]).unexpected == (entry,)
    names = ["d-lubricant"]
    assert measuring(depends).status == DEVIATES


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
