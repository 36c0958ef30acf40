"""The damping force of eq. (7)."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.model.damping import damping_force


def test_powers_of_the_velocity():
    v = np.array([-2.0, 0.5])
    np.testing.assert_allclose(damping_force(v, (3.0, 0.0, 0.0)), [-6.0, 1.5])
    np.testing.assert_allclose(damping_force(v, (0.0, 3.0, 0.0)), [-12.0, 0.75])
    np.testing.assert_allclose(damping_force(v, (0.0, 0.0, 3.0)), [-24.0, 0.375])


@given(st.floats(-10, 10), st.tuples(*3 * [st.floats(0, 5)]))
def test_damping_dissipates_in_both_directions_alike(v, law):
    force = damping_force(v, law)
    assert force * v >= 0.0
    assert damping_force(-v, law) == -force
