"""Which coordinates a run needs, and how its mesh periods differ from each other.

Without run-out only the sum of the rotations, R_b3 phi_3 + R_b2 phi_2, matters. Motion across the
mesh line does not affect y, unless the backlash follows the wheels' centres. The sum and the
displacements along the mesh line then determine y: y_3 - y_2 alone if equal bodies are on equal
bearings, otherwise y_3 and y_2.
"""

import numpy as np

from gearmesh.model.friction import follows_run_out
from gearmesh.model.motion import ROTATION_2, ROTATION_3, Y_2, Y_3, Z_2, Z_3
from gearmesh.model.problem import Problem
from gearmesh.model.segments import segments
from gearmesh.model.stiffness import touching_pairs


def signs_act(problem: Problem) -> bool:
    """Return whether both signs of eq. (6) act."""
    return problem.friction_coefficient != 0.0 and follows_run_out(
        problem.eccentricity_3, problem.eccentricity_2
    )


def embedding(problem: Problem, sampled: bool = False) -> np.ndarray:
    """Return the six coordinates as sums of those that are integrated, shape (6, n).

    The columns are orthogonal. The coordinates that y depends on come first. A run that is
    `sampled` also needs the displacements across the mesh line, for the forces on the bearings.
    """
    if problem.has_run_out:
        return np.eye(6)
    columns = []
    if any(problem.terms.torsional_damping):
        columns += [{ROTATION_3: 1.0}, {ROTATION_2: 1.0}]
    else:
        columns += [{ROTATION_3: 0.5, ROTATION_2: 0.5}]
    wheel_3, wheel_2 = problem.both_wheels
    bodies = [
        (wheel.body_mass, wheel.bearing_stiffness[0], wheel.bearing_damping_ratio[0])
        for wheel in (wheel_3, wheel_2)
    ]
    if problem.terms.backlash_follows_centres:
        columns += [{Y_3: 1.0}, {Y_2: 1.0}, {Z_3: 1.0}, {Z_2: 1.0}]
        sampled = False
    elif bodies[0] == bodies[1]:
        columns += [{Y_3: 0.5, Y_2: -0.5}]
    else:
        columns += [{Y_3: 1.0}, {Y_2: 1.0}]
    if sampled:
        columns += [{Z_3: 1.0}, {Z_2: 1.0}]
    found = np.zeros((6, len(columns)))
    for i, column in enumerate(columns):
        for j, share in column.items():
            found[j, i] = share
    return found


def projected(sixes: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Return the coordinates that are integrated and, from the seventh place, their rates.

    Parameters
    ----------
    sixes : ndarray, shape (..., 12)
        Six coordinates, then their rates.
    columns : ndarray, shape (6, n)
        Of `embedding`.
    """
    n = columns.shape[1]
    inverse = columns / np.sum(columns**2, axis=0)
    found = np.zeros(sixes.shape)
    found[..., :n], found[..., 6 : 6 + n] = sixes[..., :6] @ inverse, sixes[..., 6:] @ inverse
    return found


def kinds_of_period(problem: Problem) -> tuple[list[float], np.ndarray]:
    """Return the segments of all kinds of mesh periods, and the kind of each period.

    Returns
    -------
    list of float
        A mesh phase in each segment of each kind; whole periods count.
    ndarray of int, shape (periods + 1,)
        The place of each period's kind. Periods differ where the factors of single teeth do.
    """
    middles = [problem.initial_phase + 0.5 * (part.start + part.end) for part in segments(problem)]
    if not problem.terms.tooth_factors:
        return middles, np.zeros(problem.periods + 1, np.int64)
    kinds: dict[tuple[tuple[int, ...], ...], int] = {}
    phases: list[float] = []
    variants = []
    for period in range(problem.periods + 1):
        places = [problem.start_period + period + middle for middle in middles]
        teeth = tuple(_marked_teeth(problem, place) for place in places)
        if teeth not in kinds:
            kinds[teeth] = len(kinds)
            phases += places
        variants.append(kinds[teeth])
    return phases, np.array(variants, np.int64)


def _marked_teeth(problem: Problem, phase: float) -> tuple[int, ...]:
    """Return which tooth factors act on each pair in contact."""
    acting = []
    for pair in touching_pairs(phase, problem.contact_ratio):
        for i, (wheel, tooth, _) in enumerate(problem.terms.tooth_factors):
            teeth = problem.both_wheels[0 if wheel == 3 else 1].teeth
            acting.append(i if pair.number % teeth == tooth else -1)
    return tuple(acting)
