"""What the general solver must obey where no closed form is known: errors, shifts, samples."""

import math
from dataclasses import replace

import numpy as np
import pytest
from problems import problem

from gearmesh.model.contact import CONTACT_LOSS, NORMAL_MESH
from gearmesh.solvers.full import runs as general
from gearmesh.solvers.full.runs import integrate
from gearmesh.solvers.simulation import simulate


def strobes(response):
    return np.stack([response.strobe_y, response.strobe_v], axis=1)


GENERAL = problem(
    0.7,
    "c-both",
    eccentricity_3=0.5,
    eccentricity_2=0.3,
    eccentricity_angle=1.0,
    deviation=((0.1, 0.05),),
    stiffness_harmonics=5,
)


def test_achieved_error_follows_the_tolerance():
    exact = strobes(integrate(GENERAL, 1e-14, estimate_errors=False))
    for tolerance in (1e-6, 1e-8, 1e-10, 1e-12):
        found = strobes(integrate(GENERAL, tolerance, estimate_errors=False))
        assert np.abs(found - exact).max() < 50 * tolerance


def test_the_order_of_the_series_changes_nothing():
    reference = strobes(integrate(GENERAL, 1e-12))
    for order in (12, 24):
        found = strobes(integrate(GENERAL, 1e-12, order=order))
        np.testing.assert_allclose(found, reference, atol=1e-10)


def test_estimated_errors_bound_the_achieved_ones():
    response = integrate(GENERAL, 1e-8)
    exact = integrate(GENERAL, 1e-14)
    assert abs(response.y_max - exact.y_max) <= response.y_max_error < 1e-5
    assert abs(response.y_min - exact.y_min) <= response.y_min_error < 1e-5
    assert not response.sensitive
    assert math.isnan(integrate(GENERAL, 1e-8, estimate_errors=False).y_max_error)


def test_chaos_is_flagged():
    chaotic = problem(0.75, "a-conservative")
    assert integrate(chaotic, 1e-10).sensitive


@pytest.mark.parametrize(
    ("case", "periods"),
    [(replace(GENERAL, eccentricity_3=0.0, eccentricity_2=0.0), 1), (GENERAL, 21)],
)
def test_whole_periods_shift_nothing(case, periods):
    """A mesh period without run-out, a turn of the wheels with it."""
    shifted = replace(case, initial_phase=case.initial_phase + periods)
    np.testing.assert_allclose(
        strobes(integrate(shifted, 1e-12)), strobes(integrate(case, 1e-12)), atol=1e-10
    )


def test_samples_fit_the_extrema_and_the_regimes():
    case = replace(GENERAL, lubricant=(0.0, 0.2, 0.0), material=(0.0, 0.0, 0.0), nu=0.85)
    response = integrate(case, 1e-11, 256)
    samples = response.samples
    assert len(samples.time) == 21 * 256
    np.testing.assert_allclose(np.diff(samples.time), response.period / 256, rtol=1e-9)
    assert samples.y.max() <= response.y_max + 1e-12
    assert response.y_max - samples.y.max() < 1e-3
    np.testing.assert_array_equal(samples.regime == NORMAL_MESH, samples.y >= 0.0)
    assert np.mean(samples.regime == CONTACT_LOSS) == pytest.approx(
        response.contact_loss_fraction, abs=0.01
    )
    assert response.y_rms == pytest.approx(np.sqrt(np.mean(samples.y**2)), abs=1e-4)
    np.testing.assert_allclose(
        np.gradient(samples.y, samples.time)[1:-1], samples.v[1:-1], atol=0.02
    )
    kinds = response.extremum_kind
    assert (kinds[1:] * kinds[:-1] < 0).all()
    np.testing.assert_allclose(
        np.interp(response.extremum_time, samples.time, samples.y), response.extremum_y, atol=1e-3
    )


def test_acceleration_jumps_where_the_stiffness_switches():
    """Points A and B: jumps of y'' at the switches, and none elsewhere in normal mesh."""
    case = problem(0.8, "c-material", eccentricity_3=0.3, friction_coefficient=0.0)
    samples = integrate(case, 1e-10, 2048).samples
    assert (samples.regime == NORMAL_MESH).all()
    jumps = np.abs(np.diff(samples.a))
    switched = np.diff(samples.stiffness) != 0.0
    assert switched.sum() == 2 * 21
    assert jumps[switched].min() > 10 * jumps[~switched].max()


def test_a_run_goes_on_where_another_ended():
    case = replace(GENERAL, eccentricity_3=0.0, eccentricity_2=0.0)
    long = integrate(replace(case, revolutions=2), 1e-12)
    first = integrate(replace(case, revolutions=1), 1e-12)
    second = integrate(replace(case, revolutions=1, initial_state=first.final_state), 1e-12)
    np.testing.assert_allclose(second.strobe_y[1:], long.strobe_y[22:], atol=1e-10)
    np.testing.assert_allclose(second.extremum_y, long.extremum_y, atol=1e-10)


def test_a_run_that_takes_too_many_steps_says_so(monkeypatch):
    monkeypatch.setattr(general.limits, "most_steps", lambda problem: 100.0)
    response = integrate(GENERAL)
    assert response.status == "step_limit"
    assert math.isnan(response.y_max)


def test_run_outs_that_cancel_each_other_are_told():
    """The bracket of eq. (6) vanishes identically, and its sign has no meaning."""
    case = problem(0.7, eccentricity_3=1.0, eccentricity_2=1.0, eccentricity_angle=math.pi)
    assert integrate(case).status == "friction_undefined"
    assert integrate(replace(case, friction_coefficient=0.0)).status == "ok"


def test_the_room_for_extrema_follows_the_need(monkeypatch):
    before = integrate(GENERAL)
    monkeypatch.setattr(general, "_EXTREMA_PER_PERIOD", 1)
    after = integrate(GENERAL)
    np.testing.assert_array_equal(after.extremum_y, before.extremum_y)
    assert len(after.extremum_y) > 21


def test_both_solvers_answer_through_one_door():
    one, two = simulate([GENERAL, problem(0.7, "c-both")])
    assert one.y_max == integrate(GENERAL).y_max
    assert two.y_max != one.y_max
