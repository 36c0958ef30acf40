"""Closed forms and limits, for both solvers."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from independent import energy, linear_strobes, period_map_trace
from problems import problem
from scipy.optimize import brentq

from gearmesh.model.contact import CONTACT_LOSS
from gearmesh.model.motion import start
from gearmesh.model.problem import State
from gearmesh.solvers.full.runs import integrate
from gearmesh.solvers.response import MAXIMUM
from gearmesh.solvers.simulation import simulate

IMMOVABLE = 1e30
"""Body mass with which y_3 - y_2 keeps its value, so that y'' = 1 - N is all that is left."""


def sweep(case, tolerance=1e-10, samples_per_period=0, estimate_errors=True):
    return simulate([case], tolerance, samples_per_period, estimate_errors)[0]


@pytest.fixture(params=[integrate, sweep], ids=["general", "sweep"])
def solve(request):
    """Return a solver of one run."""
    return request.param


def strobes(response):
    return np.stack([response.strobe_y, response.strobe_v], axis=1)


def oscillator(y, v=0.0, c=1.0, **changes):
    """Return an undamped oscillator y'' = 1 - c y that starts at (y, v)."""
    return problem(
        0.9,
        "a-conservative",
        **{
            "stiffness_max": c,
            "stiffness_min": c,
            "body_mass": IMMOVABLE,
            "friction_coefficient": 0.0,
            "initial_state": State(y, v, 0.0, 0.0),
            **changes,
        },
    )


@pytest.mark.parametrize(
    "changes",
    [
        # Without damping in the mesh contact is kept where the stiffness hardly changes.
        {"material": (0.0, 0.0, 0.0), "stiffness_min": 0.98, "stiffness_max": 1.01},
        {"material": (0.6, 0.0, 0.0)},
        {"material": (0.6, 0.0, 0.0), "bearing_stiffness": 20.0, "initial_phase": 0.4},
    ],
)
def test_linear_regime_agrees_with_matrix_exponentials(solve, changes):
    case = problem(0.7, friction_coefficient=0.0, kept_revolutions=5, **changes)
    response = solve(case, 1e-13)
    assert response.y_min > 0.0
    np.testing.assert_allclose(strobes(response), linear_strobes(case), atol=1e-11, rtol=0)


def test_free_flight_is_a_parabola(solve):
    """With y = 1 + 2 cos t, contact is left at v = -sqrt(3) and regained 2 sqrt(3) later."""
    response = solve(oscillator(3.0, backlash=2.0), 1e-12, 64)
    period = 2.0 * (math.pi - math.acos(0.5)) + 2.0 * math.sqrt(3.0)
    maxima = response.extremum_kind == MAXIMUM
    np.testing.assert_allclose(response.extremum_y[maxima], 3.0, atol=1e-9)
    np.testing.assert_allclose(response.extremum_y[~maxima], -1.5, atol=1e-9)
    np.testing.assert_allclose(np.diff(response.extremum_time), 0.5 * period, atol=1e-10)
    share = 2.0 * math.sqrt(3.0) / period
    assert response.contact_loss_fraction == pytest.approx(share, abs=0.02)
    flying = response.samples.regime == CONTACT_LOSS
    np.testing.assert_allclose(response.samples.a[flying], 1.0, atol=1e-9)
    np.testing.assert_allclose(
        response.samples.a[~flying], 1.0 - response.samples.y[~flying], atol=1e-9
    )


def test_back_flank_contact_in_closed_form(solve):
    """Energy gives the turning point beyond -s: depth^2 / 2 - (s + depth) ... = (y - 1)^2 / 2."""
    backlash = 0.5
    response = solve(oscillator(3.0, backlash=backlash), 1e-12)
    level = 0.5 * 3.0**2 - 3.0
    # depth^2 / 2 + backlash + depth = level
    depth = math.sqrt(1.0 + 2.0 * (level - backlash)) - 1.0
    np.testing.assert_allclose(response.y_min, -backlash - depth, atol=1e-10)
    assert response.y_max == pytest.approx(3.0, abs=1e-10)
    assert response.inverse_mesh_fraction > 0.1


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-12])
def test_grazing_contact_loss_is_not_missed(solve, depth):
    """y = 1 + (1 + depth) cos t dips through 0 for a time of 2 sqrt(2 depth)."""
    response = solve(oscillator(2.0 + depth, revolutions=1), 1e-15)
    duration = 21 * response.period
    dips = int(duration / (2.0 * math.pi) + 0.5)
    assert response.n_contact_losses == dips
    assert response.y_min == pytest.approx(-depth, rel=0.01, abs=1e-13)
    lost = dips * 2.0 * math.sqrt(2.0 * depth) / duration
    assert response.contact_loss_fraction == pytest.approx(lost, rel=0.02)


def test_grazing_from_above_loses_no_contact(solve):
    response = solve(oscillator(2.0 - 1e-9, revolutions=1), 1e-13)
    assert response.n_contact_losses == 0
    assert response.y_min == pytest.approx(1e-9, rel=0.01)


@pytest.mark.parametrize("backlash", [5.0, 0.4])
def test_energy_is_conserved_through_contact_loss_and_back_flank_contact(backlash):
    case = oscillator(
        4.0,
        c=0.9,
        body_mass=3.0,
        bearing_damping_ratio=0.0,
        backlash=backlash,
        initial_state=State(4.0, 0.8, -2.0, 0.3),
    )
    response = integrate(case, 1e-13, order=18)
    assert response.n_contact_losses > 5
    assert (response.inverse_mesh_fraction > 0) == (backlash < 1)
    before = energy(case, np.concatenate(start(case)), 0.9)
    after = energy(case, np.array(response.final_state.coordinates), 0.9)
    assert after == pytest.approx(before, abs=1e-9)


def trace(solve, nu, damping=0.0):
    """Return the trace of the period map of y'' + 2 damping y' + C(t) y = 1."""
    starts = [(1.0, 0.0), (1.1, 0.0), (1.0, 0.1)]
    ends = []
    for y, v in starts:
        case = problem(
            nu,
            "a-conservative",
            material=(2.0 * damping, 0.0, 0.0),
            body_mass=IMMOVABLE,
            friction_coefficient=0.0,
            teeth=1,
            revolutions=1,
            # From here contact is not lost within the period.
            initial_phase=0.75,
            initial_state=State(y, v, 0.0, 0.0),
        )
        response = solve(case, 1e-13, estimate_errors=False)
        assert response.y_min > 0.0
        ends.append(strobes(response)[1])
    return period_map_trace(np.array(starts), np.array(ends))


