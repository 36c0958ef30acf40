"""The statement of a run: what follows from it, what is absent, and where it starts."""

import math
from dataclasses import MISSING, fields, replace

import numpy as np
import pytest
from problems import problem

from gearmesh.model import motion
from gearmesh.model.contact import NORMAL_MESH, elastic_force
from gearmesh.model.motion import (
    ROTATION_2,
    ROTATION_3,
    Y_2,
    Y_3,
    Z_2,
    Z_3,
    Mode,
    relative_motion,
    state_at,
    static_equilibrium,
)
from gearmesh.model.problem import Branches, GeneralTerms, Harmonic, Problem, State, Wheel

WHEELS = (
    Wheel(20, 60.0, 1.5, 30.0, (1.25, 0.8), (0.04, 0.05)),
    Wheel(41, 123.0, 3.0, 50.0, (0.5, 1.2), (0.02, 0.07)),
)
ECCENTRIC = problem(
    wheels=WHEELS, eccentricity_3=0.8, eccentricity_2=0.5, deviation=((0.1, 0.2),), base_radius=60.0
)


def test_what_follows_from_the_statement():
    one = problem(nu=0.8, revolutions=7, kept_revolutions=2, initial_phase=0.25)
    assert one.period == pytest.approx(2.5 * math.pi)
    assert one.start_time == pytest.approx(0.25 * 2.5 * math.pi)
    assert (one.start_period, one.periods, one.kept_periods) == (0, 147, 42)
    assert one.rotation_speeds == (0.8 / 21, 0.8 / 21)
    wheel = Wheel(21, 3000.0, 2.0, 32.0, (1.0, 1.0), (0.03, 0.03))
    assert one.both_wheels == (wheel, wheel)
    later = replace(one, initial_state=State(1.0, 0.0, 0.0, 0.0, periods=42))
    assert later.start_period == 42
    assert later.start_time == pytest.approx(42.25 * 2.5 * math.pi)
    two = replace(one, wheels=WHEELS)
    assert two.both_wheels is WHEELS
    assert two.rotation_speeds == (0.8 / 20, 0.8 / 41)


def test_the_damping_of_a_bearing_is_its_share_of_critical_damping():
    """b = 2 D sqrt(c m), so with D = 1 both roots of m x'' + b x' + c x = 0 coincide."""
    wheel = Wheel(20, 60.0, 2.0, 3.0, (1.5, 0.7), (1.0, 0.25))
    along, across = wheel.bearing_damping
    assert along**2 - 4.0 * 3.0 * 1.5 == pytest.approx(0.0, abs=1e-12)
    assert across == pytest.approx(0.5 * math.sqrt(2.1))


@pytest.mark.parametrize(("e_3", "e_2", "there"), [(0, 0, False), (1, 0, True), (0, 1, True)])
def test_run_out_is_that_of_either_wheel(e_3, e_2, there):
    assert problem(eccentricity_3=float(e_3), eccentricity_2=float(e_2)).has_run_out is there


def test_what_is_not_stated_is_absent():
    """The paper's examples use none of this."""
    needed = [field.name for field in fields(Problem) if field.default is MISSING]
    given = {name: getattr(problem(), name) for name in needed}
    one = Problem(**given)
    assert (one.eccentricity_3, one.eccentricity_2, one.eccentricity_angle) == (0.0, 0.0, 0.0)
    assert (one.deviation, one.stiffness_harmonics, one.initial_phase) == ((), 0, 0.0)
    assert (one.revolutions, one.kept_revolutions) == (5, 1)
    assert one.initial_state is None and one.wheels is None
    terms = one.terms
    assert terms == GeneralTerms()
    neutral = {"restoring_power": 1.0}
    pairs = ("torsional_damping", "tip_relief", "tip_relief_length")
    neutral |= dict.fromkeys(pairs, (0.0, 0.0))
    for field in fields(terms):
        absent = neutral.get(field.name, () if "tuple" in str(field.type) else 0)
        assert getattr(terms, field.name) == absent, field.name
    assert Mode(1, 0.5) == Mode(1, 0.5, 1, 1, False)
    assert elastic_force(2.0, 1.5, NORMAL_MESH, 4.0) == 3.0
    assert elastic_force(2.0, 1.5, NORMAL_MESH, 4.0, 0.5) == 6.0
    state = State(1.0, 2.0, 3.0, 4.0)
    assert (state.coordinates, state.periods, state.branches) == (None, 0, None)


def test_branches_hold_for_the_laws_that_they_were_found_for():
    one = problem(revolutions=3)
    branches = Branches(one, 1, 1.0, True)
    assert branches.signs == (1.0, 1.0)
    assert (branches.level, branches.exact, branches.parted) == (0.0, (False,) * 6, False)
    ended = State(1.0, 0.0, 0.0, 0.0, branches=branches)
    assert ended.branches_for(one) is branches
    # How long it runs and where it starts do not change the laws.
    assert ended.branches_for(replace(one, revolutions=9, kept_revolutions=4)) is branches
    assert ended.branches_for(replace(one, initial_state=ended)) is branches
    assert ended.branches_for(replace(one, backlash=3.0)) is None
    assert ended.branches_for(replace(one, nu=0.71)) is None
    assert State(1.0, 0.0, 0.0, 0.0).branches_for(one) is None


