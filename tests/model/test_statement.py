"""The equations of motion against those of `independent_equations`, which share no code."""

import math
from dataclasses import replace

import independent_equations as afresh
import numpy as np
import pytest
from problems import problem

from gearmesh.model import motion
from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH
from gearmesh.model.motion import Mode
from gearmesh.model.problem import GeneralTerms, Harmonic, ToothFactor, Wheel

ROUGH = problem(
    0.83,
    "g-both",
    friction_coefficient=0.2,
    base_radius=70.0,
    eccentricity_3=0.9,
    eccentricity_2=0.7,
    eccentricity_angle=1.3,
    deviation=((0.1, -0.2), (0.05, 0.03)),
    lubricant=(0.2, 0.1, 0.4),
)
WHEELS = (
    Wheel(20, 60.0, 1.5, 30.0, (1.1, 0.8), (0.04, 0.05)),
    Wheel(41, 123.0, 3.0, 50.0, (0.9, 1.2), (0.02, 0.07)),
)
TERMS = GeneralTerms(
    torque_harmonics_3=(Harmonic(1.0, 0.1, 0.2), Harmonic(0.05, 0.0, 0.3)),
    torque_harmonics_2=(Harmonic(2.0, -0.1, 0.25),),
    torsional_damping=(0.3, 0.2),
    restoring_2=0.11,
    restoring_3=0.07,
    damping_power=0.5,
    backlash_harmonics=(Harmonic(1.0, 0.3, -0.2),),
)
TABLE = ((0.0, 1.1), (0.3, 1.3), (0.3, 0.9), (0.6, 0.7), (1.0, 1.1))
PROBLEMS = {
    "equal wheels": ROUGH,
    "equal wheels, no run-out": replace(ROUGH, eccentricity_3=0.0, eccentricity_2=0.0),
    "cut series": replace(ROUGH, stiffness_harmonics=4, friction_coefficient=1.0),
    "series": replace(
        ROUGH,
        terms=replace(TERMS, stiffness_fourier=((0.2, 0.1), (0.03, -0.05)), damping_power=1.0),
    ),
    "two wheels": replace(ROUGH, wheels=WHEELS, teeth=20, terms=TERMS),
    "table": replace(ROUGH, terms=replace(TERMS, stiffness_table=TABLE)),
    "single teeth": replace(
        ROUGH,
        wheels=WHEELS,
        teeth=20,
        terms=replace(TERMS, tooth_factors=(ToothFactor(3, 2, 0.5), ToothFactor(2, 3, 0.25))),
    ),
    "pairs of teeth": replace(
        ROUGH,
        contact_ratio=2.3,
        terms=GeneralTerms(
            tooth_pair_stiffness=(0.4, 0.9, 0.8, 0.5),
            tooth_factors=(ToothFactor(3, 1, 0.5), ToothFactor(2, 1, 0.7), ToothFactor(2, 2, 0.3)),
        ),
    ),
    "frictionless": replace(ROUGH, friction_coefficient=0.0, terms=TERMS),
    "power of Hertz": replace(ROUGH, terms=replace(TERMS, restoring_power=1.5)),
    "gap of the centres": replace(
        ROUGH, wheels=WHEELS, teeth=20, terms=replace(TERMS, backlash_follows_centres=True)
    ),
    "flanks": replace(
        ROUGH,
        terms=replace(
            TERMS,
            pitch_errors_3=tuple(0.1 * (n % 4) for n in range(21)),
            pitch_errors_2=tuple(-0.07 * (n % 3) for n in range(21)),
            tip_relief=(0.5, 0.4),
            tip_relief_length=(0.45, 0.35),
            tooth_factors=(ToothFactor(3, 1, 0.5),),
        ),
    ),
}
SIGNS = [(1, 1), (1, -1), (-1, 1), (-1, -1), (1, 0)]


