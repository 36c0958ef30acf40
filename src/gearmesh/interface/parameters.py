"""Parameters of a pair as single numbers, as sweeps vary them and branches follow them."""

import itertools
from typing import Any

import numpy as np

from gearmesh.errors import InputError
from gearmesh.interface.statements import bare, several
from gearmesh.study.alternatives import DECLARED, NAMES
from gearmesh.study.frequencies import NU_MAX, NU_MIN
from gearmesh.study.pair import Pair
from gearmesh.study.reading import units
from gearmesh.study.reading.schema import nearest, shown
from gearmesh.study.speeds import as_nu

Limits = tuple[object, object]
"""Ends of a range: numbers in the parameter's unit, or texts with units."""

_NU = {"unit": "1", "description": "mesh frequency nu_s", "low": NU_MIN, "high": NU_MAX}

_INSTEAD = {
    **{f"damping_{power}": "damping" for power in ("1", "2", "3", "1m", "2m", "3m")},
    "bearing_stiffness_z": "bearing_stiffness",
    "bearing_damping_ratio_z": "bearing_damping_ratio",
}
"""The parameter that holds where another one is left open."""

_NARROWEST = 1e-9  # range of a parameter, as a share of its larger end


def number_of(pair: Pair, name: str) -> Any:
    """Return a parameter: a single number if both wheels have the same one.

    If the parameter is left open, the one that holds in its place is returned.
    """
    value, declared = getattr(pair, name), DECLARED[name]
    if value is None and name in _INSTEAD:
        return number_of(pair, _INSTEAD[name])
    of_wheels = declared["of_wheels"] or declared["may_differ"]
    if of_wheels and isinstance(value, tuple) and value[0] == value[1]:
        return value[0]
    return value


def declared(pair: Pair, name: object) -> tuple[str, str]:
    """Return unit and meaning of ν_s, or of a parameter that is a single real number.

    Raises
    ------
    InputError
        If it is neither.
    """
    found = _declaration(name)
    if found is not _NU and not isinstance(number_of(pair, str(name)), float):
        value = getattr(pair, str(name))
        raise InputError(f"{name}: found {shown(value)}; allowed are single real numbers")
    return found["unit"], found["description"]


def _declaration(name: object) -> dict[str, Any]:
    if not isinstance(name, str):
        raise InputError(f"parameter: found {shown(name)}; allowed is one name, such as 'nu'")
    if name == "nu":
        return _NU
    if name not in DECLARED:
        hint = nearest(name, ["nu", *NAMES]) or "; 'gearmesh parameters' lists all"
        raise InputError(f"{name}: no such parameter{hint}")
    return DECLARED[name]


def with_number(pair: Pair, name: str, value: float) -> Pair:
    """Return a pair with another value of a parameter, in its unit."""
    unit, _ = declared(pair, name)
    return pair.replace(**{name: value if unit == "1" else f"{value!r} {unit}"})


def static_deflection(pair: Pair, names: tuple[str, ...], values: np.ndarray) -> float | np.ndarray:
    """Return y_st of a pair at several values of its parameters, in mm.

    Parameters
    ----------
    pair : Pair
    names : tuple of str
        Parameters, or ``"nu"``, on which y_st does not depend.
    values : ndarray, shape (n, len(names))

    Returns
    -------
    float or ndarray, shape (n,)
        One number if it is the same everywhere.
    """

    def at(row: np.ndarray) -> float:
        changed = pair
        for name, value in zip(names, row.tolist(), strict=True):
            if name != "nu":
                changed = with_number(changed, name, value)
        return changed.static_deflection

    # y_st rises or falls with each parameter, so the ends of their ranges tell.
    corners = itertools.product(*zip(values.min(axis=0), values.max(axis=0), strict=True))
    if all(at(np.array(corner)) == pair.static_deflection for corner in corners):
        return pair.static_deflection
    return np.array([at(row) for row in values])


def read_limits(pair: Pair, name: str, limits: object) -> tuple[float, float]:
    """Read the ends of a range."""
    ends = several(limits)
    if len(ends) != 2:
        raise InputError(f"limits of {name}: found {shown(limits)}; allowed is (low, high)")
    low, high = (_read_value(pair, name, bare(end), "limits of ") for end in ends)
    if not low < high:
        raise InputError(f"limits of {name}: found ({low:g}, {high:g}); allowed is low < high")
    if not high - low > _NARROWEST * max(abs(low), abs(high)):
        raise InputError(
            f"limits of {name}: found ({low!r}, {high!r}); allowed is a difference of more than "
            f"{_NARROWEST:g} of the larger one"
        )
    return low, high


def read_values(pair: Pair, name: str, values: object) -> np.ndarray:
    """Read values of a parameter; thousands of floats are checked at once."""
    given = several(values)
    if not given:
        raise InputError(f"{name}: no value given; allowed is one or several")
    if set(map(type, given)) == {float}:
        numbers, stated = np.array(given), _declaration(name)
        if np.all((stated["low"] <= numbers) & (numbers <= stated["high"])):
            return numbers
    return np.array([_read_value(pair, name, bare(value)) for value in given])


def _read_value(pair: Pair, name: str, given: object, what: str = "") -> float:
    stated = _declaration(name)
    unit, least, greatest = (stated[key] for key in ("unit", "low", "high"))
    written = "" if unit == "1" else f" {unit}"
    value: Any = as_nu(given, pair) if name == "nu" else given
    sizes = (pair.static_deflection, pair.reduced_mass, pair.stiffness_mean)
    for (scale, of_scale), size in zip(units.SCALES.items(), sizes, strict=True):
        value = units.scaled(value, scale, size, of_scale)
    try:
        # Rounding could move a limit past the orbit, so a number stays as it is.
        number = units.parse(value, unit if isinstance(value, str) else "1")
        number = number if isinstance(value, str) else float(value)
    except ValueError as error:
        raise InputError(f"{what}{name}: found {shown(given)}; {error}") from None
    if not least <= number <= greatest:
        raise InputError(
            f"{what}{name}: found {shown(given)}; allowed is {least:g} to {greatest:g}{written}"
        )
    return number
