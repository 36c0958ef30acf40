"""Tab. 1, and the names of its variants."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.errors import InputError
from gearmesh.model.variants import VARIANTS, Variant, variant

# Tab. 1 as it is printed: for each coefficient, the variants and markers with a mark in its row.
TABLE = {
    "k1": "b□ b× e□ e× f□ f× g□ g×",
    "k2": "c□ c× e□ e× g□ g× h□ h×",
    "k3": "d□ d× f□ f× g□ g× h□ h×",
    "k1m": "b• b× e• e× f• f× g• g×",
    "k2m": "c• c× e• e× g• g× h• h×",
    "k3m": "d• d× f• f× g• g× h• h×",
}


def test_tab_1():
    assert len(VARIANTS) == 22
    acting = {row: set(marks.split()) for row, marks in TABLE.items()}
    for column in VARIANTS.values():
        mark = column.letter + column.marker
        powers = (*column.material_powers, *column.lubricant_powers)
        assert powers == tuple(mark in acting[row] for row in TABLE), column.name


def test_order_and_names_of_tab_1():
    names = list(VARIANTS)
    assert names[:5] == ["a-conservative", "b-material", "b-lubricant", "b-both", "c-material"]
    assert names[-1] == "h-both"
    assert all(VARIANTS[name].name == name for name in names)
    assert VARIANTS["a-conservative"].marker == "○"


def test_descriptions():
    assert VARIANTS["e-lubricant"].description == "L + Kv, lubricant"
    assert VARIANTS["g-both"].description == "L + Kv + Ku, material and lubricant"
    assert VARIANTS["a-conservative"].description == "conservative in the mesh"
    assert variant("c-material-5x").description == "Kv, material, 5 times the damping"


@pytest.mark.parametrize("name", [*VARIANTS, "c-material-5x", "h-both-0.5x"])
def test_names_are_read_back(name):
    assert variant(name).name == name


def test_five_times_the_damping():
    assert variant("c-material-5x") == Variant("c", "material", 5.0)
    assert variant("c-material-5x").material_powers == (False, True, False)


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("c-materal", "did you mean 'c-material'?"),
        ("", "unknown name ''"),
        ("C-material", "did you mean 'c-material'"),
        ("i-both", "unknown name 'i-both'"),
        ("a", "did you mean 'a-conservative'?"),
        ("b", "did you mean 'b-material' or 'b-lubricant' or 'b-both'?"),
        ("B", "did you mean 'b-material' or 'b-lubricant' or 'b-both'?"),
        ("c-□", "did you mean 'c-material'?"),
        ("c-•", "did you mean 'c-lubricant'?"),
        ("C×", "did you mean 'c-both'?"),
        ("a-○", "did you mean 'a-conservative'?"),
        ("c-□-5x", "did you mean 'c-material-5x'?"),
        ("c-material-0x", "no multiple '0'"),
        ("a-conservative-5x", "no multiple '5'"),
    ],
)
def test_an_unknown_variant_is_told_in_one_line(name, told):
    with pytest.raises(InputError, match=re.escape(told)) as caught:
        variant(name)
    assert "\n" not in str(caught.value)


@given(st.text(max_size=20))
def test_any_text_is_a_variant_or_bad_input(text):
    try:
        found = variant(text)
    except InputError:
        return
    assert variant(found.name) == found
