"""Mesh stiffness: the rectangular wave, its Fourier series (4) and its mean (5).

The functions take the mesh phase, the time in mesh periods T = 2 pi / omega_c with phase 0 where
t = 0 in eq. (4). Two pairs of teeth carry the load (C_max) while the phase is within (epsilon - 1)
/ 2 of a whole number, and one pair (C_min) in between. Stiffnesses are returned in the unit of
C_max and C_min.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

TURN = 2.0 * np.pi

PITCH_PHASE = 0.5
"""Mesh phase at which a single pair of equal wheels touches at the pitch point."""


def duty(contact_ratio: float) -> float:
    """Return the share of the mesh period with two pairs of teeth in contact, epsilon - 1."""
    return contact_ratio - 1.0


def switch_phases(contact_ratio: float) -> tuple[float, float]:
    """Return the phases in <0; 1> where C falls to C_min and where it rises to C_max again."""
    half = 0.5 * duty(contact_ratio)
    return half, 1.0 - half


class Touching(NamedTuple):
    """A pair of teeth in contact: its number, and how far it is behind the middle of its path.

    The middle of the path of pair p is at the phase p + 1/2; `place` counts base pitches, which
    are mesh periods.
    """

    number: int
    place: float


def touching_pairs(phase: float, contact_ratio: float) -> list[Touching]:
    """Return the pairs of teeth in contact at `phase`, the one that entered last first.

    The path of a pair is `contact_ratio` base pitches long, 1 to 3.
    """
    since, half = phase - round(phase), 0.5 * duty(contact_ratio)
    found = []
    for shift in (-1.5, -0.5, 0.5, 1.5):
        inside = -since < half + (shift + 0.5) if shift < 0.0 else since < half - (shift - 0.5)
        if inside:
            found.append(Touching(round(phase) - round(shift + 0.5), since + shift))
    if not found:  # one pair follows the other at once
        found.append(Touching(round(phase), since - 0.5))
    return found


def path_places(contact_ratio: float, points: int) -> list[float]:
    """Return the mesh phases of `points` at equal distances along the path of pair 0."""
    start = PITCH_PHASE - 0.5 * contact_ratio
    return [start + contact_ratio * i / (points - 1) for i in range(points)]


def extremes_of_pairs(pair: Sequence[float], contact_ratio: float) -> tuple[float, float]:
    """Return the least and the greatest stiffness of a mesh, from the stiffness of each pair.

    `pair` holds the stiffness of a pair at equal distances along its path of contact. It is linear
    in between.
    """
    ends = path_places(contact_ratio, len(pair))
    knots = [(end - PITCH_PHASE, value) for end, value in zip(ends, pair, strict=True)]
    sums = []
    for low, high in pairwise([0.0, *sorted(end % 1.0 for end in ends), 1.0]):
        if low < high:
            middle = 0.5 * (low + high)
            touching = touching_pairs(middle, contact_ratio)
            lines = [line_through(knots, one.place) for one in touching]
            value, slope = (sum(column) for column in zip(*lines, strict=True))
            sums += [value - slope * (middle - low), value + slope * (high - middle)]
    return min(sums), max(sums)


def in_double_contact(phase: float | np.ndarray, contact_ratio: float) -> np.ndarray:
    """Return whether two pairs of teeth carry at `phase`, a float or an array."""
    return np.abs(phase - np.round(phase)) < 0.5 * duty(contact_ratio)


def mean(contact_ratio: float, maximum: float, minimum: float) -> float:
    """Return the mean stiffness C_s of eq. (5)."""
    return minimum + 0.5 * (maximum - minimum) * (1.0 + (2.0 * contact_ratio - 3.0))


def rectangular(
    phase: float | np.ndarray, contact_ratio: float, maximum: float, minimum: float
) -> np.ndarray:
    """Return the stiffness at `phase`, a float or an array: the sum of eq. (4) in closed form.

    Its n-th coefficient, 2 (C_max - C_min) sin(n pi (epsilon - 1)) / (n pi), is that of a
    rectangular wave of duty epsilon - 1 centred on phase 0.
    """
    return np.where(in_double_contact(phase, contact_ratio), maximum, minimum)


def line_through(knots: Sequence[tuple[float, float]], place: float) -> tuple[float, float]:
    """Return the value at `place` and the slope of what is linear between `knots`.

    Parameters
    ----------
    knots : sequence of (place, value)
        In the order of the places; `place` lies between the first and the last.
    """
    for (low, before), (high, after) in pairwise(knots):
        if low <= place <= high and low < high:
            slope = (after - before) / (high - low)
            return before + slope * (place - low), slope
    raise ValueError(f"{place} is outside the table")


def fourier_amplitudes(
    contact_ratio: float, maximum: float, minimum: float, terms: int
) -> np.ndarray:
    """Return the amplitudes of cos(n omega_c t) in eq. (4), shape (terms,), n = 1 first."""
    n = np.arange(1, terms + 1)
    sine = np.sin(n * ((contact_ratio - 2.0) * np.pi))
    return 0.5 * (maximum - minimum) * 4.0 / (np.pi * n) * (-1.0) ** n * sine


def fourier(
    phase: float | np.ndarray, contact_ratio: float, maximum: float, minimum: float, terms: int
) -> np.ndarray:
    """Return the stiffness at `phase`, a float or an array, by eq. (4) cut after `terms` terms."""
    n = np.arange(1, terms + 1)
    waves = np.cos(2.0 * np.pi * n * np.asarray(phase)[..., None])
    amplitudes = fourier_amplitudes(contact_ratio, maximum, minimum, terms)
    return mean(contact_ratio, maximum, minimum) + waves @ amplitudes
