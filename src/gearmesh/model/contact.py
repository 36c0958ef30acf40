"""Contact of the flanks: the regimes of the mesh and its elastic force.

The functions take floats or arrays, so that every solver uses them unchanged.
"""

from gearmesh.model.functions import Number, power

NORMAL_MESH, CONTACT_LOSS, INVERSE_MESH = 1, 0, -1
"""Regimes of the mesh: y >= 0, -s < y < 0 and y <= -s."""

ONSET = 1e-6
"""Depth in y_st below which Hertz' force is close to linear, so that it has a Taylor series at 0.

At a depth d, the relative difference from Hertz' power law is below (`ONSET` / d)^2.
"""


def regime_of(y: Number, backlash: Number) -> Number:
    """Return the regime at the relative motion `y`, with the signs of H1 and H2 in eq. (1)."""
    return 1 * (y >= 0.0) - 1 * (y <= -backlash)


def touching_level(regime: Number, backlash: Number) -> Number:
    """Return the y at which the flanks of a regime begin to touch: 0, or -s in inverse mesh."""
    return -backlash * (regime == INVERSE_MESH)


def elastic_force(
    y: Number,
    c: Number,
    regime: Number,
    backlash: Number,
    quadratic: Number = 0.0,
    cubic: Number = 0.0,
    exponent: float = 1.0,
) -> Number:
    """Return the elastic force of eq. (1), in the unit of `c` times `y`.

    With d = y in normal mesh and d = y + s in inverse mesh it is C (d + c_2 d abs(d) + c_3 d^3);
    without the `quadratic` c_2 and the `cubic` c_3 this is C (y H1 + (y + s) H2). If the `exponent`
    p is not 1, d (d^2 + o^2)^((p - 1)/2) with o = `ONSET` replaces the first d. This is Hertz'
    power of d, made linear near 0.
    """
    depth = y - touching_level(regime, backlash)
    stiffening = (quadratic * regime + cubic * depth) * depth
    hardening = 1.0
    if exponent != 1.0:
        hardening = power(depth * depth + ONSET**2, 0.5 * (exponent - 1.0))
    return c * depth * (regime != CONTACT_LOSS) * (hardening + stiffening)


def dynamic_force(y: Number, c: Number) -> Number:
    """Return F_dyn of eq. (2); unlike the elastic force it does not vanish in contact loss."""
    return c * y
