"""Functions that the laws use on floats, on truncated Taylor series and on traced numbers alike.

A number that is not a float has methods `sin`, `cos`, `sqrt`, `power` and `entry` of its own.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

Number = Any
"""A float, a truncated Taylor series of time, or a number that a solver traces."""


class Harmonic(NamedTuple):
    """One harmonic: ``cosine cos(order nu t) + sine sin(order nu t)``.

    `order` counts multiples of the mesh frequency: 1 / Z is once a revolution of a wheel with Z
    teeth, and 0 a constant.
    """

    order: float
    cosine: float
    sine: float


def sine(angle: Number) -> Number:
    """Return the sine of `angle`."""
    return angle.sin() if hasattr(angle, "sin") else math.sin(angle)


def cosine(angle: Number) -> Number:
    """Return the cosine of `angle`."""
    return angle.cos() if hasattr(angle, "cos") else math.cos(angle)


def square_root(value: Number) -> Number:
    """Return the square root of `value`."""
    return value.sqrt() if hasattr(value, "sqrt") else math.sqrt(value)


def power(value: Number, exponent: float) -> Number:
    """Return a positive `value` to a constant power."""
    return value.power(exponent) if hasattr(value, "power") else value**exponent


def entry(table: Sequence[float], place: Number) -> Number:
    """Return the entry of `table`, which repeats, at the whole number `place`."""
    if hasattr(place, "entry"):
        return place.entry(tuple(table))
    return table[round(place) % len(table)]


def harmonic_sum(harmonics: Iterable[Harmonic], angle: Number) -> Number:
    """Return the sum of `harmonics` where the mesh has turned by `angle` = nu t."""
    total = 0.0
    for order, cosine_part, sine_part in harmonics:
        turned = order * angle
        total += cosine_part * cosine(turned) + sine_part * sine(turned)
    return total


def harmonic_rate(harmonics: Iterable[Harmonic], angle: Number, nu: float) -> Number:
    """Return the time derivative of `harmonic_sum`."""
    total = 0.0
    for order, cosine_part, sine_part in harmonics:
        turned = order * angle
        total += order * nu * (sine_part * cosine(turned) - cosine_part * sine(turned))
    return total
