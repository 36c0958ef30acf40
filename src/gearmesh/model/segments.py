"""The segments of a mesh period, in which neither C(t) nor gamma(t) jumps."""

from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

from gearmesh.model.friction import Pair, pairs_in_contact
from gearmesh.model.problem import Problem
from gearmesh.model.stiffness import PITCH_PHASE, switch_phases


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


def segments(problem: Problem) -> tuple[Segment, ...]:
    """Cut a mesh period of `problem` at the jumps of C(t) and gamma(t).

    The rectangular wave and friction jump at the switches of C(t), friction at the pitch point too.
    """
    rubs = problem.friction_coefficient != 0.0
    switches = rubs or problem.stiffness_harmonics == 0
    return _cut(problem.contact_ratio, problem.initial_phase, switches, rubs)


@lru_cache
def _cut(
    contact_ratio: float, initial_phase: float, switches: bool, pitch_point: bool
) -> tuple[Segment, ...]:
    places = [*(switch_phases(contact_ratio) if switches else ()), *([PITCH_PHASE] * pitch_point)]
    edges = [0.0, *sorted((place - initial_phase) % 1.0 for place in places), 1.0]
    found = []
    for start, end in pairwise(edges):
        if start < end:
            middle = (0.5 * (start + end) + initial_phase) % 1.0
            pairs = tuple(pairs_in_contact(middle, contact_ratio))
            gamma = sum(pair.gamma for pair in pairs)
            double = len(pairs) == 2
            found.append(Segment(start, end, end - start, middle, pairs, double, gamma))
    return tuple(found)
