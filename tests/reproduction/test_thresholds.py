import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.data import paths
from gearmesh.dynamics.refinement import refine_change, refine_peak, refine_step
from gearmesh.model.variants import variant
from gearmesh.reproduction import thresholds
from gearmesh.solvers.response import MAXIMUM, MINIMUM, Response
from gearmesh.solvers.simulation import simulate
from gearmesh.study.loading import load_study

WIDTH = thresholds.WIDTH


class Drawn(thresholds.Courses):
    """Courses drawn by hand: nu -> fields of the response."""

    def __init__(self, draw):
        self._draw = draw

    def at(self, nu):
        return [replace(Response("ok", 1.0), **self._draw(float(x))) for x in nu]


def heights(function):
    return Drawn(lambda nu: {"y_max": float(function(nu))})


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


def test_no_change_is_an_error_not_an_answer():
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


def test_a_step_beside_failed_runs_is_still_found():
    def values(nu):
        return np.where(nu > 0.9, np.nan, np.where(nu > 0.7, 2.0, 1.0))

    low, high, step = refine_step(values, 0.6, 1.2, WIDTH)
    assert low <= 0.7 <= high
    assert step == 1.0


@given(st.floats(0.61, 1.19))
def test_a_peak_is_located(place):
    nu, height = refine_peak(lambda x: -np.abs(x - place), 0.6, 1.2, WIDTH)
    assert nu == pytest.approx(place, abs=WIDTH / 2)
    assert height == -abs(nu - place)


@pytest.mark.parametrize("place", [0.6601, 0.7, 0.76249, 0.799])
@pytest.mark.parametrize("smeared", [0.0, 2e-4])
def test_a_jump_is_found_where_it_is_even_if_the_fifth_revolution_smears_it(place, smeared):
    def height(nu):
        return 1.0 + np.clip((nu - place) / (smeared or 1e-12), 0.0, 1.0)

    found = thresholds.jumps(heights(height), 0.6, 1.0)
    assert [jump["nu"] for jump in found] == [
        pytest.approx(place + smeared / 2, abs=smeared + WIDTH)
    ]
    assert found[0]["step"] > 0.9


@pytest.mark.parametrize("width", [0.005, 0.02, 0.1])
def test_a_steep_slope_is_no_jump(width):
    course = heights(lambda nu: 1.0 + np.clip((nu - 0.71234) / width, 0.0, 1.0))
    assert thresholds.jumps(course, 0.6, 1.0) == []


def test_steps_below_the_visible_are_no_jumps():
    course = heights(lambda nu: 1.0 + 0.9 * thresholds.SMALLEST_JUMP * (nu > 0.7))
    assert thresholds.jumps(course, 0.6, 1.0) == []


def test_scans_share_their_places():
    whole = thresholds.scan(0.6, 1.2)
    assert whole.size == 241
    assert (whole[0], whole[-1]) == (0.6, 1.2)
    part = thresholds.scan(0.76543, 1.1)
    assert part[0] == 0.76543
    assert set(part[1:]) < set(whole)
    assert np.diff(part).max() <= thresholds.SCAN * (1 + 1e-9)
    assert thresholds.scan(0.7, 0.7).tolist() == [0.7]
    assert thresholds.scan(0.8, 0.7).size == 0


def test_only_great_rises_count():
    found = [
        {"nu": 0.62, "step": 0.3},
        {"nu": 0.65, "step": 1.2},
        {"nu": 0.67, "step": 1.5},
        {"nu": 0.69, "step": -1.4},
        {"nu": 0.80, "step": 9.0},
    ]
    assert thresholds.great_rises(found, 0.6, 0.73) == [0.65, 0.67]
    assert thresholds.great_rises(found, 0.74, 0.79) == []


def test_continuity_is_the_step_that_is_left():
    jumping = thresholds.largest_step(heights(lambda nu: nu + 0.3 * (nu > 0.9)), 0.6, 1.2)
    assert jumping["step"] == pytest.approx(0.3, abs=2 * WIDTH)
    assert jumping["nu"] == pytest.approx(0.9, abs=WIDTH)
    steep = thresholds.largest_step(heights(lambda nu: 40 * nu), 0.6, 1.2)
    assert steep["step"] <= 40 * WIDTH


def test_loops_end_where_four_turning_points_become_two_for_good():
    def turning(nu):
        return {"turning_points_per_period": 4.0 if nu < 0.62 or 0.63 < nu < 0.6412 else 2.0}

    assert thresholds.loop_end(Drawn(turning), 0.5, 1.2) == pytest.approx(0.6412, abs=WIDTH)
    assert thresholds.loop_end(Drawn(turning), 0.65, 1.2) is None


def test_the_last_loop_closes_at_its_smallest_pair_of_extrema():
    def extrema(nu):
        return {
            "extremum_time": np.array([0.10, 0.30, 0.32, 0.70]),
            "extremum_y": np.array([0.2, 1.3, 1.29, 1.6]),
        }

    assert thresholds.loop_place(Drawn(extrema), 0.64, 0.9) == pytest.approx(0.21)


