"""The rate at which neighbouring motions part, for many motions at once."""

import numpy as np

from gearmesh.solvers.reduced.ensembles import advance

LEAST_GROWTH = 2e-3
"""Largest Lyapunov exponent, in Omega_s, above which a motion is chaotic."""

_APART = 1e-7  # distance to which a neighbour is brought back
_TRANSIENT = 10  # spans in which the neighbours turn in the direction of growth
_SPANS = 40
_PERIODS = 10  # mesh periods of a span


def growth_rates(laws: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return estimates of the largest Lyapunov exponents of motions, in Omega_s.

    Each motion has a neighbour, which is brought back close to it after every span. The exact
    Jacobian (`gearmesh.dynamics.attraction.lyapunov`) would take far longer.

    Parameters
    ----------
    laws : ndarray, shape (n,) or (1,)
        See `gearmesh.solvers.reduced.ensembles`.
    states : ndarray, shape (n, 4)

    Returns
    -------
    ndarray, shape (n,)
        Not-a-number if a motion runs away.
    """
    n = len(states)
    both = laws if len(laws) == 1 else np.concatenate([laws, laws])
    direction = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    total = np.zeros(n)
    for span in range(_TRANSIENT + _SPANS):
        pairs = np.concatenate([states, states + _APART * direction])
        ends = advance(both, pairs, _PERIODS)
        states, away = ends[:n], ends[n:] - ends[:n]
        apart = np.linalg.norm(away, axis=1)
        direction = away / np.maximum(apart, np.finfo(float).tiny)[:, None]
        if span >= _TRANSIENT:
            total += np.log(np.maximum(apart, np.finfo(float).tiny) / _APART)
    return total / (_SPANS * _PERIODS * laws["period"])
