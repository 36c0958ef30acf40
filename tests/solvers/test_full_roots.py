"""Changes of sign of polynomials: the first one, however close the next."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from gearmesh.solvers.full.roots import MAX_DEGREE, NEVER, TABLE_ROWS, WIDTH, first_change


def first(coefficients, sign):
    coefficients = np.array(coefficients, float)
    return first_change(coefficients, len(coefficients) - 1, sign, np.zeros((TABLE_ROWS, WIDTH)))


def from_roots(*roots):
    return Polynomial.fromroots(roots).coef


places = st.floats(0.001, 0.999)


@given(st.lists(st.floats(-2.0, 2.0), min_size=1, max_size=8))
def test_first_simple_root(roots):
    inside = sorted(r for r in roots if 0.0 < r < 1.0)
    apart = np.abs(np.subtract.outer(roots, roots)) + np.eye(len(roots))
    assume(apart.min() > 0.01)
    assume(all(min(abs(r), abs(r - 1.0)) > 0.01 for r in roots))
    coefficients = from_roots(*roots)
    found = first(coefficients, np.sign(coefficients[0]))
    if inside:
        assert found == pytest.approx(inside[0], abs=1e-9)
    else:
        assert found == NEVER


@given(places, st.sampled_from([1e-2, 1e-4, 1e-6]))
def test_a_pair_of_close_roots_is_found(place, gap):
    assume(place + gap < 1.0)
    found = first(from_roots(place, place + gap), 1.0)
    assert found == pytest.approx(place, abs=1e-3 * gap + 1e-15 / gap)


@given(places, st.sampled_from([1e-2, 1e-4, 1e-6]))
def test_a_polynomial_that_only_comes_close_has_none(place, gap):
    coefficients = from_roots(place, place)
    coefficients[0] += gap**2
    assert first(coefficients, 1.0) == NEVER


def test_a_root_at_0_is_not_found_again():
    assert first([0.0, -1.0], -1.0) == NEVER
    assert first([0.0, -1.0, 2.0], -1.0) == pytest.approx(0.5)
    assert first([0.0, 0.0, -1.0, 4.0], -1.0) == pytest.approx(0.25)
    assert first([0.0, 0.0, 0.0], 1.0) == NEVER


def test_a_wrong_sign_at_the_start_is_told_at_once():
    assert first([-1e-17, 1.0], 1.0) == 0.0
    assert first([0.0, -1e-17, 1.0], 1.0) == 0.0


@pytest.mark.parametrize("place", [0.5, 0.25, 0.75, 0.125])
def test_roots_where_intervals_are_halved(place):
    assert first(from_roots(place), -1.0) == pytest.approx(place, abs=1e-15)
    assert first(from_roots(place, 0.9), 1.0) == pytest.approx(place, abs=1e-15)
    assert first(from_roots(place, place, place), -1.0) == pytest.approx(place, abs=1e-5)


def test_the_highest_degree():
    # The Chebyshev polynomial on <0; 1>: all its roots are there.
    scale = np.polynomial.Chebyshev.basis(12, domain=[0, 1]).convert(kind=Polynomial).coef
    inner = 0.5 + 0.5 * np.cos(np.pi * 11.5 / 12)
    assert first(scale, np.sign(scale[0])) == pytest.approx(inner, abs=1e-12)
    coefficients = np.zeros(MAX_DEGREE + 1)
    coefficients[0], coefficients[-1] = -0.5, 1.0
    assert first(coefficients, -1.0) == pytest.approx(0.5 ** (1.0 / MAX_DEGREE))
