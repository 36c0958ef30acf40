"""The fast solver against SciPy's DOP853 on the six equations of motion, over one revolution.

The two share the statement of the problem and nothing else: other coordinates, another method,
other ways to find events. Every letter of Tab. 1, every symbol, back-flank contact, friction and
stiff supports are among the cases. `test_peers` compares longer runs with heyoka, and grazing.
"""

import numpy as np
import pytest
from independent import integrate
from problems import problem

from gearmesh.solvers.simulation import simulate

LENGTH = {"revolutions": 1}

CASES = [
    ("a-conservative", 1.1, {}),
    ("b-material", 0.7, {}),
    ("b-lubricant", 0.85, {"backlash": 0.5}),  # back flanks touch
    ("b-both", 0.9, {}),
    ("c-material", 0.61, {}),
    ("c-lubricant", 0.85, {}),
    ("c-both", 1.0, {"friction_coefficient": 0.0}),
    ("d-material", 0.65, {"friction_coefficient": 0.1}),
    ("d-lubricant", 1.0, {}),
    ("d-both", 0.7, {}),
    ("e-lubricant", 0.9, {"initial_phase": 0.3}),
    ("f-material", 0.8, {"body_mass": 4.0}),
    ("g-both", 1.15, {"backlash": 0.4}),
    ("h-lubricant", 0.75, {}),
    ("h-material", 0.6, {"bearing_stiffness": 20.0, "body_mass": 8.0}),
]


@pytest.mark.parametrize(("name", "nu", "changes"), CASES, ids=lambda case: str(case))
def test_agrees_with_dop853_on_six_coordinates(name, nu, changes):
    case = problem(nu, name, **LENGTH, **changes)
    course = integrate(case)
    response = simulate([case], tolerance=1e-12)[0]
    found = np.stack([response.strobe_y, response.strobe_v], axis=1)
    np.testing.assert_allclose(found, course.strobes, atol=1e-8, rtol=0)
    kept = course.extrema[course.extrema[:, 0] >= response.extremum_time[0] - 1e-6]
    np.testing.assert_allclose(response.extremum_y, kept[:, 1], atol=1e-8, rtol=0)
    np.testing.assert_array_equal(response.extremum_kind, kept[:, 2])


def test_the_cases_reach_what_they_are_for():
    """Back flanks touch and contact is lost in the cases that the list marks."""
    reached = {
        (name, nu): simulate([problem(nu, name, **LENGTH, **changes)])[0]
        for name, nu, changes in CASES
    }
    assert reached["b-lubricant", 0.85].inverse_mesh_fraction > 0
    assert reached["c-lubricant", 0.85].contact_loss_fraction > 0
