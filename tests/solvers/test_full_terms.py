"""Every term of eq. (1) and two different wheels, against SciPy's DOP853, over 24 periods.

`independent` states the equations for itself, from the paper, in all six coordinates.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from independent import integrate as integrate_independently
from independent_equations import Y_2, Y_3, Z_2, Z_3, bearing
from problems import problem

from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH
from gearmesh.model.functions import Harmonic
from gearmesh.model.motion import state_of
from gearmesh.model.problem import GeneralTerms, Problem, ToothFactor, Wheel
from gearmesh.solvers.full.runs import integrate

PERIODS = 24

PINION = Wheel(20, 2860.0, 1.5, 8.0, (1.2, 0.8), (0.03, 0.05))
WHEEL = Wheel(40, 5720.0, 3.0, 20.0, (2.0, 1.5), (0.02, 0.04))
"""20 teeth drive 40; on the mesh line the wheel has twice the mass of the pinion."""

BUMP = (0.2, 0.5, 0.65, 0.5, 0.2)
"""Stiffness of a pair of teeth along its path."""


def pair(nu=0.7, name="c-both", terms=None, **changes) -> Problem:
    """Return a run of equal wheels with further terms."""
    return problem(nu, name, terms=GeneralTerms(**(terms or {})), **changes)


def unequal(nu=0.7, name="c-both", terms=None, **changes) -> Problem:
    """Return a run of the pinion and the wheel."""
    wheels = PINION, WHEEL
    of_pinion = {
        "teeth": 20,
        "base_radius": PINION.base_radius,
        "body_mass": PINION.body_mass,
        "bearing_stiffness": PINION.bearing_stiffness[0],
        "bearing_damping_ratio": PINION.bearing_damping_ratio[0],
    }
    return pair(nu, name, terms, **{"wheels": wheels, **of_pinion, **changes})


RATES = np.array([0.2, 0.1, -0.05, 0.0, 0.1, 0.05])
RUN_OUT = {"eccentricity_3": 0.5, "eccentricity_2": 0.3, "eccentricity_angle": 1.0}
ONCE_A_TURN = (Harmonic(1.0 / 20, 0.1, 0.2),)
TORQUE = {
    "torque_harmonics_3": (Harmonic(1.0, 0.15, 0.05), *ONCE_A_TURN),
    "torque_harmonics_2": (Harmonic(0.5, 0.0, 0.1),),
}
SWING = {"torque_harmonics_3": (Harmonic(0.5, 1.2, 0.0),)}
CRACK = (ToothFactor(3, 2, 0.6), ToothFactor(2, 5, 0.8))
WAVES = {"stiffness_fourier": ((0.2, 0.05), (0.05, -0.03))}
TABLE = {"stiffness_table": ((0.0, 1.2), (0.3, 1.2), (0.35, 0.8), (0.65, 0.8), (1.0, 1.2))}
STIFFENING = {"restoring_2": 0.1, "restoring_3": 0.05}
UNEVEN = {
    "pitch_errors_3": tuple(0.3 * math.sin(1.7 * tooth) for tooth in range(20)),
    "pitch_errors_2": tuple(0.2 * math.cos(2.3 * tooth) for tooth in range(40)),
}
RELIEF = {"tip_relief": (0.9, 0.6), "tip_relief_length": (0.5, 0.3)}
FOLLOWS = {"backlash_follows_centres": True}
BREATHING = {"backlash_harmonics": (Harmonic(0.05, 0.1, 0.05), Harmonic(1.0, 0.05, 0.0))}

RAMPS = {
    "run-up": pair(0.6, "c-both", final_nu=1.2),
    "run-up, two wheels, contact loss": unequal(0.7, "c-lubricant", TORQUE, final_nu=1.0),
    "run-down, stiffness of a pair of teeth, deviation": unequal(
        0.9, "b-both", {"tooth_pair_stiffness": BUMP}, final_nu=0.5, deviation=((0.1, 0.05),)
    ),
    "run-down, run-out, sliding": unequal(
        0.75, "c-both", friction_coefficient=0.02, final_nu=0.6, **RUN_OUT
    ),
}
"""Runs in which the speed changes linearly."""

CASES = {
    **RAMPS,
    "two wheels": unequal(),
    "two wheels, contact loss": unequal(0.85, "c-lubricant", friction_coefficient=0.1),
    "two wheels, back flanks": unequal(0.9, "b-both", backlash=0.4),
    "two wheels, run-out": unequal(0.7, "b-material", **RUN_OUT),
    "two wheels, run-out, sliding": unequal(0.7, "c-both", friction_coefficient=0.02, **RUN_OUT),
    "different bearings, equal wheels": unequal(
        0.8, wheels=(replace(WHEEL, inertia=2.0), replace(WHEEL, inertia=2.0, body_mass=10.0))
    ),
    "torque": pair(terms=TORQUE),
    "torque, two wheels, contact loss": unequal(0.85, "c-lubricant", TORQUE),
    "torsional damping": unequal(0.7, "b-material", {"torsional_damping": (0.05, 0.02)}),
    "torsional damping, torque, equal wheels": pair(
        0.8, "a-conservative", {**TORQUE, "torsional_damping": (0.1, 0.2)}
    ),
    "Fourier stiffness": pair(0.75, "h-both", WAVES),
    "Fourier stiffness, two wheels, contact loss": unequal(0.95, "d-lubricant", WAVES),
    "table": pair(0.75, "b-both", TABLE),
    "table, two wheels": unequal(0.8, "c-lubricant", TABLE, friction_coefficient=0.0),
    "tooth pair": unequal(0.75, "b-both", {"tooth_pair_stiffness": BUMP}),
    "tooth pair, three in contact": unequal(
        0.75, "b-both", {"tooth_pair_stiffness": BUMP}, contact_ratio=2.4
    ),
    "cracked teeth": pair(0.7, "b-material", {"tooth_factors": CRACK}),
    "cracked teeth, tooth pair": unequal(
        0.8, "c-both", {"tooth_factors": CRACK, "tooth_pair_stiffness": BUMP}
    ),
    "stiffening": pair(0.75, "c-both", STIFFENING),
    "stiffening, back flanks, two wheels": unequal(0.9, "b-lubricant", STIFFENING, backlash=0.3),
    "stiffening, Fourier": unequal(0.7, "b-both", {**STIFFENING, **WAVES}),
    "stiffening that varies, contact loss": pair(
        0.85, "c-lubricant", {**STIFFENING, "restoring_fourier": ((0.5, 0.2), (0.0, -0.3))}
    ),
    "non-adhesive": pair(0.85, "b-both", {"non_adhesive": True}),
    "non-adhesive, back flanks": pair(0.9, "b-both", {"non_adhesive": True}, backlash=0.4),
    "non-adhesive, two wheels, strong damping": unequal(
        0.8, "g-both", {"non_adhesive": True, **SWING}, material=(0.3, 0.2, 0.1)
    ),
    "damping with the root of the stiffness": pair(0.75, "c-both", {"damping_power": 0.5}),
    "damping with the stiffness, Fourier": unequal(0.75, "g-both", {"damping_power": 1.0, **WAVES}),
    "damping with the root, Fourier": pair(0.75, "b-both", {"damping_power": 0.5, **WAVES}),
    "breathing backlash": pair(0.9, "b-both", BREATHING, backlash=0.5),
    "breathing backlash, two wheels, run-out": unequal(
        0.9, "b-both", BREATHING, backlash=0.5, friction_coefficient=0.0, **RUN_OUT
    ),
    "Hertz, contact loss": pair(0.85, "c-lubricant", {"restoring_power": 10 / 9}),
    "Hertz, back flanks, two wheels": unequal(
        0.6,
        "b-both",
        {"restoring_power": 1.5, "torque_harmonics_3": (Harmonic(0.5, 2.5, 0.0),)},
        backlash=0.3,
    ),
    "backlash of the centres, back flanks": pair(0.9, "b-both", FOLLOWS, backlash=0.5),
    "backlash of the centres, back flanks, two wheels, run-out": unequal(
        0.9,
        "b-both",
        {**FOLLOWS, **BREATHING},
        backlash=0.5,
        friction_coefficient=0.0,
        **RUN_OUT,
    ),
    "pitch errors, two wheels, contact loss": unequal(0.8, "c-lubricant", UNEVEN),
    "tip relief, Hertz": pair(0.75, "c-both", {**RELIEF, "restoring_power": 1.2}),
    "tip relief, pitch errors, three in contact": unequal(
        0.85,
        "b-both",
        {**RELIEF, **UNEVEN, "tooth_pair_stiffness": BUMP, "non_adhesive": True, **SWING},
        backlash=0.8,
        contact_ratio=2.4,
        friction_coefficient=0.0,
        **RUN_OUT,
    ),
    "six coordinates at the start, two wheels": unequal(
        0.8, initial_state=state_of(unequal(), np.array([0.9, 0.4, 0.3, -0.2, 0.1, 0.0]), RATES)
    ),
    "everything": unequal(
        0.85,
        "g-both",
        {
            **{"tooth_pair_stiffness": BUMP, "tooth_factors": CRACK, "damping_power": 0.5},
            **{"torsional_damping": (0.02, 0.03), "non_adhesive": True},
            **TORQUE,
            **STIFFENING,
            **BREATHING,
            **UNEVEN,
            **RELIEF,
            **FOLLOWS,
        },
        backlash=0.6,
        deviation=((0.1, 0.05),),
        initial_phase=0.2,
        **RUN_OUT,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_agrees_with_dop853(name):
    case = replace(CASES[name], revolutions=2, kept_revolutions=2)
    course = integrate_independently(case, PERIODS)
    response = integrate(case, 1e-12, estimate_errors=False)
    assert response.status == "ok"
    found = np.stack([response.strobe_y, response.strobe_v], axis=1)[: PERIODS + 1]
    np.testing.assert_allclose(found, course.strobes, atol=1e-8, rtol=0)
    count = len(course.extrema) - 1
    times = course.extrema[:count, 0]
    np.testing.assert_allclose(response.extremum_time[:count], times, atol=1e-6, rtol=0)
    np.testing.assert_allclose(response.extremum_y[:count], course.extrema[:count, 1], atol=1e-8)
    regimes = {value for _, value in course.regimes}
    assert CONTACT_LOSS in regimes or "contact loss" not in name
    assert INVERSE_MESH in regimes or "back flanks" not in name
    assert course.pressings > 100 or "tip relief" not in name
    assert course.partings > 1 or "non-adhesive" not in name
    assert {value for _, value in course.slips} >= {-1, 0} or "sliding" not in name


def test_bearings_have_the_forces_of_dop853_along_the_mesh_line_and_across_it():
    case = replace(CASES["two wheels, contact loss"], revolutions=2, kept_revolutions=1)
    course = integrate_independently(case, case.teeth)
    response = integrate(case, 1e-12, 8, estimate_errors=False)
    found = response.samples
    forces = (
        *(found.force_bearing_3, found.force_bearing_2),
        *(found.force_bearing_3_z, found.force_bearing_2_z),
    )
    expected = [-bearing(case, i, course.state) for i in (Y_3, Y_2, Z_3, Z_2)]
    assert [force[0] for force in forces] == pytest.approx(expected, abs=1e-8)
    assert min(abs(force) for force in expected[2:]) > 1e-3
    for force, (least, greatest) in zip(forces, found.extremes[2:], strict=True):
        assert least <= force.min() < force.max() <= greatest
    plain = integrate(case, 1e-12, estimate_errors=False)
    np.testing.assert_array_equal(response.strobe_y, plain.strobe_y)