def test_an_onset_is_where_the_spread_is_visible_for_good():
    def spread(nu):
        return np.where((nu > 1.1234) | (np.abs(nu - 1.05) < 0.01), 1.0, 0.0)

    courses = heights(lambda nu: 1.0)
    assert thresholds.onset(courses, spread, 1.0, 1.2) == pytest.approx(1.1234, abs=WIDTH)
    assert thresholds.onset(courses, lambda nu: np.zeros(nu.size), 1.0, 1.2) is None
    assert thresholds.onset(courses, lambda nu: np.ones(nu.size), 1.0, 1.2) is None


def test_intervals_of_exceedance_begin_and_end_at_the_crossings_or_the_range():
    wave = heights(lambda nu: np.cos(20 * np.pi * (nu - 0.61)))
    zero = heights(lambda nu: 0.0)
    found = thresholds.exceedance(wave, zero, 0.6, 0.8)
    np.testing.assert_allclose(found, [[0.6, 0.635], [0.685, 0.735], [0.785, 0.8]], atol=WIDTH)
    assert thresholds.exceedance(heights(lambda nu: -1.0), zero, 0.6, 0.8) == []


def test_a_peak_at_the_edge_of_a_range_is_there():
    falling = thresholds.peak(heights(lambda nu: 3.0 - nu), 0.75, 1.2)
    assert falling == {"nu": 0.75, "y_max": 2.25}


@pytest.mark.parametrize(("kind", "spread"), [(MAXIMUM, 0.4), (MINIMUM, 0.1)])
def test_of_each_period_the_outermost_extremum_counts(kind, spread):
    response = Response(
        "ok",
        1.0,
        extremum_time=np.array([0.1, 0.3, 0.5, 0.8, 1.2, 1.7]),
        extremum_y=np.array([2.0, 0.0, 1.0, -0.5, 2.4, -0.6]),
        extremum_kind=np.array([1, -1, 1, -1, 1, -1], np.int8),
    )
    assert thresholds.extremum_spread(kind)(response) == pytest.approx(spread)
    assert thresholds.extremum_spread(kind)(Response("ok", 1.0)) == 0.0


def test_spread_between_courses_is_a_median_that_one_jump_does_not_move():
    one = heights(lambda nu: 2.0)
    other = heights(lambda nu: 2.2 if nu < 0.79 else 9.0)
    spread = thresholds.typical_spread([one, other], 0.66, 0.8)
    assert spread == pytest.approx(0.2 / 2.1)


def test_failed_runs_are_not_a_number_and_stop_nothing():
    course = Drawn(
        lambda nu: {"status": "step_limit"} if nu > 0.7 else {"y_max": 1.0 + (nu > 0.65)}
    )
    assert np.isnan(course.of(thresholds.highest)([0.8])).all()
    assert [j["nu"] for j in thresholds.jumps(course, 0.6, 1.0)] == [pytest.approx(0.65, abs=WIDTH)]


@pytest.fixture(scope="module")
def parameters():
    return load_study(paths.PAPER).pair


def test_responses_are_run_once(parameters, monkeypatch):
    asked = []

    def counting(problems, *args, **kwargs):
        asked.extend(problem.nu for problem in problems)
        return simulate(problems, *args, **kwargs)

    monkeypatch.setattr(thresholds, "simulate", counting)
    courses = thresholds.Courses(parameters, "d-material")
    first = courses.of(thresholds.highest)(np.array([0.7, 0.8, 0.7]))
    again = courses.of(thresholds.highest)(np.array([0.8, 0.7]))
    assert asked == [0.7, 0.8]
    assert courses.runs == 2
    assert first.tolist() == [again[1], again[0], again[1]]


def test_thresholds_of_the_paper_stand_where_the_model_changes(parameters):
    found = thresholds.locate(parameters, ["c-material", "c-material-5x", "c-lubricant"])
    assert json.loads(json.dumps(found, allow_nan=False)) == found

    def run(name, nu):
        return simulate([parameters.problem(variant(name), nu)], parameters.tolerance)[0]

    end = found["loop_end"]["c-material"]
    assert run("c-material", end - WIDTH).turning_points_per_period == 4
    assert run("c-material", end + WIDTH).turning_points_per_period == 2

    jump = found["second_jump"]["c-lubricant"]
    near = thresholds.JUMP_WIDTH
    rise = run("c-lubricant", jump + near).y_max - run("c-lubricant", jump - near).y_max
    assert rise > 0.5

    low, high = found["exceedance"]["c-material-5x"][0]
    middle = (low + high) / 2
    assert run("c-material-5x", middle).y_max > run("c-material", middle).y_max
    beyond = high + WIDTH
    assert run("c-material-5x", beyond).y_max < run("c-material", beyond).y_max


def test_what_a_study_lacks_is_left_out(parameters):
    assert thresholds.locate(parameters, ["a-conservative"]) == {}
    found = thresholds.locate(parameters, ["d-material"])
    assert found.keys() == {"largest_step"}
