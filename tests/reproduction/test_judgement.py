"""When a claim holds, and how entries of the ledger are written and read."""

import json
import math

import pytest
from entries import shape_claim as claim
from entries import shape_entry as entry

from gearmesh.errors import InputError
from gearmesh.reproduction.claims import (
    DEVIATES,
    NOT_TESTABLE,
    REPRODUCED,
    Bound,
    Evidence,
    checking,
    collect,
    holds,
    load_ledger,
    read_entries,
    verdict,
    write_entries,
)


def test_bounds_hold_on_either_side():
    assert (Bound(at_least=1.0).at_least, Bound(at_least=1.0).at_most) == (1.0, None)
    Bound(at_least=1.0, at_most=1.0)
    for low, high in ((None, None), (1.1, 1.0)):
        with pytest.raises(ValueError, match="at_least"):
            Bound(at_least=low, at_most=high)
    above, below = claim(expected={"at_least": 1.0}), claim(expected={"at_most": 1.0})
    for value, is_above, is_below in ((0.9, False, True), (1.0, True, True), (1.1, True, False)):
        assert (holds(above, value), holds(below, value)) == (is_above, is_below)
    assert holds(above, 1e9) and holds(below, -1e9)
    assert not holds(below, -math.inf)


def test_a_value_at_the_limit_of_its_tolerance_holds_in_spite_of_rounding():
    one = claim(expected=1.0, tolerance=0.1)
    assert holds(one, 1.1 + 5e-11) and holds(one, 0.9 - 5e-11)
    assert not holds(one, 1.1 + 1e-9) and not holds(one, 0.9 - 1e-9)
    assert holds(claim(expected=1.0, tolerance=0.0), 1.0)
    assert not holds(claim(expected=1.0, tolerance=0.0), 1.0 + 1e-12)


@pytest.mark.parametrize("tolerance", [-1.0, math.inf, math.nan])
def test_a_tolerance_is_a_finite_number_from_0_on(tolerance):
    with pytest.raises(ValueError, match="tolerance: found"):
        claim(expected=1.0, tolerance=tolerance)


def test_the_targets_of_a_claim_and_their_tolerances():
    assert claim().targets() == [("", Bound(at_most=1.0), None)]
    assert claim(expected=2, tolerance=0.1).targets() == [("", 2.0, 0.1)]
    mixed = claim(expected={"a": 1.0, "b": {"at_least": 2}}, tolerance=0.1)
    assert mixed.targets() == [("a", 1.0, 0.1), ("b", Bound(at_least=2.0), None)]
    each = claim(expected={"a": 1.0, "b": 2.0}, tolerance={"a": 0.1, "b": 0.2})
    assert each.targets() == [("a", 1.0, 0.1), ("b", 2.0, 0.2)]
    for wrong in ({"expected": {"at_most": 1.0}, "tolerance": 0.1}, {"expected": 1.0}):
        with pytest.raises(ValueError, match="needed for expected numbers"):
            claim(**wrong)
    with pytest.raises(ValueError, match="of 'b'"):
        claim(expected={"a": 1.0, "b": 2.0}, tolerance={"a": 0.1})


def test_an_entry_is_unexpected_if_it_is_judged_and_has_another_status():
    assert not entry().unexpected
    assert entry(status=DEVIATES).unexpected
    assert not entry(status=DEVIATES, judged=False).unexpected


def test_an_entry_as_json_has_six_digits_and_no_empty_options(tmp_path):
    values = {"a": (0.123456789, math.inf), "b": [True, 12345678, None]}
    made = entry(measured=values, detail="ν_s")
    stored = made.as_json()
    assert stored["measured"] == {"a": [0.123457, None], "b": [True, 12345678, None]}
    assert not {"quote", "tolerance_reason", "reason", "mechanism"} & stored.keys()
    assert stored["tolerance"] is None and stored["judged"] is True
    quoted = entry(mechanism="orbit").model_copy(update={"quote": "so"})
    assert (quoted.as_json()["quote"], quoted.as_json()["mechanism"]) == ("so", "orbit")
    write_entries(tmp_path / "one.json", [made])
    assert "ν_s" in (tmp_path / "one.json").read_text("utf-8")
    assert json.loads((tmp_path / "one.json").read_text("utf-8")) == [stored]
    assert (tmp_path / "one.json").read_text("utf-8").startswith('[\n {\n  "id"')


def test_checks_come_together_with_their_mechanisms(tmp_path):
    write_entries(tmp_path / "a.json", [entry("F2.1"), entry("F2.2", DEVIATES, judged=False)])
    known = [claim(id=name) for name in ("F2.2", "F2.1", "F2.3")]
    found = collect(known, [tmp_path / "a.json"], tmp_path / "all.json", {"F2.1": "an orbit"})
    assert [(one.id, one.mechanism) for one in found] == [
        *(("F2.2", None), ("F2.1", "an orbit"), ("F2.3", None)),
    ]
    assert [one.status for one in found] == [DEVIATES, REPRODUCED, NOT_TESTABLE]
    assert found[2].judged and found[2].detail == "was not checked"
    assert read_entries(tmp_path / "all.json") == found
    counted = verdict(iter(found))
    assert (counted.reproduced, counted.deviates, counted.not_testable) == (1, 1, 1)
    assert [one.id for one in counted.unexpected] == ["F2.3"]
    (tmp_path / "wrong.json").write_text('{"id": 1}')
    with pytest.raises(InputError, match="allowed is a list of checked claims"):
        read_entries(tmp_path / "wrong.json")


def test_a_figure_is_checked_claim_by_claim(tmp_path, monkeypatch, pair):
    monkeypatch.setattr(checking, "MEASURES", {"F2.1": lambda _: (0.5, "half"), "F3.1": None})
    claims = [claim(id="F3.1", figure="fig3"), claim()]
    output = tmp_path / "fig2.json"
    found = checking.check_figure("fig2", Evidence(pair=pair), claims, output)
    assert [(one.id, one.status, one.detail) for one in found] == [("F2.1", REPRODUCED, "half")]
    assert read_entries(output) == found
    with pytest.raises(InputError, match=r"F2\.9: no such check; known are F2\.1, F3\.1"):
        checking.check(claim(id="F2.9"), Evidence(pair=pair))


def test_a_ledger_keeps_the_order_of_its_file(tmp_path):
    path = tmp_path / "claims.yaml"
    text = "where: x, figure: fig2, statement: x, kind: shape, expected: {at_most: 1}"
    path.write_text(f"F2.2: {{{text}}}\nF2.1: {{{text}}}\n")
    assert [one.id for one in load_ledger(path)] == ["F2.2", "F2.1"]
