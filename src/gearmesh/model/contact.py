"""Contact of the flanks: the regimes of the mesh and its elastic force.

The functions take floats or arrays and compile with numba, so that every solver uses them
unchanged.
"""

from typing import Any

NORMAL_MESH, CONTACT_LOSS, INVERSE_MESH = 1, 0, -1
"""Regimes of the mesh: y >= 0, -s < y < 0 and y <= -s."""

Number = Any
"""A float or an array."""


def regime_of(y: Number, backlash: Number) -> Number:
    """Return the regime at the relative motion `y`, with the signs of H1 and H2 in eq. (1)."""
    return 1 * (y >= 0.0) - 1 * (y <= -backlash)


def touching_level(regime: Number, backlash: Number) -> Number:
    """Return the y at which the flanks of a regime begin to touch: 0, or -s in inverse mesh."""
    return -backlash * (regime == INVERSE_MESH)


def elastic_force(y: Number, c: Number, regime: Number, backlash: Number) -> Number:
    """Return C (y H1 + (y + s) H2), in the unit of `c` times `y`."""
    return c * (y - touching_level(regime, backlash)) * (regime != CONTACT_LOSS)


def dynamic_force(y: Number, c: Number) -> Number:
    """Return F_dyn of eq. (2); unlike the elastic force it does not vanish in contact loss."""
    return c * y
