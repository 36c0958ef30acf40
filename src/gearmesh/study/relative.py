"""Values that are stated as multiples of a scale: ``8 y_st``, ``1000 m_red``, ``0.5 C_s``."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from gearmesh.model import stiffness
from gearmesh.study.parameters import Parameters
from gearmesh.study.reading import units
from gearmesh.study.reading.schema import read_declared, shown

MM_PER_M = 1000.0

TABLES = ("stiffness_table", "tooth_pair_stiffness")


def resolved(data: dict[str, Any]) -> dict[str, Any]:
    """Replace values such as ``8 y_st`` by quantities."""
    found = dict(data)
    for scale, unit in units.SCALES.items():
        relative = [name for name, value in data.items() if units.is_multiple(value, scale)]
        size = _scale(scale, data, relative[0]) if relative else 0.0
        for name in relative:
            found[name] = units.scaled(found[name], scale, size, unit)
    return found


LEVELS = ("mesh_stiffness_max", "stiffness_ratio")
_LEAST_RATIO = 1e-3


def with_levels(data: dict[str, Any]) -> dict[str, Any]:
    """Add C_max and κ if they are missing and a table states the stiffness.

    C_max is the greatest value of C(t), and κ the least value divided by the greatest. The motion
    does not depend on them.
    """
    stated = [name for name in TABLES if data.get(name)]
    missing = [name for name in LEVELS if data.get(name) is None]
    if not stated or not missing:
        return data
    declared = Parameters.declarations()
    try:
        values: Any = read_declared(data[stated[0]], declared[stated[0]])
        least, greatest = min(values), max(values)
        if stated[0] == "tooth_pair_stiffness":
            contact_ratio: Any = read_declared(data["contact_ratio"], declared["contact_ratio"])
            least, greatest = stiffness.extremes_of_pairs(values, contact_ratio)
        levels = (f"{greatest!r} N/mm", max(least / greatest, _LEAST_RATIO))
    except (KeyError, TypeError, ValueError, ZeroDivisionError):
        return data  # the mistake is reported where the table is read
    return {**data, **{n: v for n, v in zip(LEVELS, levels, strict=True) if n in missing}}


def _scale(scale: str, data: Mapping[str, Any], user: str) -> float:
    """Return the size of a scale, for `user` and other parameters that are stated in it."""
    declared = Parameters.declarations()

    def read(parameter: str) -> Any:
        return read_parameter(parameter, data, declared, f"{user} is stated in {scale}")

    if scale == "y_st":
        return float(read("static_deflection"))
    if scale == "m_red":
        return float(read("reduced_mass"))
    return stated_mean_stiffness(read)


def mean_stiffness(
    contact_ratio: float,
    highest: float,
    ratio: float,
    table: Sequence[float],
    tooth_pair: Sequence[float],
) -> float:
    """Return C_s in N/mm: of a table of the mesh or of a pair of teeth, else by eq. (5)."""
    if tooth_pair:
        inner = sum(tooth_pair) - 0.5 * (tooth_pair[0] + tooth_pair[-1])
        return contact_ratio * inner / (len(tooth_pair) - 1)
    if table:
        return sum(table) / len(table)
    return stiffness.mean(contact_ratio, highest, ratio * highest)


def stated_mean_stiffness(read: Callable[[str], Any]) -> float:
    """Return C_s in N/mm; `read` returns a parameter by its name, in its unit."""
    names = ("contact_ratio", "mesh_stiffness_max", "stiffness_ratio")
    return mean_stiffness(*(read(name) for name in (*names, *TABLES)))


def read_parameter(
    name: str, data: Mapping[str, Any], declared: Mapping[str, Mapping[str, Any]], reason: str
) -> Any:
    """Return a parameter, in its unit, that others follow from.

    A mistake in it is reported here, once, and not for each of them.

    Parameters
    ----------
    name : str
        The parameter.
    data : mapping of str to object
        What is stated.
    declared : mapping of str to mapping
        Unit and range of each parameter.
    reason : str
        Why it is needed, for the message.

    Raises
    ------
    ValueError
        If it is missing or wrong; the message begins with its name.
    """
    if name in TABLES and not data.get(name):
        return ()
    if data.get(name) is None:
        raise ValueError(f"{name}: missing; {reason}")
    try:
        value = read_declared(data[name], declared[name])
    except ValueError as error:
        raise ValueError(f"{name}: found {shown(data[name])}; {error}") from None
    if (
        isinstance(value, tuple)
        and name not in TABLES
        and not (declared[name]["of_wheels"] or declared[name]["may_differ"])
    ):
        raise ValueError(f"{name}: found {shown(data[name])}; allowed is a single value")
    return value
