"""Searches along one axis, on functions whose answers are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.dynamics.refinement import refine_change, refine_peak, refine_step
from gearmesh.dynamics.response_curves import WIDTH

places = st.floats(0.6001, 1.1999)
widths = st.floats(1e-9, 0.1)


@given(places, widths)
def test_a_change_is_bracketed_as_narrowly_as_asked(place, width):
    low, high = refine_change(lambda nu: nu > place, 0.6, 1.2, width)
    assert 0.6 <= low <= place < high <= 1.2
    assert high - low <= width


@given(st.lists(places, min_size=1, max_size=9).filter(lambda p: len(p) % 2), widths)
def test_of_several_changes_one_is_bracketed(changes, width):
    def holds(nu):
        return np.searchsorted(sorted(changes), nu) % 2 == 1

    low, high = refine_change(holds, 0.6, 1.2, width)
    assert holds(np.array([low]))[0] != holds(np.array([high]))[0]
    assert high - low <= width


def test_a_change_between_neighbouring_numbers_ends():
    low, high = refine_change(lambda nu: nu > 0.7, 0.6, 1.2, 0.0)
    assert low <= 0.7 < high
    assert high - low < 1e-14


def test_no_change_is_an_error_and_not_an_answer():
    with pytest.raises(ValueError, match=r"nothing changes between 0\.6 and 1\.2"):
        refine_change(lambda nu: nu > 2.0, 0.6, 1.2, WIDTH)


@given(places, st.floats(0.5, 3.0), st.floats(-1.0, 1.0))
def test_the_step_of_a_jump_stays_and_that_of_a_slope_shrinks(place, height, slope):
    def jump(nu):
        return slope * nu + height * (nu > place)

    low, high, step = refine_step(jump, 0.6, 1.2, 1e-6)
    assert low <= place <= high
    assert step == pytest.approx(height, abs=2e-6)
    low, high, step = refine_step(lambda nu: height * nu, 0.6, 1.2, 1e-6)
    assert step == pytest.approx(height * (high - low), rel=1e-6)


@given(st.floats(0.61, 1.19))
def test_a_peak_is_located(place):
    nu, height = refine_peak(lambda x: -np.abs(x - place), 0.6, 1.2, WIDTH)
    assert nu == pytest.approx(place, abs=WIDTH / 2)
    assert height == -abs(nu - place)