def test_floquet_multipliers_leave_the_unit_circle_in_the_third_tongue(solve):
    """At its edges the multipliers are -1 twice: the trace of the period map is -2."""
    low = brentq(lambda nu: trace(solve, nu) + 2.0, 0.650, 0.660, xtol=1e-7)
    high = brentq(lambda nu: trace(solve, nu) + 2.0, 0.662, 0.672, xtol=1e-7)
    assert low == pytest.approx(0.65562, abs=6e-6)
    assert high == pytest.approx(0.66734, abs=6e-6)


def test_the_third_tongue_vanishes_above_a_damping_ratio(solve):
    """Multipliers -m and -d/m with the product d: one leaves at the trace -(1 + d)."""

    def margin(nu, damping):
        product = math.exp(-2.0 * damping * 2.0 * math.pi / nu)
        return trace(solve, nu, damping) + 1.0 + product

    middle = np.linspace(0.6605, 0.6625, 5)
    assert min(margin(nu, 0.00885) for nu in middle) < 0.0
    assert min(margin(nu, 0.00895) for nu in middle) > 0.0


LIMITS = [
    ({"contact_ratio": 1.0}, "stiffness_min"),
    ({"contact_ratio": 2.0}, "stiffness_max"),
    ({"contact_ratio": 1.0, "stiffness_harmonics": 3}, "stiffness_min"),
]


@pytest.mark.parametrize(("changes", "level"), LIMITS)
def test_limits_have_constant_coefficients(solve, changes, level):
    case = replace(
        problem(0.8, "c-both", friction_coefficient=0.0, initial_state=State(2.0, 0.0, -2.0, 0.0)),
        **changes,
    )
    constant = getattr(case, level)
    if case.stiffness_harmonics:
        constant = case.stiffness_min
    plain = replace(
        case,
        contact_ratio=1.5,
        stiffness_max=constant,
        stiffness_min=constant,
        stiffness_harmonics=0,
    )
    np.testing.assert_allclose(
        strobes(solve(case, 1e-12)), strobes(solve(plain, 1e-12)), atol=1e-10
    )


