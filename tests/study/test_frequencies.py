"""Mesh frequencies: grids, single values, and the names of their files."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearmesh.data import paths
from gearmesh.errors import InputError
from gearmesh.study.frequencies import Frequencies, read_nu
from gearmesh.study.reading.schema import validate
from gearmesh.study.speeds import as_nu, read_nu_or_speed


def frequencies(**stated):
    return validate(Frequencies, stated, "", {})


@pytest.mark.parametrize(
    ("nu", "label"),
    [(0.66, "0.6600"), (0.6025, "0.6025"), (0.60125, "0.60125"), (2.0, "2.0000"),
     (0.6000000001, "0.6000000001"), (10.0, "10.0000")],
)  # fmt: skip
def test_a_frequency_is_written_with_four_decimals_or_as_many_as_it_needs(nu, label):
    assert paths.nu_label(nu) == label


@given(st.floats(0.01, 10.0), st.floats(0.01, 10.0))
def test_a_label_belongs_to_one_frequency(first, second):
    first, second = read_nu(first), read_nu(second)
    assert float(paths.nu_label(first)) == first
    assert (paths.nu_label(first) == paths.nu_label(second)) == (first == second)
    assert len(paths.nu_label(first).split(".")[1]) >= 4


@given(st.integers(100, 9000), st.integers(1, 5000), st.integers(0, 300))
def test_a_grid_holds_the_decimals_that_one_would_write(start, step, count):
    stop = start + step * count
    stated = {"start": f"{start}e-4", "stop": f"{stop}e-4", "step": f"{step}e-4"}
    if stop > 100_000:
        with pytest.raises(InputError, match=r"stop: found .* allowed is 0.01 to 10"):
            frequencies(**stated)
        return
    expected = [float(f"{start + i * step}e-4") for i in range(count + 1)]
    assert list(frequencies(**stated).all) == expected


@settings(max_examples=30, deadline=None)
@given(start=st.integers(600, 90_000), step=st.integers(1, 5000), count=st.integers(0, 60))
def test_a_grid_of_speeds_holds_the_speeds_that_one_would_write(pair, start, step, count):
    """Conversion of ends and step would round them, and so could remove the last value."""
    ends = {"start": start, "stop": start + step * count, "step": step}
    stated = {name: f"{number}e-1 rpm" for name, number in ends.items()}
    if ends["stop"] > 100 * pair.resonance_speed:
        with pytest.raises(InputError, match=r"nu.stop: found .*; ν_s = .* allowed is 0.01 to 10"):
            as_nu(stated, pair, "nu")
        return
    expected = [read_nu_or_speed(f"{start + i * step}e-1 rpm", pair) for i in range(count + 1)]
    assert list(frequencies(**as_nu(stated, pair, "nu")).all) == expected


def test_values_join_a_grid_or_stand_alone():
    assert frequencies(values=[0.7, 0.6]).all == (0.6, 0.7)
    grid = {"start": 0.6, "stop": 0.7, "step": 0.05}
    assert frequencies(**grid, values=[0.61]).all == (0.6, 0.61, 0.65, 0.7)


def test_the_grid_ends_at_or_before_its_stop():
    assert frequencies(start=0.6, stop=0.74, step=0.05).all == (0.6, 0.65, 0.7)


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ({}, "values: missing; allowed are start, stop and step, values, or both"),
        ({"start": 0.6}, "stop: missing; a grid has start, stop and step"),
        ({"start": 0.6, "stop": 0.8}, "step: missing; a grid has start, stop and step"),
        ({"start": -0.6}, "start: found -0.6; out of range; allowed is 0.01 to 10"),
        ({"start": "1:30"}, "start: found '1:30'; not a quantity; expected: a plain number"),
        ({"start": "0,6"}, "start: found '0,6'; not a quantity; use a decimal point; expected:"),
        ({"start": "0.6 Hz"}, "start: found '0.6 Hz'; unit 'Hz' where none belongs"),
        ({"start": 1.3, "stop": 1.2, "step": 0.1}, "stop: found 1.2, below start; allowed is 1.3"),
        ({"start": 0.6, "stop": 1.2, "step": 0}, "step: found 0; out of range"),
        ({"start": 0.6, "stop": 1.2, "step": -0.1}, "step: found -0.1; out of range"),
        ({"start": 0.6, "stop": 1.2, "step": 1e-9}, "step: makes 600000001 frequencies; allowed"),
        ({"stp": 0.1, "values": [1.0]}, "stp: unknown key (did you mean 'stop'?)"),
        ({"values": 0.7}, "values: found 0.7; allowed is a list"),
        ({"values": [0.6, "x"]}, "values.1: found 'x'; not a quantity"),
        ({"values": [0.601, 0.601]}, "values: found 0.601 twice, or on the grid too"),
        ({"values": [0.6], "start": 0.6, "stop": 0.7, "step": 0.1}, "values: found 0.6 twice"),
    ],
)
def test_a_wrong_set_of_frequencies_is_reported_in_one_line(stated, message):
    with pytest.raises(InputError) as caught:
        frequencies(**stated)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


@given(st.one_of(st.floats(), st.integers(), st.text(), st.none(), st.booleans()))
def test_any_frequency_is_read_in_range_or_is_a_value_error(value):
    try:
        nu = read_nu(value)
    except ValueError:
        return
    assert 0.01 <= nu <= 10.0
    assert read_nu(nu) == nu
