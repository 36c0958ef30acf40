"""The general solver against SciPy's DOP853 on the same six equations, over two revolutions.

What the reduced system leaves out is here: run-out with both signs of eq. (6) and sticking,
profile deviation and the truncated series of C(t), in normal mesh, contact loss and back-flank
contact.
"""

from dataclasses import replace

import numpy as np
import pytest
from independent import integrate as integrate_independently
from problems import problem

from gearmesh.model.contact import INVERSE_MESH
from gearmesh.model.problem import Problem
from gearmesh.solvers.full.runs import integrate

RUN_OUT = {"eccentricity_3": 0.5, "eccentricity_2": 0.3, "eccentricity_angle": 1.0}

CASES = {
    "run-out": problem(0.7, "b-material", **RUN_OUT),
    "run-out, light bodies": problem(
        0.7, "c-both", **RUN_OUT, body_mass=2.0, friction_coefficient=0.1
    ),
    "run-out, contact loss": problem(
        0.9, "d-lubricant", eccentricity_3=1.0, deviation=((0.05, 0.02),)
    ),
    "run-out, back flanks": problem(0.9, "b-both", **RUN_OUT, backlash=0.4),
    "truncated series, run-out": problem(0.75, "h-both", **RUN_OUT, stiffness_harmonics=4),
    "truncated series, deviation": problem(
        0.65, "e-material", stiffness_harmonics=3, deviation=((0.1, 0.05), (0.0, 0.04))
    ),
    "friction alone": problem(0.7, "f-material", friction_coefficient=0.1, initial_phase=0.4),
}


@pytest.fixture(scope="module")
def courses():
    """Solutions by SciPy, each made when it is first asked for."""
    made = {}

    def course(name):
        if name not in made:
            case = replace(CASES[name], revolutions=2)
            made[name] = integrate_independently(case)
        return made[name]

    return course


@pytest.mark.parametrize("name", CASES)
def test_agrees_with_dop853(name, courses):
    case: Problem = replace(CASES[name], revolutions=2)
    course, response = courses(name), integrate(case, 1e-12)
    found = np.stack([response.strobe_y, response.strobe_v], axis=1)
    np.testing.assert_allclose(found, course.strobes, atol=1e-8, rtol=0)
    kept = course.extrema[course.extrema[:, 0] > 21 * case.period]
    np.testing.assert_allclose(response.extremum_time, kept[:, 0], atol=1e-6)
    np.testing.assert_allclose(response.extremum_y, kept[:, 1], atol=1e-8)
    np.testing.assert_array_equal(response.extremum_kind, kept[:, 2])


def test_the_cases_reach_what_they_are_for(courses):
    slips = [value for _, value in courses("run-out, light bodies").slips]
    assert {-1, 0, 1} == set(slips)
    assert len(courses("run-out, contact loss").regimes) > 40
    regimes = [value for _, value in courses("run-out, back flanks").regimes]
    assert INVERSE_MESH in regimes
