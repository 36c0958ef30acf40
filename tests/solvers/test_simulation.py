"""The fast solver: what must not change an answer, and what an answer must obey."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from problems import problem

from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH
from gearmesh.model.problem import State
from gearmesh.model.variants import VARIANTS
from gearmesh.solvers import simulation as integrator
from gearmesh.solvers.response import MAXIMUM, Response, Samples
from gearmesh.solvers.simulation import simulate

MEAN = 3.28954
POWERS = (0.12336, 0.24672, 0.49344)
"""2D, 2D y_st/l and 2D (y_st/l)^2 for l = y_st/2."""


def assert_same(left: Response, right: Response) -> None:
    """Assert that two responses are equal bit for bit, their time courses included."""
    for name in Response.__slots__:
        a, b = getattr(left, name), getattr(right, name)
        if name == "samples" and a is not None:
            for course in Samples.__slots__:
                np.testing.assert_array_equal(getattr(a, course), getattr(b, course))
        else:
            np.testing.assert_array_equal(a, b, err_msg=name)


ENSEMBLE = [
    problem(nu, name)
    for name in ("a-conservative", "b-lubricant", "c-material", "d-both", "h-lubricant")
    for nu in (0.6, 0.66, 0.8, 1.1)
]


@pytest.fixture(scope="module")
def singles():
    return [simulate([one], samples_per_period=16)[0] for one in ENSEMBLE]


@settings(max_examples=15)
@given(st.permutations(range(len(ENSEMBLE))), st.integers(1, len(ENSEMBLE)))
def test_a_run_does_not_depend_on_its_batch(singles, order, size):
    chosen = order[:size]
    together = simulate([ENSEMBLE[i] for i in chosen], samples_per_period=16)
    for i, response in zip(chosen, together, strict=True):
        assert_same(response, singles[i])


def test_a_run_does_not_depend_on_the_chunk(singles, monkeypatch):
    monkeypatch.setattr(integrator, "_CHUNK", 3)
    for response, single in zip(simulate(ENSEMBLE, samples_per_period=16), singles, strict=True):
        assert_same(response, single)


def test_samples_and_error_estimates_change_nothing_else(singles):
    plain = simulate(ENSEMBLE, estimate_errors=False)
    for response, single in zip(plain, singles, strict=True):
        np.testing.assert_array_equal(response.extremum_y, single.extremum_y)
        np.testing.assert_array_equal(response.strobe_v, single.strobe_v)
        assert response.y_rms == single.y_rms
        assert np.isnan(response.y_max_error)


def test_whole_periods_shift_nothing():
    shifted, plain = (simulate([problem(initial_phase=phase)])[0] for phase in (1.0, 0.0))
    for response in (shifted, plain):  # the branches name the problem, and so the phase
        response.final_state = replace(response.final_state, branches=None)
    assert_same(shifted, plain)


def test_a_run_goes_on_where_another_ended():
    long = simulate([problem(0.9, revolutions=2)])[0]
    first = simulate([problem(0.9, revolutions=1)])[0]
    second = simulate([problem(0.9, revolutions=1, initial_state=first.final_state)])[0]
    # Not bit for bit: turning points end a step where they are kept, and only there.
    np.testing.assert_allclose(second.strobe_y[1:], long.strobe_y[22:], atol=1e-10)
    np.testing.assert_allclose(second.extremum_y, long.extremum_y, atol=1e-10)


def test_runs_of_different_lengths_share_a_batch():
    short, long = simulate([problem(revolutions=2), problem(revolutions=3, kept_revolutions=2)])
    assert short.strobe_y.shape == (43,)
    assert long.strobe_y.shape == (64,)
    np.testing.assert_array_equal(short.strobe_y, long.strobe_y[:43])


@pytest.mark.parametrize("name", ["b-both", "c-material", "d-both", "d-lubricant", "h-lubricant"])
def test_achieved_error_follows_the_tolerance(name):
    """Bodies that stand still: from a turning point, cubic damping leaves every third term only."""
    batch = [problem(nu, name, body_mass=1000.0) for nu in (0.62, 0.75, 0.9, 1.15)]
    exact = np.array([r.strobe_y for r in simulate(batch, tolerance=1e-14)])
    for tolerance in (1e-6, 1e-8, 1e-10, 1e-12):
        found = np.array([r.strobe_y for r in simulate(batch, tolerance=tolerance)])
        assert abs(found - exact).max() < 1000 * tolerance


def test_the_error_estimate_bounds_the_error():
    batch = [problem(nu, name) for nu in np.linspace(0.6, 1.2, 25) for name in VARIANTS]
    exact = simulate(batch, tolerance=1e-13, estimate_errors=False)
    below = 0
    for found, reference in zip(simulate(batch, tolerance=1e-9), exact, strict=True):
        error = abs(found.y_max - reference.y_max)
        # A chaotic orbit is lost to any tolerance: it must be flagged, not measured.
        below += error > 10 * found.y_max_error + 1e-9 and not found.sensitive
    assert below <= 0.005 * len(batch)


def test_a_tolerance_that_decides_no_step_still_estimates_errors():
    """Where stops decide, a companion with another tolerance alone would repeat the run."""
    chaotic, steady = simulate(
        [problem(0.65, "a-conservative"), problem(0.65, "b-both")], tolerance=1e-8
    )
    assert chaotic.sensitive
    assert 0.0 < steady.y_max_error < 1e-5
    # Short segments, no damping: each displacement of the start grows a billion times.
    growing = problem(
        2.2596,
        "a-conservative",
        contact_ratio=1.411,
        body_mass=3.586,
        bearing_stiffness=0.162,
        bearing_damping_ratio=0.0032,
        friction_coefficient=0.3,
        initial_phase=0.968,
        backlash=10.4,
    )
    assert simulate([growing], tolerance=1e-11)[0].sensitive


def test_chaos_is_flagged_and_steady_motion_is_not():
    chaotic, steady = simulate([problem(0.85, "a-conservative"), problem(0.85, "b-both")])
    assert chaotic.sensitive
    assert not steady.sensitive
    assert steady.y_max_error < 1e-7


@pytest.mark.parametrize("one", ENSEMBLE[::3], ids=lambda p: f"{p.nu}")
def test_extrema_alternate_and_bound_the_samples(one):
    response = simulate([one], samples_per_period=64)[0]
    assert (np.diff(response.extremum_time) > 0).all()
    assert (np.diff(response.extremum_kind) != 0).all()
    assert response.samples.y.max() <= response.y_max + 1e-12
    assert response.samples.y.min() >= response.y_min - 1e-12
    # y rises towards a maximum and falls towards a minimum.
    following = np.searchsorted(response.extremum_time, response.samples.time)
    known = following < len(response.extremum_kind)
    towards = response.extremum_kind[following[known]]
    assert (response.samples.v[known] * towards >= -1e-12).all()


def test_every_pass_through_zero_is_located():
    response = simulate([problem(0.85, "c-lubricant")], samples_per_period=256)[0]
    regime, y = response.samples.regime, response.samples.y
    assert set(regime) == {NORMAL_MESH, CONTACT_LOSS}
    np.testing.assert_array_equal(regime == NORMAL_MESH, y >= 0)
    leaves = np.count_nonzero((regime[:-1] == NORMAL_MESH) & (regime[1:] == CONTACT_LOSS))
    assert response.n_contact_losses == leaves
    assert response.contact_loss_fraction == pytest.approx(
        np.mean(regime == CONTACT_LOSS), abs=2e-3
    )


def test_back_flanks_touch_beyond_the_backlash():
    response = simulate([problem(0.85, "b-lubricant", backlash=0.5)], samples_per_period=256)[0]
    samples = response.samples
    back = samples.regime == INVERSE_MESH
    assert back.any()
    np.testing.assert_array_equal(back, samples.y <= -0.5)
    assert response.inverse_mesh_fraction == pytest.approx(back.mean(), abs=2e-3)
    np.testing.assert_allclose(samples.force_dynamic, samples.stiffness * samples.y, rtol=1e-14)
    np.testing.assert_array_equal(
        samples.modified_stiffness, samples.stiffness * (samples.regime != CONTACT_LOSS)
    )


def test_root_mean_square_is_that_of_the_samples():
    response = simulate([problem(0.9, "d-both")], samples_per_period=1024)[0]
    assert response.y_rms == pytest.approx(np.sqrt(np.mean(response.samples.y**2)), rel=1e-6)


def test_grazing_inside_a_step_is_not_missed():
    """The lowest point of an orbit decides, however short its dip below zero."""
    found = []
    for low in (1e-3, 1e-6, 1e-9):
        # Constant stiffness, no damping: y swings about 1 with an amplitude that dips by `low`.
        orbit = problem(
            0.8,
            "a-conservative",
            contact_ratio=2.0,
            stiffness_max=1.0,
            friction_coefficient=0.0,
            body_mass=1e12,
            bearing_damping_ratio=0.0,
            initial_state=State(2.0 + low, 0.0, -2.0, 0.0),
            revolutions=1,
        )
        response = simulate([orbit], tolerance=1e-15)[0]
        found.append(response)
        assert response.n_contact_losses >= 20
        # Free fall below 0: height of the dip from the energy, low of elastic and load work.
        speed_squared = (1.0 + low) ** 2 - 1.0
        assert response.y_min == pytest.approx(-0.5 * speed_squared, rel=1e-3)
    assert found[2].contact_loss_fraction < found[0].contact_loss_fraction < 0.05


def test_energy_is_conserved_through_both_flanks():
    orbit = problem(
        0.8,
        "a-conservative",
        contact_ratio=2.0,
        stiffness_max=1.0,
        friction_coefficient=0.0,
        backlash=1.5,
        body_mass=1e12,
        bearing_damping_ratio=0.0,
        initial_state=State(4.0, 0.0, -2.0, 0.0),
    )
    response = simulate([orbit], tolerance=1e-12, samples_per_period=64)[0]
    y, v = response.samples.y, response.samples.v
    assert (y <= -1.5).any()
    depth = np.where(y >= 0, y, np.where(y <= -1.5, y + 1.5, 0.0))
    energy = 0.5 * v**2 + 0.5 * depth**2 - y
    np.testing.assert_allclose(energy, 0.5 * 4.0**2 - 4.0, atol=1e-9)


def test_maxima_of_a_constant_mesh_stay_put():
    still = problem(contact_ratio=2.0, stiffness_max=1.0, friction_coefficient=0.0)
    response = simulate([still], samples_per_period=8)[0]
    np.testing.assert_allclose(response.samples.y, 1.0, atol=1e-12)
    assert response.y_max == pytest.approx(1.0, abs=1e-12)


def test_two_turning_points_may_stand_close_together():
    """Light bodies on stiff bearings turn twice within a step; the first is not found again."""
    stiff = [
        problem(nu, name, body_mass=4.0, bearing_stiffness=10.0)
        for name in ("b-material", "c-lubricant")
        for nu in np.linspace(0.6, 1.2, 64)
    ]
    assert {response.status for response in simulate(stiff, estimate_errors=False)} == {"ok"}


def test_a_run_that_never_ends_is_given_up(monkeypatch):
    stiff = problem(bearing_stiffness=1e12, body_mass=1e-9, bearing_damping_ratio=0.0)
    fine = problem()
    failed, good = simulate([stiff, fine])
    assert failed.status == "step_limit"
    assert np.isnan(failed.y_max)
    assert good.status == "ok"


def test_memory_stays_flat_over_a_sweep():
    """A process that solves twelve times as many runs is no larger for it."""
    few, many = (_peak_memory(sweeps) for sweeps in (1, 12))
    assert many < few + 16 * 2**20


def _peak_memory(sweeps: int) -> int:
    """Return the largest size, in bytes, of a process that solves sweeps of 256 runs."""
    script = f"""
import resource, sys
import numpy as np
from gearmesh.solvers.simulation import simulate
from problems import problem
for _ in range({sweeps}):
    simulate([problem(nu, "d-both") for nu in np.linspace(0.6, 1.2, 256)], samples_per_period=16)
unit = 1 if sys.platform == "darwin" else 1024
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)
"""
    command = [sys.executable, "-c", script]
    run = subprocess.run(
        command, cwd=Path(__file__).parents[1], capture_output=True, text=True, check=True
    )
    return int(run.stdout)


def test_extremum_kind_names_the_upper_ends():
    response = simulate([problem(0.9)])[0]
    highest = response.extremum_y[response.extremum_kind == MAXIMUM]
    assert highest.max() == response.y_max
