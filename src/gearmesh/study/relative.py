"""Values that are stated as multiples of a scale: ``8 y_st``, ``1000 m_red``, ``0.5 C_s``."""

from collections.abc import Mapping
from typing import Any

from gearmesh.model import stiffness
from gearmesh.study import units
from gearmesh.study.parameters import Parameters
from gearmesh.study.schema import read_quantity, shown


def resolved(data: dict[str, Any]) -> dict[str, Any]:
    """Replace values such as ``8 y_st`` by quantities."""
    found = dict(data)
    for scale, unit in units.SCALES.items():
        relative = [name for name, value in data.items() if units.is_multiple(value, scale)]
        size = _scale(scale, data, relative[0]) if relative else 0.0
        for name in relative:
            found[name] = units.scaled(found[name], scale, size, unit)
    return found


def _scale(scale: str, data: Mapping[str, Any], user: str) -> float:
    """Return the size of a scale, for `user` and other parameters that are stated in it.

    A mistake in the scale itself is reported here, once, and not for each of them.
    """
    declared = Parameters.declarations()

    def read(parameter: str) -> float:
        if data.get(parameter) is None:
            raise ValueError(f"{parameter}: missing; {user} is stated in {scale}")
        try:
            return float(read_quantity(data[parameter], declared[parameter]))  # type: ignore[arg-type]
        except (ValueError, TypeError) as error:
            raise ValueError(f"{parameter}: found {shown(data[parameter])}; {error}") from None

    if scale == "y_st":
        return read("static_deflection")
    if scale == "m_red":
        return read("reduced_mass")
    highest = read("mesh_stiffness_max")
    return stiffness.mean(read("contact_ratio"), highest, read("stiffness_ratio") * highest)
