"""Problems at the edge of what can be integrated: each ends right, or with an honest status."""

import math
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from problems import of_paper, problem

from gearmesh.model.problem import State
from gearmesh.solvers import limits
from gearmesh.solvers.full.runs import integrate
from gearmesh.solvers.response import Response
from gearmesh.solvers.simulation import simulate

FAR_AWAY = {
    "conservative": of_paper(
        "a-conservative",
        0.2398,
        contact_ratio=1.0174,
        stiffness_ratio=0.1453,
        teeth=17,
        backlash="0.620831 mm",
        initial_phase=0.2945,
        friction_coefficient=0.3,
        body_mass="3484.5 kg",
        bearing_stiffness="1578.1 N/mm",
        bearing_damping_ratio=0.343,
    ),
    "hardly any stiffness": of_paper("b-material", 0.8, stiffness_ratio=0.001),
}


def assert_holds_nothing(response: Response) -> None:
    """Assert that a run that failed reports no number as if it had been measured."""
    for name in ("y_max", "y_min", "y_rms", "contact_loss_fraction", "inverse_mesh_fraction"):
        assert math.isnan(getattr(response, name)), name
    assert math.isnan(response.turning_points_per_period)
    assert response.n_contact_losses is None
    assert response.sensitive is None
    assert response.final_state is None
    assert response.samples is None
    assert response.extremum_y.size == response.strobe_y.size == 0


@pytest.mark.parametrize("name", FAR_AWAY)
@pytest.mark.parametrize(
    "solve", [integrate, lambda case: simulate([case])[0]], ids=["full", "reduced"]
)
def test_motion_beyond_every_scale_has_diverged(name, solve):
    response = solve(FAR_AWAY[name])
    assert response.status == "diverged"
    assert_holds_nothing(response)


def test_a_wide_backlash_is_no_divergence():
    """Free flight over a backlash of 1e8 static deflections stays within the problem's scale."""
    wide = problem(0.8, "b-both", backlash=1e8, initial_state=State(-1e8 + 10.0, 0.0, -2.0, 0.0))
    (response,) = simulate([wide], estimate_errors=False)
    assert response.status == "ok"
    assert response.y_min < -1e7


MISSED = of_paper(
    "a-conservative",
    0.2358,
    contact_ratio=1.2709,
    stiffness_ratio=0.339,
    teeth=40,
    backlash="0.068469 mm",
    friction_coefficient=0,
    initial_phase=0.6544,
    body_mass="52.6011 kg",
    bearing_stiffness="151011.8 N/mm",
    bearing_damping_ratio=0.844,
)
"""Chaos that ends on one of a few attractors: a companion may end on the same one by chance."""


@pytest.mark.parametrize("tolerance", [1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-15])
def test_transient_chaos_is_sensitive(tolerance):
    assert simulate([MISSED], tolerance)[0].sensitive


def test_no_error_goes_unflagged_where_attractors_coexist():
    cases = [replace(MISSED, nu=nu, initial_phase=p) for nu in np.linspace(0.23, 0.25, 21)
             for p in (0.1, 0.3, 0.6544)]  # fmt: skip
    exact = simulate(cases, 1e-13, estimate_errors=False)
    for found, reference in zip(simulate(cases, 1e-10), exact, strict=True):
        error = max(abs(found.y_max - reference.y_max), abs(found.y_min - reference.y_min))
        assert error < 1e-4 or found.sensitive


def test_slow_rotation_has_many_extrema():
    """The third mesh period alone; its values were computed by another solver."""
    case = replace(of_paper("b-material", 0.01), teeth=1, revolutions=3)
    (response,) = simulate([case])
    assert response.status == "ok"
    assert response.turning_points_per_period > 64
    assert response.y_max == pytest.approx(1.9021151985, abs=1e-9)
    assert response.y_min == pytest.approx(0.3599758213, abs=1e-9)
    assert response.y_rms == pytest.approx(1.1104566403, abs=1e-9)
    assert (np.diff(response.extremum_kind) != 0).all()


def test_a_deviation_of_high_order_has_many_extrema():
    case = problem(0.8, "b-both", deviation=((0.0, 0.0),) * 49 + ((0.1, 0.0),), revolutions=1)
    response = integrate(case, 1e-8, estimate_errors=False)
    assert response.status == "ok"
    assert response.turning_points_per_period > 64
    assert len(response.extremum_y) == round(21 * response.turning_points_per_period)


