"""Quantities: what is read, what is refused."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.study.reading.units import COMMON, factor_of, parse


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("40 um", "mm", 0.04),
        ("40 µm", "mm", 0.04),  # the micro sign
        ("40 μm", "mm", 0.04),  # the Greek letter
        ("0.04mm", "mm", 0.04),
        ("-1.5e1 um", "mm", -0.015),
        ("4.0e5 N/mm", "N/mm", 4e5),
        ("400 MN/m", "N/mm", 4e5),
        ("4e5 N mm^-1", "N/mm", 4e5),
        ("3.9537 N s/mm", "N*s/mm", 3.9537),
        ("3.9537 N·s/mm", "N*s/mm", 3.9537),
        ("3.9537 N/(mm/s)", "N*s/mm", 3.9537),
        ("3.123e-3 N s^2/mm", "kg", 3.123),
        ("3.123e-3 N s²/mm", "kg", 3.123),
        ("3123 g", "kg", 3.123),
        ("180 deg", "rad", 3.14159265358979),
        ("180°", "rad", 3.14159265358979),
        ("0.05", "1", 0.05),
        ("5 %", "1", 0.05),
        (7, "1", 7.0),
    ],
)
def test_reads_quantities(text, unit, value):
    assert parse(text, unit) == value


@pytest.mark.parametrize(
    ("value", "unit", "reason"),
    [
        (40, "mm", "unit missing"),
        ("40", "mm", "unit missing"),
        ("40 kg", "mm", "of another kind"),
        ("3.123 mm", "kg", "of another kind"),
        ("1 mm^2", "mm", "of another kind"),
        ("1 %", "rad", "of another kind"),
        ("20 degC", "rad", "of another kind"),
        ("1 rad", "1", "where none belongs"),
        ("40 furlongg", "mm", "unknown unit"),
        ("3,95 mm", "mm", "not a quantity"),
        ("mm", "mm", "not a quantity"),
        ("", "mm", "not a quantity"),
        ("nan mm", "mm", "not a quantity"),
        ("9**9**9 mm", "mm", "not a quantity"),
        ("1 mm**9**9**9", "mm", "not a quantity"),
        ("__import__('os')", "mm", "not a quantity"),
        (True, "1", "not a quantity"),
        (None, "mm", "not a quantity"),
        (["1 mm"], "mm", "not a quantity"),
        (float("nan"), "1", "not finite"),
        (10**400, "1", "not finite"),
        ("1e999 mm", "mm", "not finite"),
    ],
)
def test_refuses_what_is_no_such_quantity(value, unit, reason):
    with pytest.raises(ValueError, match=reason):
        parse(value, unit)


@given(st.integers(-(10**9), 10**9), st.integers(0, 6))
def test_equal_quantities_are_equal_numbers(digits, decimals):
    value = f"{digits}e-{decimals}"
    assert parse(f"{value} um", "mm") == parse(f"{digits}e-{decimals + 3} mm", "mm")


@given(st.text(st.sampled_from("0123456789eE+-.,*/^() µmNskgde%°·²\n"), max_size=100) | st.text())
def test_any_text_is_a_number_or_a_value_error(text):
    for unit in ("mm", "1", "N*s/mm"):
        try:
            assert isinstance(parse(text, unit), float)
        except ValueError as error:
            assert "expected:" in str(error)


@pytest.mark.parametrize(("given", "unit"), COMMON)
def test_the_common_factors_are_those_of_pint(given, unit):
    assert COMMON[given, unit] == factor_of(given, unit)