def pressing_pairs(one, segment, presses):
    """Return the pairs that press, by their numbers and as `Mode.pressing` has them."""
    if not afresh.deviates(one):
        return (), ()
    numbers = [p for _, _, p in afresh.pairs(one, segment)]
    chosen = tuple(p for p in numbers if presses(p))
    return chosen, tuple(float(p in chosen) for p in sorted(numbers, reverse=True))


def states(seed):
    """Yield times in mesh periods, coordinates and rates."""
    rng = np.random.default_rng(seed)
    for phase in (0.07, 0.38, 0.55, 1.68, 2.93):
        yield phase + 0.01, phase, rng.normal(size=6), rng.normal(size=6)


@pytest.mark.parametrize("parted", [False, True])
@pytest.mark.parametrize("regime", [NORMAL_MESH, CONTACT_LOSS, INVERSE_MESH])
@pytest.mark.parametrize("name", PROBLEMS)
def test_the_accelerations_are_those_of_the_independent_statement(name, regime, parted):
    one = PROBLEMS[name]
    signed = SIGNS if one.friction_coefficient and not parted else SIGNS[:1]
    for run_out_sign, slip_sign in signed:
        for phase, segment, q, v in states(9):
            time = phase * one.period
            q[0] += {NORMAL_MESH: 6.0, CONTACT_LOSS: -1.0, INVERSE_MESH: -14.0}[regime]
            which = pressing_pairs(one, segment, lambda p, n=run_out_sign: p % 2 or n > 0)
            signs = run_out_sign, slip_sign, parted
            mode = Mode(regime, segment, *signs, which[1])
            known = afresh.Mode(regime, segment, *signs, which[0])
            expected = afresh.rates(one, time, [*q, *v], known)[6:]
            found = motion.accelerations(one, time, q, v, mode)
            np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_relative_motion_and_its_rate_are_those_of_the_independent_statement(name):
    one = PROBLEMS[name]
    for phase, _, q, v in states(5):
        time = phase * one.period
        expected = afresh.relative_motion(one, time, [*q, *v])
        assert motion.relative_motion(one, time, q, v) == pytest.approx(expected, rel=1e-13)
        assert motion.displacement(one, time, q) == pytest.approx(expected[0], rel=1e-13)
        found = motion.run_out_argument(one, time, q, v)
        assert found == pytest.approx(afresh.bracket(one, time, [*q, *v]), rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("name", ["equal wheels", "two wheels"])
def test_the_run_out_integral_grows_by_the_bracket(name):
    one = PROBLEMS[name]
    q, v = np.random.default_rng(2).normal(size=(2, 6))
    step, time = 1e-5, 40.0
    ahead, behind = (motion.run_out_integral(one, time + h, q + h * v) for h in (step, -step))
    bracket = afresh.bracket(one, time, [*q, *v])
    assert (ahead - behind) / (2.0 * step) == pytest.approx(bracket, rel=1e-7)
    # At rest at the angle 0 the cosines are 1 and cos(Delta).
    still = motion.run_out_integral(one, 0.0, np.zeros(6))
    expected = one.eccentricity_3 + one.eccentricity_2 * math.cos(one.eccentricity_angle)
    assert still == pytest.approx(-expected, rel=1e-14)


@pytest.mark.parametrize("name", PROBLEMS)
def test_without_a_mode_the_branches_of_the_state_act(name):
    one = PROBLEMS[name]
    for offset in (0.0, -2.0, -8.0):
        for phase, _, q, v in states(7):
            q[motion.ROTATION_3] += offset
            time = phase * one.period
            y, _ = afresh.relative_motion(one, time, [*q, *v])
            gap = afresh.backlash(one, time, [*q, *v])
            assert motion.gap(one, time, q) == pytest.approx(gap, rel=1e-13)
            regime = NORMAL_MESH if y >= 0 else INVERSE_MESH if y <= -gap else CONTACT_LOSS
            which = pressing_pairs(
                one, phase, lambda p, t=time, at=y: at >= afresh.distance(one, t, p)
            )
            if which[1]:
                regime = NORMAL_MESH if which[0] else min(regime, CONTACT_LOSS)
            signs = (1, 1)
            if one.eccentricity_3 + one.eccentricity_2:
                bracket = afresh.bracket(one, time, [*q, *v])
                signs = math.copysign(1, bracket), math.copysign(1, v[4] - v[5])
            found = motion.mode_of(one, time, q, v)
            assert (found.regime, found.run_out_sign, found.slip_sign) == (regime, *signs)
            assert found.segment == pytest.approx(phase, rel=1e-14)
            assert not found.parted
            assert found.pressing == which[1]
            mode = afresh.Mode(regime, phase, *signs, pressing=which[0])
            expected = afresh.rates(one, time, [*q, *v], mode)[6:]
            np.testing.assert_allclose(
                motion.accelerations(one, time, q, v), expected, rtol=1e-11, atol=1e-12
            )


def test_a_sign_is_positive_where_its_argument_is_zero():
    """At t = 0 in the angle 0 the bracket vanishes without e_2, and so does the slip at rest."""
    one = replace(ROUGH, eccentricity_2=0.0)
    found = motion.mode_of(one, 0.0, np.zeros(6), np.zeros(6))
    assert (found.run_out_sign, found.slip_sign) == (1, 1)


@pytest.mark.parametrize(("y", "side"), [(0.5, NORMAL_MESH), (-6.0, INVERSE_MESH)])
@pytest.mark.parametrize("speed", [3.0, -3.0, 0.0])
def test_flanks_that_do_not_adhere_part_where_the_contact_force_would_pull(y, side, speed):
    sticky = problem(0.8, "b-both", material=(2.0, 0.0, 0.0), friction_coefficient=0.0)
    free = replace(sticky, terms=GeneralTerms(non_adhesive=True))
    q, v = np.zeros(6), np.zeros(6)
    q[0], v[1] = y, speed
    force = sticky.stiffness_max * (y if side == NORMAL_MESH else y + 4.0) + 2.0 * speed
    pulls = force * side < 0.0
    assert motion.mode_of(free, 0.0, q, v).regime == side
    assert motion.mode_of(free, 0.0, q, v).parted == pulls
    assert not motion.mode_of(sticky, 0.0, q, v).parted
    acting = 0.0 if pulls else force
    assert 2.0 * motion.accelerations(free, 0.0, q, v)[0] == pytest.approx(1.0 - acting)
    # In contact loss the lubricant may pull, and where flanks just touch nothing does.
    q[0] = -1.0
    assert not motion.mode_of(free, 0.0, q, v).parted
    assert not motion.mode_of(free, 0.0, np.zeros(6), np.zeros(6)).parted


def test_the_forces_of_parted_flanks_are_none_but_the_contact_force_is_known():
    q, v = np.random.default_rng(3).normal(size=(2, 6))
    y, rate = 0.7, -0.3
    acting, parted = (
        motion.forces(ROUGH, 1.0, q, v, y, rate, Mode(NORMAL_MESH, 0.1, 1, 1, flag))
        for flag in (False, True)
    )
    x = [*q, *v]
    x[0] += y - afresh.relative_motion(ROUGH, 1.0, x)[0]
    assert acting.elastic == pytest.approx(ROUGH.stiffness_max * y)
    assert acting.normal == acting.contact
    assert parted.contact == acting.contact != acting.elastic
    assert parted.stiffness == acting.stiffness == ROUGH.stiffness_max
    assert parted[1:2] + parted[3:] == (0.0,) * 5


def test_flanks_that_stick_are_held_by_the_bearings_alone():
    """F_T keeps z_3'' = z_2'', and each pair of teeth takes an equal share of it."""
    for one in (ROUGH, PROBLEMS["two wheels"]):
        q, v = np.random.default_rng(4).normal(size=(2, 6))
        v[motion.Z_3] = v[motion.Z_2]
        for segment in (0.1, 0.4):
            mode = Mode(NORMAL_MESH, segment, 1, 0)
            a = motion.accelerations(one, segment * one.period, q, v, mode)
            assert a[motion.Z_3] == pytest.approx(a[motion.Z_2], rel=1e-12)
