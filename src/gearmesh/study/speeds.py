"""Speeds in place of mesh frequencies: ``"3000 rpm"``, of wheel 3."""

from collections.abc import Mapping
from typing import Any

from gearmesh.errors import InputError
from gearmesh.study.frequencies import grid, read_nu
from gearmesh.study.pair import Pair
from gearmesh.study.reading import units
from gearmesh.study.reading.schema import shown

_GRID = ("start", "stop", "step")
_LEAST_STEP = 1e-6  # rpm


def is_speed(value: object) -> bool:
    """Return whether a value is a text with the unit rpm."""
    return isinstance(value, str) and value.rstrip().endswith("rpm")


def as_nu(value: object, pair: Pair, where: str = "") -> object:
    """Replace speeds by mesh frequencies ν_s = Z_3 (2π/60) n/Ω_s.

    Parameters
    ----------
    value : object
        A text such as ``"3000 rpm"``, or lists or mappings that hold some. Anything else is
        returned as it is, for validation to judge.
    pair : Pair
        The pair that turns with this speed.
    where : str
        The key that states the value, for messages.

    Raises
    ------
    InputError
        If a grid of speeds is wrong.
    """
    if isinstance(value, Mapping):
        if any(is_speed(value.get(name)) for name in _GRID):
            value = _listed(value, pair, where)
        return {key: as_nu(item, pair, f"{where}.{key}") for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [as_nu(item, pair, where) for item in value]
    if not is_speed(value):
        return value
    try:
        return units.parse(value, "rpm") / pair.resonance_speed
    except ValueError:
        return value


def _listed(stated: Mapping[str, Any], pair: Pair, where: str) -> dict[str, Any]:
    """Replace a grid of speeds by its values, which are equally spaced in rpm.

    If its ends and its step were converted, rounding could remove the last value.
    """
    if any(stated.get(name) is None for name in _GRID):
        return dict(stated)  # validation reports what is missing
    if not all(is_speed(stated[name]) for name in _GRID):
        found = ", ".join(f"{name} {shown(stated[name])}" for name in _GRID)
        raise InputError(f"{where}: found {found}; allowed are three speeds, or three numbers ν_s")
    ends = []
    for name in _GRID:
        try:
            ends.append(units.parse(stated[name], "rpm"))
            if name != "step":
                read_nu_or_speed(stated[name], pair)
        except ValueError as error:
            raise InputError(f"{where}.{name}: found {shown(stated[name])}; {error}") from None
    start, stop, step = ends
    for name, number, least in (("step", step, _LEAST_STEP), ("stop", stop, start)):
        if number < least:
            found = shown(stated[name])
            raise InputError(f"{where}.{name}: found {found}; allowed is {least:g} rpm or more")
    try:
        speeds = grid(start, stop, step)
    except ValueError as error:
        raise InputError(f"{where}.{error}") from None
    further = stated.get("values")
    others = {key: item for key, item in stated.items() if key not in _GRID}
    values = [f"{speed!r} rpm" for speed in speeds]
    if further is None:
        return others | {"values": values}
    if not isinstance(further, list | tuple):
        return others  # validation reports them
    return others | {"values": [*further, *values]}


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