def test_very_stiff_supports_are_rigid():
    stiff = of_paper("b-material", 0.8, bearing_stiffness="1e12 N/mm", body_mass="3.123 kg")
    (response,) = simulate([stiff])
    assert response.status == "ok"
    rigid = replace(stiff, body_mass=1e9)
    (expected,) = simulate([rigid])
    # The bodies give way by 2/c_b under F_st, and by no more than the largest force makes of it.
    given_way = 2.0 / stiff.bearing_stiffness * stiff.stiffness_max * expected.y_max
    assert response.y_max == pytest.approx(expected.y_max, abs=given_way)
    assert response.y_min == pytest.approx(expected.y_min, abs=given_way)
    assert 0.01 * response.y_max == pytest.approx(0.0206065, abs=1e-7)


@pytest.mark.parametrize("damping", ["1e5 N s/mm", "1e6 N s/mm"])
def test_strong_damping_holds_the_mesh(damping):
    (response,) = simulate([of_paper("b-both", 0.8, damping=damping, revolutions=1)])
    assert response.status == "ok"
    assert 0.99 < response.y_min < response.y_max < 1.01


def test_what_is_too_fast_is_refused_at_once():
    impossible = problem(bearing_stiffness=1e12, body_mass=1e-9, bearing_damping_ratio=0.0)
    assert limits.most_steps(impossible) == 0.0
    for response in (simulate([impossible])[0], integrate(impossible)):
        assert response.status == "step_limit"
        assert response.steps <= 1
        assert_holds_nothing(response)


@pytest.mark.parametrize(("angle", "nu"), [("180 deg", 0.8), ("175 deg", 0.1)])
@pytest.mark.parametrize("friction", [0.05, 0.3])
def test_run_outs_that_cancel_leave_friction_undefined(angle, nu, friction):
    case = of_paper(
        "b-material",
        nu,
        eccentricity="10 um",
        eccentricity_angle=angle,
        friction_coefficient=friction,
    )
    (response,) = simulate([case])
    assert response.status == "friction_undefined"
    assert_holds_nothing(response)


def test_the_drift_of_the_mean_rotation_is_reported():
    case = of_paper(
        "b-material",
        0.8,
        body_mass="3.123 kg",
        eccentricity=["100 um", "0 um"],
        friction_coefficient=0.1,
        revolutions=10,
    )
    rough, smooth = (
        integrate(replace(case, friction_coefficient=f), estimate_errors=False) for f in (0.1, 0.0)
    )
    coordinates = rough.final_state.coordinates
    turned = 0.5 * (coordinates[0] - coordinates[1]) / case.base_radius
    assert rough.rotation_drift == pytest.approx(turned)
    assert abs(rough.rotation_drift) > 1e-3
    assert abs(smooth.rotation_drift) < 0.1 * abs(rough.rotation_drift)
    assert math.isnan(simulate([of_paper("b-material", 0.8)])[0].rotation_drift)


LONG = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where tests run in background
from problems import problem
from gearmesh.solvers.simulation import simulate
simulate([problem(0.8, {name!r}, revolutions=1, stiffness_harmonics={harmonics})])
print("ready", flush=True)
simulate([problem(0.8, {name!r}, revolutions=1_000_000, stiffness_harmonics={harmonics})])
"""


@pytest.mark.parametrize("harmonics", [0, 20], ids=["reduced", "full"])
def test_a_long_run_can_be_interrupted(harmonics):
    """A run of hours ends when it is interrupted, long before the limit of the test."""
    script = LONG.format(name="b-both", harmonics=harmonics)
    command = [sys.executable, "-c", script]
    with subprocess.Popen(
        command, cwd=Path(__file__).parents[1], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout.readline() == b"ready\n"
        time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        try:
            _, errors = process.communicate(timeout=60)
        finally:
            process.kill()
    assert b"KeyboardInterrupt" in errors


@pytest.mark.parametrize("most_turns", [1, 7])
def test_returning_on_the_way_changes_nothing(most_turns, monkeypatch):
    reduced = [problem(nu, name, revolutions=2) for nu in (0.6, 0.8, 1.1)
               for name in ("b-lubricant", "c-material", "a-conservative")]  # fmt: skip
    full = problem(0.7, "c-both", eccentricity_3=0.5, stiffness_harmonics=3, revolutions=2)
    whole = [*simulate(reduced, 1e-9), integrate(full, 1e-9)]
    monkeypatch.setattr("gearmesh.solvers.reduced.runs._MOST_TURNS", most_turns)
    monkeypatch.setattr("gearmesh.solvers.full.runs._MOST_TURNS", most_turns)
    for found, expected in zip(
        [*simulate(reduced, 1e-9), integrate(full, 1e-9)], whole, strict=True
    ):
        np.testing.assert_array_equal(found.extremum_y, expected.extremum_y)
        np.testing.assert_array_equal(found.strobe_v, expected.strobe_v)
        assert (found.y_rms, found.steps) == (expected.y_rms, expected.steps)
