"""The numbers that the paper prints, computed by hand."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.linalg import expm

from gearmesh.reproduction.claims import (
    Evidence,
    printed,
)


def test_printed_numbers_by_hand(pair):
    evidence = Evidence(pair=pair)
    c_max, c_min = 4e5, 0.5879 * 4e5
    c_s = 0.569 * c_max + 0.431 * c_min
    value, detail = printed.mean_stiffness(evidence)
    assert value == pytest.approx(c_s) and detail
    value, detail = printed.least_stiffness(evidence)
    assert value == pytest.approx(c_min) and detail
    ratios, detail = printed.damping_ratios(evidence)
    ratio = 3.9537 / (2.0 * math.sqrt(c_s * 3.123e-3))
    assert ratios["D"] == pytest.approx(ratio, rel=1e-4) and detail
    assert ratios["D of 5k"] == pytest.approx(5 * ratios["D"])
    assert ratios["5k"] == pytest.approx(5 * ratios["k"])
    levels, detail = printed.frequencies_of_the_levels(evidence)
    assert levels["nu_min"] == pytest.approx(0.66 * math.sqrt(c_s / c_min)) and detail
    assert levels["nu_max"] == pytest.approx(0.66 * math.sqrt(c_s / c_max))
    value, detail = printed.resonance_of_least_stiffness(evidence)
    assert value == pytest.approx(math.sqrt(c_min / c_s)) and detail


@pytest.mark.parametrize("teeth", [21, 40])
def test_the_standard_contact_ratio_by_hand(pair, teeth):
    """Two thirds of a wheel of module 2: the mesh line between both tip circles."""
    alpha = pair.pressure_angle
    pitch, tip = teeth, teeth + 2
    half = math.sqrt(tip**2 - (pitch * math.cos(alpha)) ** 2) - pitch * math.sin(alpha)
    expected = 2.0 * half / (2.0 * math.pi * math.cos(alpha))
    value, detail = printed.standard_contact_ratio(Evidence(pair=pair.replace(teeth=teeth)))
    assert value == pytest.approx(expected, rel=1e-12)
    assert f"R_b = {teeth * math.cos(alpha) / 2:.4f} modules" in detail
    assert "20°" in detail


def test_the_coefficients_are_compared_with_those_of_the_wave(pair, monkeypatch):
    evidence = Evidence(pair=pair)
    values, detail = printed.rectangular_wave(evidence)
    assert values["share of C_max"] == pytest.approx(0.569)
    assert values["difference"] < 1e-14
    assert detail.startswith("first 50 coefficients")
    n = np.arange(1, 51)
    wave = 2 * (1 - 0.5879) * 4e5 * np.sin(n * np.pi * 0.569) / (n * np.pi)
    for number in (0, 49):
        wrong = wave.copy()
        wrong[number] += 4e3
        monkeypatch.setattr(printed.stiffness, "fourier_amplitudes", lambda *_, wrong=wrong: wrong)
        assert printed.rectangular_wave(evidence)[0]["difference"] == pytest.approx(0.01)
    counts = []
    monkeypatch.setattr(
        printed.stiffness, "fourier_amplitudes", lambda *a: counts.append(a[-1]) or wave
    )
    printed.rectangular_wave(evidence)
    assert counts == [50]


@pytest.mark.parametrize("nu", [0.6, 0.66, 1.1])
@pytest.mark.parametrize("ratio", [0.0, 0.01])
def test_the_trace_is_that_of_the_exponential_map(pair, nu, ratio):
    """The result leaves out the decay exp(-zeta T)."""
    period = 2 * math.pi / nu
    total = np.eye(2)
    for share, level in ((0.569, pair.mesh_stiffness_max), (0.431, pair.stiffness_min)):
        rate = np.array([[0.0, 1.0], [-level / pair.stiffness_mean, -2.0 * ratio]])
        total = expm(rate * share * period) @ total
    expected = np.trace(total) * math.exp(ratio * period)
    assert printed._trace(nu, ratio, pair) == pytest.approx(expected, rel=1e-9)


def test_a_root_is_where_the_sign_changes():
    assert printed._root(lambda x: x - 0.3, 0.0, 1.0) == pytest.approx(0.3, abs=1e-7)
    assert printed._root(lambda x: 0.3 - x, 0.0, 1.0) == pytest.approx(0.3, abs=1e-7)
    for constant in (1.0, -1.0):
        assert math.isnan(printed._root(lambda x, c=constant: c, 0.0, 1.0))
    # A root at an end does not count.
    assert math.isnan(printed._root(lambda x: x, 0.0, 1.0))
    assert math.isnan(printed._root(lambda x: x - 1.0, 0.0, 1.0))


def test_the_parametric_tongue_is_where_the_multipliers_leave_the_unit_circle(pair):
    """Orbits grow just below the damping ratio that is found, and decay just above it."""
    values, detail = printed.parametric_tongue(Evidence(pair=pair))
    assert (values["from"], values["to"]) == pytest.approx((0.65562, 0.66734), abs=1e-5)
    assert values["damping ratio"] == pytest.approx(0.0089, abs=5e-5)
    assert detail

    def greatest_growth(ratio):
        found = []
        for nu in np.linspace(values["from"], values["to"], 41):
            total = np.eye(2)
            for share, level in ((0.569, pair.mesh_stiffness_max), (0.431, pair.stiffness_min)):
                rate = np.array([[0.0, 1.0], [-level / pair.stiffness_mean, -2.0 * ratio]])
                total = expm(rate * share * 2 * math.pi / nu) @ total
            found.append(np.abs(np.linalg.eigvals(total)).max())
        return max(found)

    assert greatest_growth(0.98 * values["damping ratio"]) > 1.0
    assert greatest_growth(1.02 * values["damping ratio"]) < 1.0


@dataclass
class Run:
    """What P9 reads of a run."""

    y_max: float
    y_min: float


def test_constant_coefficients_are_run_without_friction(pair, monkeypatch):
    asked = []

    def simulate(problems, tolerance):
        asked.extend(problems)
        assert tolerance == pair.tolerance
        return [Run(1.0 + problems[0].contact_ratio, 1.0)]

    monkeypatch.setattr(printed, "simulate", simulate)
    found, detail = printed.constant_coefficients(Evidence(pair=pair))
    assert found == {"ε = 1": 1.0, "ε = 2": 2.0} and detail
    assert [(p.contact_ratio, p.friction_coefficient, p.nu) for p in asked] == [
        *((1.0, 0.0, 0.66), (2.0, 0.0, 0.66)),
    ]
    assert all(p.material[1] > 0.0 for p in asked)
