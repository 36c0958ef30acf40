"""Pitch errors and tip relief of a pair: checks, and conversion to dimensionless form."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from gearmesh.study.reading.schema import of_wheels

if TYPE_CHECKING:
    from gearmesh.study.parameters import Parameters


def base_pitch(pair: "Parameters") -> float:
    """Return p_b = π m_n cos(α) in mm."""
    return math.pi * pair.module * math.cos(pair.pressure_angle)


def check_flanks(pair: "Parameters") -> None:
    """Raise ValueError if pitch errors or tip relief do not suit the pair.

    The message begins with the name of the parameter.
    """
    teeth = of_wheels(pair.teeth)
    if len(pair.pitch_errors) not in (0, 2):
        raise ValueError(
            f"pitch_errors: found {len(pair.pitch_errors)} lists; allowed are two, for wheels 3 "
            "and 2"
        )
    for errors, count, wheel in zip(pair.pitch_errors, teeth, (3, 2), strict=False):
        if len(errors) not in (0, count):
            raise ValueError(
                f"pitch_errors: found {len(errors)} values for wheel {wheel}; allowed are none, or "
                f"one for each of its {count} teeth"
            )
    advance = sum(max(errors, default=0.0) for errors in centred(pair.pitch_errors))
    if advance >= pair.backlash:
        raise ValueError(
            f"pitch_errors: found teeth that stand out by {advance:g} mm; allowed is less than the "
            f"backlash, {pair.backlash:g} mm"
        )
    path = pair.contact_ratio * base_pitch(pair)
    for amount, length in zip(pair.tip_relief, pair.tip_relief_length, strict=True):
        if amount > 0.0 and not 0.0 < length <= path:
            raise ValueError(
                f"tip_relief_length: found {length:g} mm; allowed beside tip_relief is more than 0 "
                f"and at most the path of contact, {path:g} mm"
            )


def centred(lists: Sequence[Sequence[float]]) -> list[tuple[float, ...]]:
    """Return the pitch errors of each wheel minus their mean.

    The mean only turns the wheel. If all errors of a wheel are equal, its tuple is empty.
    """
    found = []
    for errors in lists:
        differ = bool(errors) and max(errors) > min(errors)
        mean = math.fsum(errors) / len(errors) if differ else 0.0
        found.append(tuple(error - mean for error in errors) if differ else ())
    return found


def flanks_of(pair: Any) -> dict[str, Any]:
    """Return the fields of `GeneralTerms` for the flanks, in y_st and base pitches."""
    y_st, pitch = pair.static_deflection, base_pitch(pair)
    errors = [
        tuple(error / y_st for error in one) for one in centred(pair.pitch_errors or ((), ()))
    ]
    relief = tuple(amount / y_st for amount in pair.tip_relief)
    lengths = (
        length / pitch if amount else 0.0
        for amount, length in zip(relief, pair.tip_relief_length, strict=True)
    )
    return {
        "pitch_errors_3": errors[0],
        "pitch_errors_2": errors[1],
        "tip_relief": relief,
        "tip_relief_length": tuple(lengths),
    }
