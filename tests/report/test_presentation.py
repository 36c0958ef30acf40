"""How numbers, quantities, claims and symbols are written in the report."""

import math

import pytest
from entries import claim
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.data import paths
from gearmesh.report import glossary
from gearmesh.report.presentation import expected, found, number, quantity, typeset


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.66, "0.66"),
        (-2.5, "−2.5"),
        (328954.2, "328\u202f954"),
        (400000, "400\u202f000"),
        (19.7685, "19.7685"),
        (5e-5, "5·10⁻⁵"),
        (1.5e12, "1.5·10¹²"),
        (0.0, "0"),
        (float("nan"), "–"),
    ],
)
def test_numbers_are_written_as_an_engineer_does(value, text):
    assert number(value) == text


@given(st.floats(min_value=-1e15, max_value=1e15).filter(lambda x: x == 0 or abs(x) > 1e-200))
def test_a_written_number_is_the_number(value):
    plain = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789", "\u202f")
    read = float(number(value).translate(plain).replace("·10", "e"))
    assert read == pytest.approx(value, rel=1e-4)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.08, "mm", "0.08 mm"),
        (math.pi / 9, "rad", "20°"),
        (21, "1", "21"),
        ((21, 34), "1", "21, 34"),
        ((0.0, 0.0), "N*m*s/rad", "0 N m s/rad"),
        ((), "mm", "none"),
        (((0.001, 0.002), (0.0, 0.5)), "mm", "(0.001, 0.002), (0, 0.5) mm"),
        ((2.5,), "kg*m^2", "2.5 kg m²"),
        (False, "1", "no"),
        ("sqrt", "1", "sqrt"),
    ],
)
def test_values_of_parameters_are_written_with_their_units(value, unit, text):
    assert quantity(value, unit) == text


@pytest.mark.parametrize(
    ("value", "lines"),
    [
        (None, ["–"]),
        (True, ["yes"]),
        (0.654321, ["0.6543"]),
        ({}, ["–"]),
        ([[0.6, 0.7]], ["0.6, 0.7"]),
        ({"nu_min": 0.78064, "D": None}, ["ν_min: 0.7806", "D: –"]),
        ({"c-material": 1.0, "c-material-5x": 2.0}, ["c-material\u00a01, c-material-5x\u00a02"]),
        ({"jump": {"b-both": 1.0}}, ["jump: b-both\u00a01"]),
        ({"at": {"0.60": 1.0}}, ["at: 1\u00a0(0.60)"]),
    ],
)
def test_what_was_measured_is_written_in_lines(value, lines):
    assert found(value) == lines


@pytest.mark.parametrize(
    ("target", "tolerance", "lines"),
    [
        (0.66, 0.02, ["0.66 ± 0.02"]),
        (2.0, 0.0, ["2"]),
        ({"at_least": 0.8}, None, ["≥ 0.8"]),
        ({"at_most": 0.02}, None, ["≤ 0.02"]),
        ({"at_least": 0.8, "at_most": 0.9}, None, ["0.8 to 0.9"]),
        ({"end": 0.64, "pairs": {"at_least": 1}}, 0.01, ["end: 0.64 ± 0.01", "pairs: ≥ 1"]),
    ],
)
def test_what_is_expected_is_written_in_lines(target, tolerance, lines):
    assert expected(claim(expected=target, tolerance=tolerance)) == lines


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("ν_s and C_max", "ν<sub>s</sub> and C<sub>max</sub>"),
        ("Ω_s² = C_s/m_red", "Ω<sub>s</sub>² = C<sub>s</sub>/m<sub>red</sub>"),
        ("a < b", "a &lt; b"),
        ("b_φ", "b<sub>φ</sub>"),
        ("time-course", "time-course"),
    ],
)
def test_symbols_are_typeset(text, words):
    assert typeset(text) == words


def test_variants_are_written_with_the_symbols_of_the_paper():
    text = typeset("c-material, c-material-5x, b-lubricant, d-both, a-conservative")
    assert text.striptags() == "c-□, c-□ (5k), b-•, d-×, a-○"


def test_two_digits_of_a_number_above_a_hundred_need_no_power_of_ten():
    assert [number(value, 2) for value in (123.4, 4567.0, 12.3)] == ["120", "4600", "12"]


def test_the_glossary_gives_terms_with_their_explanations(root):
    parts = dict(glossary.parts((root / paths.GLOSSARY).read_text(encoding="utf-8")))
    motion = dict(parts["Motion"])
    assert motion["isola"].startswith("A closed branch.")
    assert {"fold", "flip", "cusp", "torus", "resonant orbit", "sensitive"} <= {*motion}
    symbols = dict(parts["Symbols in figures"])
    assert "<code>-lubricant</code>" in symbols["<code>•</code> (bullet)"]
    assert "m<sub>red</sub>" in {*dict(parts["Gear mesh"])}
