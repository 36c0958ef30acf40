"""The reduced problem of one run, written once for every peer.

A run without run-out, profile deviation and Fourier stiffness needs two coordinates: the
deflection y of the mesh and the difference Y of the two bodies' displacements. In static
deflections and 1/Ω_s, with the normal force N = c (y - off) + k1 v + k2 |v| v + k3 v³,

    y'' = 1 - N + f_T tan(α) γ c (y - off) + Y'',
    Y'' = -(2 N + 2 ζ_b √(c_b m) Y' + c_b Y) / m.

What changes on the way is constant between events: c and γ change at known phases of the mesh
period (`pieces_of`), off and the damping coefficients where y crosses 0 or -s. The equations are
stated here afresh, not taken from `gearmesh`, so that a slip there would show.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import sqrt, tan

from gearmesh.model.problem import Problem

ROUNDING = 1e-12
"""A switch this close to the start of the period, in periods, stands at it."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of the mesh period with constant stiffness and friction.

    Attributes
    ----------
    start, end : float
        In mesh periods, from the start of the period.
    stiffness : float
        C/C_s.
    share : float
        1 - f_T tan(α) γ: what friction leaves of the elastic force in u''.
    """

    start: float
    end: float
    stiffness: float
    share: float


@dataclass(frozen=True, slots=True)
class Terms:
    """Which powers of the velocity act anywhere in the run."""

    linear: bool
    quadratic: bool
    cubic: bool


@lru_cache
def pieces(
    contact_ratio: float,
    stiffness_max: float,
    stiffness_min: float,
    friction: float,
    initial_phase: float,
) -> tuple[Piece, ...]:
    """Cut one mesh period, counted from the start of the run, at its switches."""
    half = (contact_ratio - 1) / 2
    switches = ((phase - initial_phase) % 1.0 for phase in (half, 0.5, 1 - half))
    cuts = [0.0, *sorted(p for p in switches if ROUNDING < p < 1 - ROUNDING), 1.0]
    made = []
    for start, end in pairwise(cuts):
        phase = ((start + end) / 2 + initial_phase) % 1.0
        single = half < phase < 1 - half
        gamma = (1 if phase < 0.5 else -1) if single else 0
        made.append(
            Piece(start, end, stiffness_min if single else stiffness_max, 1 - friction * gamma)
        )
    return tuple(made)


def pieces_of(problem: Problem) -> tuple[Piece, ...]:
    """Return the pieces of the mesh period of `problem`; refuse what the peers do not model."""
    if (
        problem.eccentricity_3
        or problem.eccentricity_2
        or problem.deviation
        or problem.stiffness_harmonics
    ):
        raise ValueError("the peers solve the reduced problem only: no run-out, no Fourier series")
    return pieces(
        problem.contact_ratio,
        problem.stiffness_max,
        problem.stiffness_min,
        problem.friction_coefficient * tan(problem.pressure_angle),
        problem.initial_phase,
    )


def periods(problem: Problem) -> tuple[int, int]:
    """Return how many mesh periods are run, and after how many of them the kept ones begin."""
    total = problem.revolutions * problem.teeth
    return total, total - problem.kept_revolutions * problem.teeth


def terms(problem: Problem) -> Terms:
    """Which damping terms `problem` switches on, in contact or out of it."""
    return Terms(*(bool(a or b) for a, b in zip(problem.material, problem.lubricant, strict=True)))


def support(problem: Problem) -> tuple[float, float, float]:
    """Return 2/m, 2 ζ_b √(c_b/m) and c_b/m of the equation of Y."""
    rate = sqrt(problem.bearing_stiffness / problem.body_mass)
    return 2 / problem.body_mass, 2 * problem.bearing_damping_ratio * rate, rate * rate


def initial_state(problem: Problem) -> tuple[float, float, float, float]:
    """y, y', Y, Y' at rest in static equilibrium under C_s."""
    return 1.0, 0.0, -2 / problem.bearing_stiffness, 0.0