def test_the_moments_are_those_of_the_static_force_and_their_harmonics():
    terms = GeneralTerms(
        torque_harmonics_3=(Harmonic(2.0, 0.1, 0.3),), torque_harmonics_2=(Harmonic(1.0, 0.0, 0.2),)
    )
    one = problem(nu=0.8, terms=terms)
    load_3, load_2 = motion.loads(one, 1.5)
    assert load_3 == pytest.approx(1.0 + 0.1 * math.cos(2.4) + 0.3 * math.sin(2.4))
    assert load_2 == pytest.approx(1.0 + 0.2 * math.sin(1.2))
    assert motion.loads(problem(), 1.5) == (1.0, 1.0)


def test_in_static_equilibrium_the_bearings_carry_the_static_force():
    for one in (problem(bearing_stiffness=0.8), ECCENTRIC):
        for y in (1.0, -2.5):
            q, v = static_equilibrium(one, y)
            assert motion.bearing_pulls(one, q, v) == pytest.approx([-1.0, 1.0, 0.0, 0.0])
            assert q[ROTATION_3] == q[ROTATION_2]
            assert (v == 0.0).all()
            assert relative_motion(one, one.start_time, q, v)[0] == pytest.approx(y, abs=1e-14)
        assert static_equilibrium(one)[0].tolist() == static_equilibrium(one, 1.0)[0].tolist()


def test_a_state_is_given_by_the_motion_of_the_mesh():
    state = state_at(ECCENTRIC, 1.4, 0.6)
    q, v = np.array(state.coordinates[:6]), np.array(state.coordinates[6:])
    assert (state.y, state.v, state.b, state.b_rate) == (
        pytest.approx(1.4),
        0.6,
        pytest.approx(-1.0 / 1.25 - 1.0 / 0.5),
        0.0,
    )
    assert q.tolist() == static_equilibrium(ECCENTRIC, 1.4)[0].tolist()
    assert v.tolist() == [0.3, 0.3, 0.0, 0.0, 0.0, 0.0]
    assert state_at(ECCENTRIC) == state_at(ECCENTRIC, 1.0, 0.0)
    begun = motion.start(replace(ECCENTRIC, initial_state=state))
    assert (begun[0].tolist(), begun[1].tolist()) == (q.tolist(), v.tolist())


def test_a_state_is_given_by_all_coordinates():
    q, v = np.random.default_rng(6).normal(size=(2, 6))
    state = motion.state_of(ECCENTRIC, q, v)
    assert (state.y, state.v) == relative_motion(ECCENTRIC, ECCENTRIC.start_time, q, v)
    assert (state.b, state.b_rate) == (q[Y_3] - q[Y_2], v[Y_3] - v[Y_2])
    begun = motion.start(replace(ECCENTRIC, initial_state=state))
    assert (begun[0].tolist(), begun[1].tolist()) == (q.tolist(), v.tolist())


def test_y_of_a_state_is_the_sum_of_both_motions_of_the_reduced_system():
    """Rounded as (y - b) + b, so that a run that starts there has the same y bit for bit."""
    one = problem(bearing_stiffness=0.7)
    b = -1.0 / 0.7 - 1.0 / 0.7
    state = state_at(one, 1e-17)
    assert (state.b, state.y) == (b, (1e-17 - b) + b)
    assert state.y != 1e-17


def test_a_state_of_the_reduced_system_is_shared_as_the_bearings_yield():
    one = replace(ECCENTRIC, initial_state=State(1.3, 0.7, -0.9, 0.4))
    q, v = motion.start(one)
    assert q.shape == v.shape == (6,)
    pulls = motion.bearing_pulls(one, q, np.zeros(6))
    assert pulls[0] == pytest.approx(-pulls[1])
    assert q[Y_3] - q[Y_2] == pytest.approx(-0.9)
    assert v[Y_3] - v[Y_2] == pytest.approx(0.4)
    assert v[Y_3] / v[Y_2] == pytest.approx(q[Y_3] / q[Y_2])
    assert v[ROTATION_3] == v[ROTATION_2] == pytest.approx(0.15)
    assert q[ROTATION_3] == q[ROTATION_2]
    assert (q[Z_3], q[Z_2], v[Z_3], v[Z_2]) == (0.0,) * 4
    assert relative_motion(one, one.start_time, q, v)[0] == pytest.approx(1.3, abs=1e-14)


def test_a_run_starts_in_static_equilibrium():
    q, v = motion.start(ECCENTRIC)
    assert q.tolist() == static_equilibrium(ECCENTRIC)[0].tolist()
    assert v.tolist() == [0.0] * 6
