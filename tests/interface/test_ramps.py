"""Runs whose speed changes linearly: what they return, their limits, and what is refused.

`tests/solvers/test_full_terms.py` holds them against DOP853.
"""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import gearmesh as gm
from gearmesh.model.variants import variant
from gearmesh.solvers.full.runs import integrate

SLOWNESS = (50, 100, 200, 400)


@pytest.fixture(scope="module")
def pair():
    return gm.paper()


@pytest.fixture(scope="module")
def run(pair):
    ramp = pair.replace(final_nu=1.1)
    return gm.simulate(ramp, "c-both", 0.7, revolutions=3, kept=2, samples_per_period=32)


def test_a_ramp_that_ends_at_its_first_speed_is_the_run_without_one_bit_for_bit(pair):
    plain = gm.simulate(pair, "c-both", 0.7, revolutions=2)
    constant = gm.simulate(pair.replace(final_nu=0.7), "c-both", 0.7, revolutions=2)
    xr.testing.assert_identical(plain.drop_attrs(), constant.drop_attrs())


def test_a_ramp_of_no_height_is_the_run_of_the_general_solver(pair):
    """The series of a phase that is quadratic in time, with no quadratic part."""
    steady = replace(pair.problem(variant("g-both"), 0.7), revolutions=2)
    ramped = replace(steady, final_nu=0.7)
    found, expected = (integrate(one, 1e-12, 8, estimate_errors=False) for one in (ramped, steady))
    np.testing.assert_allclose(found.strobe_y, expected.strobe_y, atol=1e-12, rtol=0)
    np.testing.assert_allclose(found.samples.y, expected.samples.y, atol=1e-12, rtol=0)


def test_the_speed_is_linear_in_time_and_belongs_to_each_value(pair, run):
    speed = np.polynomial.Polynomial.fit(run.time, run.nu, 1)
    assert np.abs(speed(run.time.values) - run.nu.values).max() < 1e-12
    assert run.strobe_nu.values[[0, -1]] == pytest.approx([0.7, 1.1], abs=1e-15)
    assert float(run.nu[0]) == pytest.approx(float(run.strobe_nu[21]), abs=1e-15)
    assert float(run.strobe_speed[-1]) == pytest.approx(1.1 * pair.resonance_speed)
    turned = np.trapezoid(run.nu, run.time) * pair.natural_frequency / (2 * np.pi)
    assert turned == pytest.approx(42 - 1 / 32, rel=1e-6)


def test_extremes_of_the_mesh_periods_are_those_of_the_samples_and_of_the_run(run):
    assert float(run.period_y_max.max()) == float(run.y_max)
    assert float(run.period_y_min.min()) == float(run.y_min)
    sampled = run.y_rel.values.reshape(42, 32)
    above = run.period_y_max_rel.values - sampled.max(axis=1)
    below = sampled.min(axis=1) - run.period_y_min_rel.values
    for beyond in (above, below):
        assert beyond.min() > -1e-9  # the last steps of the series may lie apart by the tolerance
        assert beyond.max() < 0.02


def test_the_samples_are_equally_spaced_in_the_angle_so_orders_hold(run):
    orders = gm.spectrum(run, "stiffness").stiffness
    assert float(orders.order[-1]) == 16.0
    strong = orders.order.values[orders > 1e-9 * orders[0]]
    assert set(strong) <= {float(order) for order in range(17)}


def test_a_run_continues_a_ramp_at_its_last_speed(pair, run):
    held = gm.simulate(pair, "c-both", 1.1, start=run, revolutions=1)
    assert float(held.strobe_y[0]) == pytest.approx(float(run.strobe_y[-1]), rel=1e-12)
    assert float(held.strobe_v[0]) == pytest.approx(float(run.strobe_v[-1]), rel=1e-12)


def test_a_speed_in_rpm_is_the_same_ramp(pair):
    stated = pair.replace(final_speed="4200 rpm")
    assert stated.final_nu == pytest.approx(4200 / pair.resonance_speed, abs=1e-10)
    assert stated.final_speed == 4200.0
    assert stated.replace(final_nu=0.9).final_speed == pytest.approx(0.9 * pair.resonance_speed)
    assert stated.replace(final_speed=None).final_speed is None


def test_slow_ramps_jump_up_behind_the_fold_and_stay_up_on_the_way_down(pair):
    """A passage through a fold is late by the 2/3rd power of the rate (Haberman, 1979)."""
    orbit = gm.find_orbit(pair, "b-material", 0.78)
    [fold] = [
        point.nu for point in gm.follow(orbit, "nu", (0.75, 0.85)).special if point.kind == "fold"
    ]
    small = gm.simulate(pair, "b-material", 0.75, revolutions=20, samples_per_period=4)
    up = pair.replace(final_nu=0.9, samples_per_period=4)
    delays = []
    for revolutions in SLOWNESS:
        ramp = gm.simulate(
            up, "b-material", 0.75, start=small, revolutions=revolutions, kept=revolutions
        )
        steepest = int(np.abs(np.diff(ramp.period_y_max_rel)).argmax())
        delays.append(float(ramp.period_nu[steepest]) - fold)
    assert min(delays) > 0.0
    fitted = np.polyfit(np.log(SLOWNESS), np.log(delays), 1)[0]
    assert fitted == pytest.approx(-2 / 3, abs=0.08)

    down = gm.simulate(
        up.replace(final_nu=0.75), "b-material", 0.9, start=ramp, revolutions=100, kept=100
    )
    speeds = np.array([0.78, 0.8, 0.85])
    swept = gm.sweep(pair, "b-material", [*speeds, 0.9], direction="down", revolutions=20)
    height = np.interp(speeds, down.period_nu[::-1], down.period_y_max_rel[::-1])
    assert height == pytest.approx(swept.y_max_rel.values[0, :3], abs=2e-3)
    assert height[0] > 1.6 * float(orbit.to_dataset().y_max_rel)


@pytest.mark.parametrize(
    "request_it",
    [
        lambda pair: gm.find_orbit(pair, "b-material", 0.7),
        lambda pair: gm.sweep(pair, "b-material", [0.7]),
        lambda pair: gm.campbell(pair, "b-material", [0.7]),
        lambda pair: gm.attractors(pair, "b-material", 0.7),
        lambda pair: gm.lyapunov_spectrum(pair, "b-material", 0.7),
        lambda pair: gm.basins(pair, "b-material", 0.7, y=[1.0], v=[0.0]),
    ],
)
def test_what_has_one_speed_refuses_a_ramp(pair, request_it):
    with pytest.raises(gm.InputError, match=r"final_nu: found 0\.9; .* constant speed"):
        request_it(pair.replace(final_nu=0.9))


def test_a_sweep_over_the_end_of_a_ramp_is_refused(pair):
    with pytest.raises(gm.InputError, match=r"final_nu: found 0\.8"):
        gm.sweep(pair, "b-material", [0.7], over={"final_nu": [0.8, 0.9]})


@pytest.mark.parametrize("name", ["final_nu", "final_speed"])
@pytest.mark.parametrize("value", ["0", "-1", "1e7"])
def test_a_ramp_through_standstill_is_refused(pair, name, value):
    value = float(value) if name == "final_nu" else f"{value} rpm"
    with pytest.raises(gm.InputError, match=rf"^{name}: .*out of range; allowed is"):
        pair.replace(**{name: value})


def test_both_ends_of_a_ramp_may_not_be_stated(pair):
    with pytest.raises(gm.InputError, match="final_speed: stated beside final_nu"):
        pair.replace(final_nu=0.9, final_speed="3000 rpm")
