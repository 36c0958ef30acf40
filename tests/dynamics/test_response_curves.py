"""Features of response curves that are drawn by hand."""

import numpy as np
import pytest
from curves import Drawn, heights

from gearmesh.dynamics import response_curves as curves
from gearmesh.dynamics.response_curves import WIDTH, Jump, ResponseCurve
from gearmesh.model.variants import variant
from gearmesh.solvers.response import MAXIMUM, MINIMUM, Response
from gearmesh.solvers.simulation import simulate


@pytest.mark.parametrize("place", [0.6601, 0.7, 0.76249, 0.799])
@pytest.mark.parametrize("smeared", [0.0, 2e-4])
def test_a_jump_is_found_where_it_is_even_if_the_fifth_revolution_smears_it(place, smeared):
    def height(nu):
        return 1.0 + np.clip((nu - place) / (smeared or 1e-12), 0.0, 1.0)

    found = curves.jumps(heights(height), 0.6, 1.0)
    assert [jump.nu for jump in found] == [pytest.approx(place + smeared / 2, abs=smeared + WIDTH)]
    assert found[0].step > 0.9


@pytest.mark.parametrize("width", [0.005, 0.02, 0.1])
def test_a_steep_slope_is_no_jump(width):
    curve = heights(lambda nu: 1.0 + np.clip((nu - 0.71234) / width, 0.0, 1.0))
    assert curves.jumps(curve, 0.6, 1.0) == []


def test_steps_below_the_visible_are_no_jumps():
    curve = heights(lambda nu: 1.0 + 0.9 * curves.SMALLEST_JUMP * (nu > 0.7))
    assert curves.jumps(curve, 0.6, 1.0) == []


def test_a_jump_down_has_a_negative_step():
    (jump,) = curves.jumps(heights(lambda nu: 2.0 - (nu > 0.7)), 0.6, 1.0)
    assert jump.step == -1.0


def test_scans_share_their_places():
    whole = curves.scan(0.6, 1.2)
    assert whole.size == 241
    assert (whole[0], whole[-1]) == (0.6, 1.2)
    part = curves.scan(0.76543, 1.1)
    assert part[0] == 0.76543
    assert set(part[1:]) < set(whole)
    assert np.diff(part).max() <= curves.SCAN * (1 + 1e-9)
    assert curves.scan(0.7, 0.7).tolist() == [0.7]
    assert curves.scan(0.8, 0.7).size == 0


def test_only_great_rises_count():
    steps = {0.62: 0.3, 0.65: 1.2, 0.67: 1.5, 0.69: -1.4, 0.80: 9.0}
    found = [Jump(nu, step) for nu, step in steps.items()]
    assert curves.great_rises(found, 0.6, 0.73) == [0.65, 0.67]
    assert curves.great_rises(found, 0.74, 0.79) == []


def test_continuity_is_the_step_that_is_left():
    jumping = curves.largest_step(heights(lambda nu: nu + 0.3 * (nu > 0.9)), 0.6, 1.2)
    assert jumping.step == pytest.approx(0.3, abs=2 * WIDTH)
    assert jumping.nu == pytest.approx(0.9, abs=WIDTH)
    steep = curves.largest_step(heights(lambda nu: 40 * nu), 0.6, 1.2)
    assert steep.step <= 40 * WIDTH


def test_loops_end_where_four_turning_points_become_two_for_good():
    def turning(nu):
        return {"turning_points_per_period": 4.0 if nu < 0.62 or 0.63 < nu < 0.6412 else 2.0}

    assert curves.loop_end(Drawn(turning), 0.5, 1.2) == pytest.approx(0.6412, abs=WIDTH)
    assert curves.loop_end(Drawn(turning), 0.65, 1.2) is None


def test_an_onset_is_where_the_spread_is_visible_for_good():
    def spread(nu):
        return np.where((nu > 1.1234) | (np.abs(nu - 1.05) < 0.01), 1.0, 0.0)

    curve = heights(lambda nu: 1.0)
    assert curves.onset(curve, spread, 1.0, 1.2) == pytest.approx(1.1234, abs=WIDTH)
    assert curves.onset(curve, lambda nu: np.zeros(nu.size), 1.0, 1.2) is None
    assert curves.onset(curve, lambda nu: np.ones(nu.size), 1.0, 1.2) is None


def test_intervals_of_exceedance_begin_and_end_at_the_crossings_or_the_range():
    wave = heights(lambda nu: np.cos(20 * np.pi * (nu - 0.61)))
    zero = heights(lambda nu: 0.0)
    found = curves.exceedance(wave, zero, 0.6, 0.8)
    np.testing.assert_allclose(found, [[0.6, 0.635], [0.685, 0.735], [0.785, 0.8]], atol=WIDTH)
    assert curves.exceedance(heights(lambda nu: -1.0), zero, 0.6, 0.8) == []


def test_a_peak_at_the_edge_of_a_range_is_found():
    assert curves.peak(heights(lambda nu: 3.0 - nu), 0.75, 1.2) == (0.75, 2.25)


def test_the_largest_rise_of_a_curve_that_falls_is_zero():
    assert curves.largest_rise(heights(lambda nu: -nu), 0.75, 1.2) == 0.0
    rising = heights(lambda nu: -nu + 0.5 * (nu > 0.9))
    assert curves.largest_rise(rising, 0.75, 1.2) == pytest.approx(0.5 - curves.SCAN)


def test_the_difference_of_two_curves_is_relative_and_the_greatest():
    one, other = heights(lambda nu: 2.0), heights(lambda nu: 2.0 + 0.2 * (nu > 1.1))
    assert curves.relative_difference(one, other, 0.6, 1.2) == pytest.approx(0.1)


@pytest.mark.parametrize(("kind", "spread"), [(MAXIMUM, 0.4), (MINIMUM, 0.1)])
def test_of_each_period_the_outermost_extremum_counts(kind, spread):
    response = Response(
        "ok",
        1.0,
        extremum_time=np.array([0.1, 0.3, 0.5, 0.8, 1.2, 1.7]),
        extremum_y=np.array([2.0, 0.0, 1.0, -0.5, 2.4, -0.6]),
        extremum_kind=np.array([1, -1, 1, -1, 1, -1], np.int8),
    )
    assert curves.extremum_spread(kind)(response) == pytest.approx(spread)
    assert curves.extremum_spread(kind)(Response("ok", 1.0)) == 0.0


def test_spread_between_curves_is_a_median_that_one_jump_does_not_move():
    one = heights(lambda nu: 2.0)
    other = heights(lambda nu: 2.2 if nu < 0.79 else 9.0)
    assert curves.typical_spread([one, other], 0.66, 0.8) == pytest.approx(0.2 / 2.1)


def test_each_run_is_integrated_once(pair, monkeypatch):
    asked = []

    def counting(problems, *args, **kwargs):
        asked.extend(problem.nu for problem in problems)
        return simulate(problems, *args, **kwargs)

    monkeypatch.setattr(curves, "simulate", counting)
    chosen = variant("d-material")
    curve = ResponseCurve(lambda nu: pair.problem(chosen, nu), pair.tolerance, chosen.name)
    first = curve.of(curves.y_max)(np.array([0.7, 0.8, 0.7]))
    again = curve.of(curves.y_max)(np.array([0.8, 0.7]))
    assert asked == [0.7, 0.8]
    assert first.tolist() == [again[1], again[0], again[1]]
