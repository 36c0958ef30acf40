"""A run that goes on where another has ended equals the run without a break, bit for bit."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from problems import of_paper, problem

from gearmesh.model.motion import state_at
from gearmesh.model.problem import Problem
from gearmesh.model.variants import VARIANTS
from gearmesh.solvers.full.runs import integrate
from gearmesh.solvers.response import Response
from gearmesh.solvers.simulation import simulate

REDUCIBLE = st.fixed_dictionaries(
    {
        "nu": st.floats(0.5, 1.3),
        "name": st.sampled_from(list(VARIANTS)),
        "friction_coefficient": st.sampled_from([0.0, 0.05, 0.2]),
        "initial_phase": st.sampled_from([0.0, 0.2845, 0.5, 0.9]),
        "backlash": st.sampled_from([0.4, 4.0]),
        "body_mass": st.sampled_from([2.0, 32.0]),
    }
)
RUN_OUT = st.fixed_dictionaries(
    {
        "eccentricity_3": st.sampled_from([0.5, 2.0]),
        "eccentricity_2": st.sampled_from([0.0, 0.3]),
        "eccentricity_angle": st.floats(0.0, 2.0),
        "deviation": st.sampled_from([(), ((0.1, 0.05),)]),
        "stiffness_harmonics": st.sampled_from([0, 3]),
    }
)
LENGTHS = st.tuples(st.integers(1, 2), st.integers(1, 2)).flatmap(
    lambda both: st.tuples(*map(st.just, both), st.integers(0, both[0]))
)


def solve_reduced(case: Problem) -> Response:
    return simulate([case], 1e-9, 8, estimate_errors=False)[0]


def solve_full(case: Problem) -> Response:
    return integrate(case, 1e-9, 8, estimate_errors=False)


def assert_goes_on(solve, case: Problem, first: int, second: int, kept: int) -> None:
    """Run `first` revolutions and `second` more; measure the last `kept` of the first."""
    whole = solve(replace(case, revolutions=first + second, kept_revolutions=kept + second))
    before = solve(replace(case, revolutions=first, kept_revolutions=kept))
    start = before.final_state
    after = solve(replace(case, revolutions=second, kept_revolutions=second, initial_state=start))
    for name in ("strobe_y", "strobe_v"):
        ends = getattr(before, name)
        assert ends[-1] == getattr(after, name)[0]
        joined = np.concatenate([ends, getattr(after, name)[1:]])
        np.testing.assert_array_equal(joined, getattr(whole, name), err_msg=name)
    for name in ("extremum_y", "extremum_kind"):
        joined = np.concatenate([getattr(before, name), getattr(after, name)])
        np.testing.assert_array_equal(joined, getattr(whole, name), err_msg=name)
    for name in ("y", "v", "a", "stiffness", "force_friction", "regime"):
        parts = [getattr(run.samples, name) for run in (before, after) if run.samples is not None]
        joined = np.concatenate(parts)
        np.testing.assert_array_equal(joined, getattr(whole.samples, name), err_msg=name)
    shifted = after.extremum_time + first * case.teeth * case.period
    times = np.concatenate([before.extremum_time, shifted])
    np.testing.assert_allclose(times, whole.extremum_time, rtol=1e-14)
    assert replace(after.final_state, branches=None) == replace(whole.final_state, branches=None)
    assert after.final_state.branches.direction == whole.final_state.branches.direction
    if kept == 0:
        assert after.y_rms == whole.y_rms
        assert after.y_max == whole.y_max
        assert after.n_contact_losses == whole.n_contact_losses


@settings(max_examples=60)
@given(REDUCIBLE, LENGTHS)
def test_the_reduced_solver_goes_on(changes, lengths):
    assert_goes_on(solve_reduced, problem(**changes, teeth=5), *lengths)


@settings(max_examples=30)
@given(REDUCIBLE, RUN_OUT, LENGTHS)
def test_the_full_solver_goes_on(changes, run_out, lengths):
    assert_goes_on(solve_full, problem(**changes, **run_out, teeth=5), *lengths)


@settings(max_examples=10)
@given(REDUCIBLE, LENGTHS)
def test_the_full_solver_goes_on_without_run_out(changes, lengths):
    assert_goes_on(solve_full, problem(**changes, teeth=5), *lengths)


def test_light_bodies_with_run_out_and_friction_go_on():
    """The wheels move across the mesh line too, and the shafts have turned."""
    case = of_paper("b-material", 0.9, eccentricity=["20 um", "0 um"], body_mass="3.123 kg")
    for kept in (0, 1):
        assert_goes_on(solve_full, case, 1, 1, kept)


def test_a_state_serves_other_laws():
    """In a sweep the next run has another frequency, or no run-out any more."""
    turned = integrate(problem(0.8, eccentricity_3=0.5, revolutions=1), estimate_errors=False)
    for changes in ({"nu": 0.81, "eccentricity_3": 0.5}, {"nu": 0.8}):
        case = problem(**changes, revolutions=1, initial_state=turned.final_state)
        following = simulate([case], estimate_errors=False)[0]
        assert following.status == "ok"
        assert following.strobe_y[0] == pytest.approx(turned.final_state.y, abs=0.6)
    smooth = simulate([problem(0.8, revolutions=1)], estimate_errors=False)[0]
    case = problem(0.8, eccentricity_3=0.5, revolutions=1, initial_state=smooth.final_state)
    following = integrate(case, estimate_errors=False)
    assert following.strobe_y[0] == pytest.approx(smooth.final_state.y, abs=1e-12)


@pytest.mark.parametrize("solve", [solve_reduced, solve_full], ids=["reduced", "full"])
def test_the_default_start_is_static_equilibrium(solve):
    case = problem(0.7, bearing_stiffness=0.7, revolutions=1)
    same = replace(case, initial_state=state_at(case))
    np.testing.assert_array_equal(solve(same).extremum_y, solve(case).extremum_y)


@pytest.mark.parametrize("solve", [solve_reduced, solve_full], ids=["reduced", "full"])
def test_a_given_motion_of_the_mesh(solve):
    case = problem(0.7, revolutions=1)
    response = solve(replace(case, initial_state=state_at(case, y=1.5, v=0.25)))
    assert response.strobe_y[0] == pytest.approx(1.5, abs=1e-15)
    assert response.strobe_v[0] == pytest.approx(0.25, abs=1e-15)


def test_a_run_that_keeps_nothing_measures_nothing():
    response = solve_reduced(problem(0.7, revolutions=1, kept_revolutions=0))
    assert response.status == "ok"
    assert len(response.strobe_y) == 22
    assert np.isnan([response.y_max, response.y_min, response.y_rms]).all()
    assert response.n_contact_losses is None
