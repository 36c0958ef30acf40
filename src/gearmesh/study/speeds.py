"""Speeds in place of mesh frequencies: ``"3000 rpm"``, of wheel 3."""

from collections.abc import Mapping

from gearmesh.errors import InputError
from gearmesh.study.frequencies import read_nu
from gearmesh.study.pair import Pair
from gearmesh.study.reading import units


def is_speed(value: object) -> bool:
    """Return whether a value is a text with the unit rpm."""
    return isinstance(value, str) and value.rstrip().endswith("rpm")


def as_nu(value: object, pair: Pair) -> object:
    """Replace speeds by mesh frequencies ν_s = Z_3 (2π/60) n/Ω_s.

    Parameters
    ----------
    value : object
        A text such as ``"3000 rpm"``, or lists or mappings that hold some. Anything else is
        returned as it is, for validation to judge.
    pair : Pair
        The pair that turns with this speed.
    """
    if isinstance(value, Mapping):
        return {key: as_nu(item, pair) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [as_nu(item, pair) for item in value]
    if not is_speed(value):
        return value
    try:
        return units.parse(value, "rpm") / pair.resonance_speed
    except ValueError:
        return value


def check_constant_speed(pair: Pair, wanted: str) -> None:
    """Raise InputError if the speed of a pair changes, where `wanted` has one speed."""
    if pair.final_nu is not None:
        raise InputError(
            f"final_nu: found {pair.final_nu:g}; {wanted} has a constant speed, so it must be open"
        )


def read_nu_or_speed(value: object, pair: Pair) -> float:
    """Read a mesh frequency ν_s, or a speed; raises ValueError with what is allowed."""
    nu = as_nu(value, pair)
    try:
        return read_nu(nu)
    except ValueError as error:
        raise ValueError(f"ν_s = {nu:.6g} is {error}" if nu is not value else str(error)) from None