def test_static_equilibrium_stays_where_it_is(solve):
    case = problem(0.8, "b-both", stiffness_max=1.0, stiffness_min=1.0, friction_coefficient=0.0)
    response = solve(case, 1e-10)
    assert response.y_max == pytest.approx(1.0, abs=1e-12)
    assert response.y_min == pytest.approx(1.0, abs=1e-12)


REDUCIBLE = [
    problem(0.66, "c-material"),
    problem(0.7, "e-lubricant"),
    problem(0.9, "d-both", friction_coefficient=0.1, initial_phase=0.37),
    problem(0.85, "g-both", backlash=0.4),
    problem(0.75, "h-both", bearing_stiffness=20.0, body_mass=8.0),
]


@pytest.mark.parametrize("case", REDUCIBLE, ids=lambda case: f"nu={case.nu}")
def test_full_coordinates_agree_with_the_reduced_system(case):
    full, reduced = integrate(case, 1e-12, 32), simulate([case], 1e-12, 32)[0]
    np.testing.assert_allclose(strobes(full), strobes(reduced), atol=1e-9, rtol=0)
    np.testing.assert_allclose(full.extremum_time, reduced.extremum_time, atol=1e-7)
    np.testing.assert_allclose(full.extremum_y, reduced.extremum_y, atol=1e-9)
    np.testing.assert_array_equal(full.extremum_kind, reduced.extremum_kind)
    for name in ("y_max", "y_min", "y_rms", "contact_loss_fraction", "inverse_mesh_fraction"):
        assert getattr(full, name) == pytest.approx(getattr(reduced, name), abs=1e-9), name
    assert full.n_contact_losses == reduced.n_contact_losses
    for name in ("y", "v", "b", "b_rate"):
        ends = (getattr(response.final_state, name) for response in (full, reduced))
        assert next(ends) == pytest.approx(next(ends), abs=1e-9)
    for name in (
        "time",
        "y",
        "v",
        "a",
        "stiffness",
        "modified_stiffness",
        "force_dynamic",
        "force_friction",
        "regime",
    ):
        np.testing.assert_allclose(
            getattr(full.samples, name), getattr(reduced.samples, name), atol=1e-8, err_msg=name
        )


def test_truncated_stiffness_converges_to_the_wave():
    case = problem(0.75, "b-both", friction_coefficient=0.0, revolutions=1)
    wave = strobes(integrate(case, 1e-11))
    errors = []
    for terms in (4, 16, 64, 256):
        smooth = integrate(replace(case, stiffness_harmonics=terms), 1e-11, estimate_errors=False)
        errors.append(np.abs(strobes(smooth) - wave).max())
    # Errors at the jumps average out over a period: faster than the 1 / n of the series.
    assert all(b < 0.35 * a for a, b in pairwise(errors))
    assert errors[-1] < 1e-4


def test_run_out_appears_at_the_frequency_of_rotation():
    """Quasi-static: soft excitation far below resonance moves the wheels, not the mesh."""
    case = problem(
        0.8,
        "b-both",
        friction_coefficient=0.0,
        stiffness_max=1.0,
        stiffness_min=1.0,
        eccentricity_3=0.5,
        kept_revolutions=2,
    )
    turned = integrate(case, 1e-11, 64)
    y = turned.samples.y - turned.samples.y.mean()
    spectrum = np.abs(np.fft.rfft(y))
    # Two kept revolutions: the second line is one a turn.
    assert np.argmax(spectrum) == 2
    # y'' + 2 D y' + y = 1 + e_3 (sin omega t)'' but for the bodies.
    omega = 0.8 / 21
    assert 2 * spectrum[2] / len(y) == pytest.approx(0.5 * omega**2, rel=0.25)


def test_profile_deviation_shakes_the_mesh_at_its_frequency():
    """A single degree of freedom has the closed-form response to f = a cos(nu t)."""
    case = problem(
        0.8,
        "b-material",
        friction_coefficient=0.0,
        stiffness_max=1.0,
        stiffness_min=1.0,
        body_mass=IMMOVABLE,
        deviation=((0.1, 0.0),),
        revolutions=20,
    )
    response = integrate(case, 1e-11)
    k = case.material[0]
    amplitude = 0.1 * 0.8**2 / math.hypot(1.0 - 0.8**2, k * 0.8)
    assert response.y_max == pytest.approx(1.0 + amplitude, abs=1e-9)
    assert response.y_min == pytest.approx(1.0 - amplitude, abs=1e-9)


def test_a_run_that_leaves_every_scale_has_diverged(solve):
    assert solve(oscillator(1e12)).status == "diverged"
