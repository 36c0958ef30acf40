"""The equations of motion: every term shows its effect, or its limit."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from problems import problem

from gearmesh.model import motion, stiffness
from gearmesh.model.contact import (
    CONTACT_LOSS,
    INVERSE_MESH,
    NORMAL_MESH,
    dynamic_force,
    elastic_force,
    regime_of,
)
from gearmesh.model.motion import (
    ROTATION_2,
    ROTATION_3,
    Y_2,
    Y_3,
    Z_2,
    Z_3,
    Mode,
    accelerations,
    relative_motion,
    static_equilibrium,
)
from gearmesh.model.problem import State

PLAIN = problem(friction_coefficient=0.0, bearing_damping_ratio=0.0, lubricant=(0.0, 0.0, 0.0))
RUN_OUT = replace(
    PLAIN,
    eccentricity_3=2.0,
    eccentricity_2=1.5,
    eccentricity_angle=0.7,
    deviation=((0.1, -0.2), (0.05, 0.0)),
    base_radius=300.0,
)
STILL = np.zeros(6)
DOUBLE, BEFORE, BEHIND = 0.1, 0.4, 0.6
"""Mesh phases in double contact, and in single contact before and behind the pitch point."""


def at_phase(one, phase):
    return phase * one.period


def pressed(y):
    """Return coordinates at the relative motion `y`, without run-out."""
    q = np.zeros(6)
    q[ROTATION_3] = y
    return q


@pytest.mark.parametrize("time", [0.0, 3.0, 40.0])
def test_rate_of_the_relative_motion(time):
    rng = np.random.default_rng(1)
    q, v = rng.normal(size=(2, 6))
    h = 1e-5
    ahead, behind = (relative_motion(RUN_OUT, time + s * h, q + s * h * v, v)[0] for s in (1, -1))
    rate = relative_motion(RUN_OUT, time, q, v)[1]
    assert rate == pytest.approx((ahead - behind) / (2 * h), abs=1e-8)


def test_relative_motion_of_eq_3():
    q = np.array([1.0, 2.0, 3.0, 4.0, 50.0, 60.0])
    assert relative_motion(PLAIN, 0.0, q, STILL)[0] == 1.0 + 2.0 + 3.0 - 4.0
    time = 11.0
    phi_3 = RUN_OUT.nu / 21 * time + 1.0 / 300.0
    phi_2 = RUN_OUT.nu / 21 * time + 2.0 / 300.0
    angle = RUN_OUT.nu * time
    f = 0.1 * math.cos(angle) - 0.2 * math.sin(angle) + 0.05 * math.cos(2 * angle)
    expected = 2.0 + 2.0 * math.sin(phi_3) - 1.5 * math.sin(0.7 - phi_2) + f
    assert relative_motion(RUN_OUT, time, q, STILL)[0] == pytest.approx(expected, abs=1e-14)


@settings(max_examples=30)
@given(st.integers(0, 1000), st.sampled_from([PLAIN, RUN_OUT]), st.floats(0, 100))
def test_forces_are_the_gradient_of_the_energy(seed, one, time):
    """Generalised force -N dy/dq_j, loads and bearings, from the potential energy alone."""
    rng = np.random.default_rng(seed)
    q = rng.normal(size=6)
    mode = Mode(NORMAL_MESH, motion.mesh_phase(one, time))
    c = motion.mesh_stiffness(one, mode.segment)

    def potential(q):
        # The damping of eq. (7) is off, so the velocity does not matter.
        y, _ = relative_motion(one, time, q, STILL)
        return 0.5 * c * y**2 + 0.5 * one.bearing_stiffness * np.sum(q[2:] ** 2) - q[0] - q[1]

    h = 1e-5
    slope = [(potential(q + h * e) - potential(q - h * e)) / (2 * h) for e in np.eye(6)]
    inertia = np.array([2.0, 2.0] + 4 * [one.body_mass])
    found = inertia * accelerations(one, time, q, STILL, mode)
    np.testing.assert_allclose(found, -np.array(slope), atol=1e-7)


def test_reduced_mass_and_sum_coordinates():
    """U'' = 1 - N and m/m_red Y'' = -c_b Y - 2 N, with u = R_b (phi_3 + phi_2)."""
    q = np.array([0.3, 0.5, -0.2, 0.4, 0.0, 0.0])
    y, _ = relative_motion(PLAIN, 0.0, q, STILL)
    normal = PLAIN.stiffness_max * y
    assert y > 0
    a = accelerations(PLAIN, 0.0, q, STILL)
    assert a[ROTATION_3] + a[ROTATION_2] == pytest.approx(1.0 - normal)
    bearing = PLAIN.bearing_stiffness * (q[Y_3] - q[Y_2])
    assert PLAIN.body_mass * (a[Y_3] - a[Y_2]) == pytest.approx(-bearing - 2.0 * normal)


@pytest.mark.parametrize(
    ("y", "regime", "depth"),
    [
        (2.0, NORMAL_MESH, 2.0),
        (0.0, NORMAL_MESH, 0.0),
        (-1e-9, CONTACT_LOSS, 0.0),
        (-3.999, CONTACT_LOSS, 0.0),
        (-4.0, INVERSE_MESH, 0.0),
        (-5.0, INVERSE_MESH, -1.0),
    ],
)
def test_regimes(y, regime, depth):
    assert regime_of(y, PLAIN.backlash) == regime
    assert elastic_force(y, 1.2, regime, PLAIN.backlash) == pytest.approx(1.2 * depth)
    a = accelerations(PLAIN, at_phase(PLAIN, DOUBLE), pressed(y), STILL)
    assert 2.0 * a[ROTATION_3] == pytest.approx(1.0 - PLAIN.stiffness_max * depth)


@pytest.mark.parametrize(("y", "law"), [(1.0, "material"), (-1.0, "lubricant"), (-5.0, "material")])
@pytest.mark.parametrize("v", [0.7, -0.7])
def test_damping_acts_by_regime(y, law, v):
    laws = {"material": (0.1, 0.2, 0.4), "lubricant": (0.3, 0.5, 0.7)}
    damped = replace(PLAIN, **laws)
    rates = pressed(v)
    difference = accelerations(damped, 0.0, pressed(y), rates) - accelerations(
        PLAIN, 0.0, pressed(y), rates
    )
    k1, k2, k3 = laws[law]
    force = k1 * v + k2 * abs(v) * v + k3 * v**3
    share = np.array([1.0 / 2, 1.0 / 2, 1.0 / 32, -1.0 / 32, 0.0, 0.0])
    np.testing.assert_allclose(difference, -force * share, atol=1e-14)


def test_stiffness_switches_at_the_ends_of_double_contact():
    low = 0.5 * (PLAIN.contact_ratio - 1.0)
    for phase, level in (
        (low - 1e-6, PLAIN.stiffness_max),
        (low + 1e-6, PLAIN.stiffness_min),
        (1.0 - low - 1e-6, PLAIN.stiffness_min),
        (1.0 - low + 1e-6, PLAIN.stiffness_max),
    ):
        a = accelerations(PLAIN, at_phase(PLAIN, phase), pressed(1.0), STILL)
        assert a[ROTATION_3] + a[ROTATION_2] == pytest.approx(1.0 - level)


def test_truncated_series_replaces_the_wave():
    smooth = replace(PLAIN, stiffness_harmonics=3)
    a = accelerations(smooth, at_phase(smooth, 0.3), pressed(1.0), STILL)
    expected = stiffness.fourier(0.3, 1.569, PLAIN.stiffness_max, PLAIN.stiffness_min, 3)
    assert a[ROTATION_3] + a[ROTATION_2] == pytest.approx(1.0 - expected)


def test_bearings():
    damped = replace(PLAIN, bearing_damping_ratio=0.25)
    frequency = math.sqrt(PLAIN.bearing_stiffness / PLAIN.body_mass)
    for i in (Y_3, Y_2, Z_3, Z_2):
        # At the edge of contact loss nothing else acts on the bodies.
        q, v = pressed(-1.0), np.zeros(6)
        q[i] = 0.1
        v[i] = 0.2
        a = accelerations(damped, 0.0, q, v)
        assert a[i] == pytest.approx(-(frequency**2) * 0.1 - 0.5 * frequency * 0.2)


@pytest.mark.parametrize(("phase", "sign"), [(BEFORE, -1.0), (BEHIND, 1.0)])
def test_friction_in_single_contact(phase, sign):
    rough = replace(PLAIN, friction_coefficient=0.1)
    a, without = (
        accelerations(one, at_phase(PLAIN, phase), pressed(1.0), STILL) for one in (rough, PLAIN)
    )
    force = sign * 0.1 * PLAIN.stiffness_min
    difference = a - without
    assert difference[Z_3] == pytest.approx(force / 32.0)
    assert difference[Z_2] == pytest.approx(-force / 32.0)
    assert difference[ROTATION_3] + difference[ROTATION_2] == pytest.approx(
        -math.tan(PLAIN.pressure_angle) * force
    )
    shift = 2.0 * math.pi / 21 * (phase - 0.5)
    assert difference[ROTATION_3] - difference[ROTATION_2] == pytest.approx(-shift * force)


def test_friction_in_double_contact_turns_the_wheels_apart():
    rough = replace(PLAIN, friction_coefficient=0.1)
    a, without = (
        accelerations(one, at_phase(PLAIN, DOUBLE), pressed(1.0), STILL) for one in (rough, PLAIN)
    )
    difference = a - without
    couple = 0.5 * 0.1 * PLAIN.stiffness_max * 2.0 * math.pi / 21
    assert difference[ROTATION_3] == pytest.approx(-0.5 * couple)
    assert difference[ROTATION_2] == pytest.approx(0.5 * couple)
    assert (difference[2:] == 0.0).all()


def test_no_friction_in_contact_loss():
    rough = replace(PLAIN, friction_coefficient=0.1)
    for phase in (DOUBLE, BEFORE, BEHIND):
        a, without = (
            accelerations(one, at_phase(PLAIN, phase), pressed(-1.0), STILL)
            for one in (rough, PLAIN)
        )
        np.testing.assert_array_equal(a, without)


def test_signs_of_friction_with_run_out():
    rough = replace(PLAIN, friction_coefficient=0.1, eccentricity_3=1.0)
    quarter = 0.25 * 21 * PLAIN.period
    time = math.floor(quarter / PLAIN.period) * PLAIN.period + at_phase(PLAIN, BEFORE)
    rates = np.zeros(6)
    found = []
    for half_turn in (0.0, 10.0 * PLAIN.period):
        for slip in (1.0, -1.0):
            rates[Z_3] = slip
            q = pressed(-relative_motion(rough, time + half_turn, STILL, STILL)[0] + 1.0)
            a = accelerations(rough, time + half_turn, q, rates)
            found.append(np.sign(a[Z_3]))
    # sin Phi_3 is positive in the first half of a turn and negative in the second.
    assert found == [-1.0, 1.0, 1.0, -1.0]


def test_sticking_holds_the_slip():
    rough = replace(PLAIN, friction_coefficient=0.5, eccentricity_3=1.0, bearing_damping_ratio=0.03)
    q, v = pressed(1.0), np.zeros(6)
    q[Z_3], q[Z_2] = 0.2, -0.1
    v[Z_3] = v[Z_2] = 0.3
    mode = Mode(NORMAL_MESH, BEFORE, run_out_sign=1, slip_sign=0)
    a = accelerations(rough, at_phase(rough, BEFORE), q, v, mode)
    assert a[Z_3] == pytest.approx(a[Z_2])


def test_run_out_changes_the_lever_of_the_normal_force():
    time = 5.0
    q = pressed(3.0)
    y, _ = relative_motion(RUN_OUT, time, q, STILL)
    angle_3, angle_2 = motion.angles(RUN_OUT, time, q)
    a = accelerations(RUN_OUT, time, q, STILL)
    normal = motion.mesh_stiffness(RUN_OUT, motion.mesh_phase(RUN_OUT, time)) * y
    lever_3 = (300.0 + 2.0 * math.cos(angle_3)) / 300.0
    lever_2 = (300.0 + 1.5 * math.cos(angle_2)) / 300.0
    assert 2.0 * a[ROTATION_3] == pytest.approx(1.0 - lever_3 * normal)
    assert 2.0 * a[ROTATION_2] == pytest.approx(1.0 - lever_2 * normal)


def test_dynamic_force_of_eq_2():
    assert dynamic_force(0.5, 1.2) == pytest.approx(0.6)
    assert dynamic_force(-0.5, 1.2) == pytest.approx(-0.6)


def test_static_equilibrium_under_the_mean_stiffness():
    constant = replace(PLAIN, stiffness_max=1.0, stiffness_min=1.0)
    q, v = static_equilibrium(constant)
    assert relative_motion(constant, 0.0, q, v) == (1.0, 0.0)
    np.testing.assert_allclose(accelerations(constant, 0.0, q, v), 0.0, atol=1e-15)


def test_the_start_takes_run_out_and_phase_into_account():
    one = replace(RUN_OUT, initial_phase=0.3)
    q, v = motion.start(one)
    assert relative_motion(one, one.start_time, q, v)[0] == pytest.approx(1.0, abs=1e-15)
    assert (v == 0.0).all()


def test_a_given_start():
    given_start = replace(PLAIN, initial_state=State(1.0, 0.3, -0.5, 0.2))
    q, v = motion.start(given_start)
    y, rate = relative_motion(given_start, 0.0, q, v)
    assert (y, rate) == (pytest.approx(1.0), pytest.approx(0.3))
    assert (q[Y_3] - q[Y_2], v[Y_3] - v[Y_2]) == (-0.5, 0.2)
    assert q[ROTATION_3] == q[ROTATION_2]
    assert q[Y_3] == -q[Y_2]
