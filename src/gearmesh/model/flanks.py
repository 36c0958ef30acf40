"""Flanks that deviate from the ideal one: pitch errors of single teeth, and tip relief.

A deviation belongs to a tooth, not to the mesh, so each pair of teeth touches and parts by itself.
Pair p presses while y exceeds its distance a_p(t). Its force is c_p (y - a_p), where c_p is its
stiffness. y is the relative motion of eq. (3), so damping and friction are those of the paper.
Velex and Maatar (J. Sound Vib. 191, 1996, 629) put deviations into a mesh of springs in this way;
here spur teeth have one spring for each pair. The back flanks have no deviations.

Pitch errors are the distances of the flanks from their ideal places: the index deviations F_p of
ISO 1328-1, positive where a tooth stands out towards its mate.

Tip relief grows linearly along the path of contact, from 0 where it starts to C_a at the tip, as in
Lin, Oswald and Townsend (Mech. Mach. Theory 29, 1994, 1115). A pair of teeth comes into contact at
the tip of wheel 2 and leaves contact at the tip of wheel 3.
"""

from gearmesh.model.functions import Number, entry
from gearmesh.model.problem import Problem
from gearmesh.model.stiffness import PITCH_PHASE, touching_pairs


def distances(problem: Problem, phase: Number, segment: float) -> list[Number]:
    """Return the y at which each pair of teeth in contact begins to touch, in y_st.

    Parameters
    ----------
    problem : Problem
    phase : float
        Mesh phase.
    segment : float
        Any phase between the same two jumps of C(t), up to whole periods. It determines the pairs.
    """
    terms = problem.terms
    passed = phase - segment
    periods = round(passed)
    found = []
    for number, place in touching_pairs(segment, problem.contact_ratio):
        distance = 0.0
        for errors in (terms.pitch_errors_3, terms.pitch_errors_2):
            if errors:
                distance -= entry(errors, periods + number)
        # Distance along the path from the tip of wheel 3, then of wheel 2.
        for i, from_tip in enumerate((-place, place)):
            length = terms.tip_relief_length[i]
            inside = 0.5 * problem.contact_ratio + from_tip
            if terms.tip_relief[i] and inside < length:
                moved = (passed - periods) * (2 * i - 1)
                distance += terms.tip_relief[i] * (1.0 - (inside + moved) / length)
        found.append(distance)
    return found


def relief_places(problem: Problem) -> list[float]:
    """Return the mesh phases at which tip relief ends or begins."""
    half = 0.5 * problem.contact_ratio
    length_3, length_2 = problem.terms.tip_relief_length
    relief_3, relief_2 = problem.terms.tip_relief
    places = [PITCH_PHASE + half - length_3] if relief_3 else []
    return places + ([PITCH_PHASE - half + length_2] if relief_2 else [])
