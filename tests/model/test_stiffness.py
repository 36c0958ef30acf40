"""Mesh stiffness: eqs. (4) and (5), and the rectangular wave that they add up to."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from gearmesh.model import stiffness

PAPER = (1.569, 4.0e5, 0.5879 * 4.0e5)

contact_ratios = st.floats(1.0, 2.0)
levels = st.tuples(st.floats(0.5, 2.0), st.floats(0.05, 1.0)).map(lambda x: (x[0], x[0] * x[1]))


def test_mean_stiffness_of_the_paper():
    assert stiffness.mean(*PAPER) == pytest.approx(3.28954e5, abs=0.5)


@given(contact_ratios, levels)
def test_mean_of_the_wave_is_eq_5(contact_ratio, ends):
    maximum, minimum = ends
    share = stiffness.duty(contact_ratio)
    expected = share * maximum + (1.0 - share) * minimum
    assert stiffness.mean(contact_ratio, maximum, minimum) == pytest.approx(expected)


@pytest.mark.parametrize("n", [1, 2, 3, 7, 20])
def test_coefficients_of_eq_4_are_those_of_the_rectangular_wave(n):
    places = (0.0, *stiffness.switch_phases(PAPER[0]), 1.0)
    coefficient = 0.0
    for low, high in pairwise(places):
        level = float(stiffness.rectangular(0.5 * (low + high), *PAPER))
        part, _ = quad(lambda p: np.cos(2.0 * np.pi * n * p), low, high, epsabs=1e-13)
        coefficient += 2.0 * level * part
    amplitude = stiffness.fourier_amplitudes(*PAPER, n)[-1]
    assert amplitude == pytest.approx(coefficient, rel=1e-9)


def test_closed_form_of_the_coefficients():
    n = np.arange(1, 9)
    c_max, kappa = PAPER[1], 0.5879
    closed = 2.0 * (1.0 - kappa) * c_max * np.sin(n * np.pi * 0.569) / (n * np.pi)
    np.testing.assert_allclose(stiffness.fourier_amplitudes(*PAPER, 8), closed, rtol=1e-12)


@pytest.mark.parametrize("terms", [10, 100, 1000, 10000])
def test_the_series_converges_to_the_wave_away_from_the_switches(terms):
    phases = np.array([0.0, 0.1, 0.25, 0.4, 0.5, 0.65, 0.9])
    error = stiffness.fourier(phases, *PAPER, terms) - stiffness.rectangular(phases, *PAPER)
    # The rest of the sum of sin(n x) / n behind N terms is below 1 / ((N + 1) sin(x / 2)).
    jump = PAPER[1] - PAPER[2]
    rest = sum(
        1.0 / np.abs(np.sin(np.pi * (phases - place))) for place in stiffness.switch_phases(1.569)
    )
    assert (np.abs(error) < jump / np.pi * rest / (terms + 1)).all()


def test_the_pulse_is_centred_and_periodic():
    low, high = stiffness.switch_phases(1.569)
    assert (low, high) == (pytest.approx(0.2845), pytest.approx(0.7155))
    around = np.array([0.0, low - 1e-9, -low + 1e-9, 1.0, 3.0 + low - 1e-9, -5.0])
    assert (stiffness.rectangular(around, *PAPER) == PAPER[1]).all()
    between = np.array([low + 1e-9, 0.5, high - 1e-9, -0.5, 7.5])
    assert (stiffness.rectangular(between, *PAPER) == PAPER[2]).all()


@given(st.floats(-3, 3), levels)
def test_limits_have_constant_stiffness(phase, ends):
    maximum, minimum = ends
    assert stiffness.rectangular(phase, 1.0, maximum, minimum) == minimum
    if abs(phase) % 1.0 != 0.5:
        assert stiffness.rectangular(phase, 2.0, maximum, minimum) == maximum
    assert stiffness.fourier(phase, 1.0, maximum, minimum, 5) == pytest.approx(minimum)
    assert stiffness.fourier(phase, 2.0, maximum, minimum, 5) == pytest.approx(maximum)
    assert stiffness.rectangular(phase, 1.5, maximum, maximum) == maximum
    assert stiffness.fourier(phase, 1.5, maximum, maximum, 5) == pytest.approx(maximum)
