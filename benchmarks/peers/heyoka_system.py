"""The reduced problem as a heyoka system: one compiled integrator for each set of damping terms.

Time runs in mesh periods, so all runs of a batch meet their stiffness switches at the same
instants, and w = dy/dt is T times the velocity. All that varies from run to run or changes at an
event is a runtime parameter; the powers of T are put into the parameters, where they cost
nothing. |v| v is written as ±v², the sign a parameter that changes at the turning points.
"""

from typing import NamedTuple

import heyoka as hy

from benchmarks.reduced import Piece, Terms, support
from gearmesh.model.problem import Problem

(
    LOAD,
    STIFFNESS,
    OFFSET,
    SHARE,
    LINEAR,
    QUADRATIC,
    CUBIC,
    SUPPORT,
    SUPPORT_DAMPING,
    SUPPORT_STIFFNESS,
    BACKLASH,
    SWITCH,
) = range(12)
"""Places of the runtime parameters (plain integers: the callbacks are in a hurry)."""

Y, W, BODY, BODY_RATE = hy.make_vars("y", "w", "Y", "W")


def equations(terms: Terms) -> list:
    """Return the equations of motion with the damping terms that act."""
    par = hy.par
    elastic = par[STIFFNESS] * (Y - par[OFFSET])
    damped = 0.0
    if terms.linear:
        damped = damped + par[LINEAR] * W
    if terms.quadratic:
        damped = damped + par[QUADRATIC] * (W * W)
    if terms.cubic:
        damped = damped + par[CUBIC] * (W * (W * W))
    body = (
        -par[SUPPORT] * (elastic + damped)
        - par[SUPPORT_DAMPING] * BODY_RATE
        - par[SUPPORT_STIFFNESS] * BODY
    )
    relative = par[LOAD] - par[SHARE] * elastic - damped + body
    return [(Y, W), (W, relative), (BODY, BODY_RATE), (BODY_RATE, body)]


class Scaled(NamedTuple):
    """One run's constants, with time in mesh periods.

    Attributes
    ----------
    period : float
        T in 1/Ω_s.
    fixed : dict
        The parameters that never change.
    stiffness, share : tuple of float
        For each piece of the mesh period.
    damping : dict
        The three coefficients for each regime.
    """

    period: float
    fixed: dict[int, float]
    stiffness: tuple[float, ...]
    share: tuple[float, ...]
    damping: dict[int, tuple[float, float, float]]


def scaled(problem: Problem, cut: tuple[Piece, ...]) -> Scaled:
    """Rescale the constants of `problem`."""
    t = problem.period
    body, rate, square = support(problem)
    contact, loss = ((k1 * t, k2, k3 / t) for k1, k2, k3 in (problem.material, problem.lubricant))
    return Scaled(
        period=t,
        fixed={
            LOAD: t * t,
            SUPPORT: body,
            SUPPORT_DAMPING: rate * t,
            SUPPORT_STIFFNESS: square * t * t,
            BACKLASH: problem.backlash,
        },
        stiffness=tuple(piece.stiffness * t * t for piece in cut),
        share=tuple(piece.share for piece in cut),
        damping={1: contact, 0: loss, -1: contact},
    )
