"""The segments of a mesh period, in which neither C(t) nor gamma(t) jumps or has a kink."""

from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

from gearmesh.model.flanks import relief_places
from gearmesh.model.friction import Pair, pairs_in_contact, pitch_offset
from gearmesh.model.problem import Problem
from gearmesh.model.stiffness import PITCH_PHASE, path_places, switch_phases


class Segment(NamedTuple):
    """A segment of the mesh period, counted in mesh periods from the start of the run.

    Attributes
    ----------
    start, end, length : float
        Its ends within the period, 0 to 1, and its length.
    middle : float
        Mesh phase of its middle, counted from t = 0.
    pairs : tuple of Pair
        gamma and sigma of the pairs of teeth in contact, at its middle.
    double : bool
        Whether these are two pairs.
    gamma : float
        gamma(t) of eq. (6), summed over the pairs.
    """

    start: float
    end: float
    length: float
    middle: float
    pairs: tuple[Pair, ...]
    double: bool
    gamma: float


def pitch_offset_of(problem: Problem) -> float:
    """Return how far the pitch point lies behind the middle of the path, in base pitches."""
    if problem.wheels is None:
        return 0.0
    wheel_3, wheel_2 = problem.wheels
    return pitch_offset(wheel_3.teeth, wheel_2.teeth, problem.pressure_angle, problem.contact_ratio)


def edges(problem: Problem) -> tuple[float, ...]:
    """Return the mesh phases of the jumps and kinks of C(t) and of the jumps of gamma(t).

    The rectangular wave and friction jump at the switches of C(t), as do factors of single teeth;
    friction jumps at the pitch point too. If pairs of teeth touch singly, the pairs in contact
    change at each switch. Tables and tip relief have kinks.
    """
    rubs = problem.friction_coefficient != 0.0
    terms = problem.terms
    smooth = problem.stiffness_harmonics or terms.stiffness_fourier or terms.stiffness_table
    switches = rubs or not smooth or bool(terms.tooth_factors) or terms.pairs_touch_singly
    places = [*(switch_phases(problem.contact_ratio) if switches else ())]
    places += [PITCH_PHASE + pitch_offset_of(problem)] * rubs
    places += [phase for phase, _ in terms.stiffness_table]
    places += relief_places(problem)
    places += path_places(problem.contact_ratio, len(terms.tooth_pair_stiffness))
    return tuple(places)


def segments(problem: Problem) -> tuple[Segment, ...]:
    """Cut a mesh period of `problem` at the edges of C(t) and gamma(t)."""
    offset = pitch_offset_of(problem)
    return _cut(problem.contact_ratio, problem.initial_phase, offset, edges(problem))


@lru_cache
def _cut(
    contact_ratio: float, initial_phase: float, offset: float, places: tuple[float, ...]
) -> tuple[Segment, ...]:
    edges = [0.0, *sorted((place - initial_phase) % 1.0 for place in places), 1.0]
    found = []
    for start, end in pairwise(edges):
        if start < end:
            middle = (0.5 * (start + end) + initial_phase) % 1.0
            pairs = tuple(pairs_in_contact(middle, contact_ratio, offset))
            gamma = sum(pair.gamma for pair in pairs)
            double = len(pairs) == 2
            found.append(Segment(start, end, end - start, middle, pairs, double, gamma))
    return tuple(found)
