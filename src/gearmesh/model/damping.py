"""The damping force of eq. (7)."""

from collections.abc import Sequence

from gearmesh.model.functions import Number


def damping_force(velocity: Number, law: Sequence[float]) -> Number:
    """Return the damping force of eq. (7), k1 v + k2 abs(v) v + k3 v^3.

    Parameters
    ----------
    velocity : float, ndarray or series
        v = dy/dtau_s, in y_st.
    law : sequence of three float
        k1, k2, k3: force in F_st of v, abs(v) v and v^3 at v = 1.

    Returns
    -------
    float, ndarray or series, as `velocity`
        Force in F_st, with the sign of `velocity`.
    """
    linear, quadratic, cubic = law
    return (linear + quadratic * abs(velocity) + cubic * velocity * velocity) * velocity
