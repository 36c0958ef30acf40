"""From a drawing to the parameters of a mesh: contact ratio and stiffness of involute wheels."""

from dataclasses import dataclass, field
from typing import Any

from gearmesh.errors import InputError
from gearmesh.model.involute import Involute
from gearmesh.study.reading import units
from gearmesh.study.reading.schema import shown

UM_PER_MM = 1000.0

_ANGLE = "inv α_w = inv α + 2 (x_3 + x_2) tan(α)/(Z_3 + Z_2), or from a"
_SINGLE = "one pair of teeth, ISO 6336-1 (2006), clause 9, Method B"
_MEAN = "mean of a mesh period, ISO 6336-1 (2006), clause 9: c' (0.75 ε + 0.25)"


@dataclass(frozen=True)
class Geometry:
    """Two involute spur wheels, as `geometry` returns them.

    Attributes
    ----------
    face_width : float
        b in mm.
    wheels : gearmesh.model.involute.Involute
        Diameters, working pressure angle, contact ratio, and stiffnesses per face width.
    """

    face_width: float
    wheels: Involute = field(repr=False)

    @property
    def contact_ratio(self) -> float:
        """ε, the path of contact over the base pitch."""
        return self.wheels.contact_ratio

    @property
    def stiffness_min(self) -> float:
        """C_min = c' b in N/mm: one pair of teeth carries."""
        return self.wheels.single_stiffness * UM_PER_MM * self.face_width

    @property
    def stiffness_mean(self) -> float:
        """C_s = c_γα b in N/mm, the mean over a mesh period."""
        return self.wheels.mesh_stiffness * UM_PER_MM * self.face_width

    @property
    def mesh_stiffness_max(self) -> float:
        """C_max in N/mm, so that eq. (5) gives C_s: C_min + (C_s − C_min)/(ε − 1) = 1.75 c' b."""
        rise = self.stiffness_mean - self.stiffness_min
        return self.stiffness_min + rise / (self.contact_ratio - 1.0)

    @property
    def stiffness_ratio(self) -> float:
        """κ = C_min/C_max, 4/7 for all wheels."""
        return self.stiffness_min / self.mesh_stiffness_max

    @property
    def parameters(self) -> dict[str, Any]:
        """Parameters of a pair, as ``pair.replace(**geometry.parameters)`` takes them.

        Module and pressure angle are those of the working pitch circles, which have the same base
        circles.
        """
        wheels = self.wheels
        teeth = wheels.teeth[0] if wheels.teeth[0] == wheels.teeth[1] else list(wheels.teeth)
        return {
            "contact_ratio": self.contact_ratio,
            "stiffness_ratio": self.stiffness_ratio,
            "mesh_stiffness_max": f"{self.mesh_stiffness_max!r} N/mm",
            "teeth": teeth,
            "module": f"{wheels.working_module!r} mm",
            "pressure_angle": f"{wheels.working_pressure_angle!r} rad",
        }

    def rows(self) -> list[tuple[str, str, str, str]]:
        """Return what was computed, in rows of text: quantity, values, unit, and formula."""
        wheels = self.wheels
        listed: tuple[tuple[str, tuple[float, ...], str, str], ...] = (
            ("base diameters d_b", wheels.base_diameters, "mm", "m Z cos(α), wheels 3 and 2"),
            ("tip diameters d_a", wheels.outside_diameters, "mm", "wheels 3 and 2"),
            ("centre distance a", (wheels.working_centre_distance,), "mm", "Σd_b/(2 cos(α_w))"),
            ("working angle α_w", (wheels.working_pressure_angle,), "rad", _ANGLE),
            ("contact ratio ε", (self.contact_ratio,), "1", "path of contact over base pitch"),
            ("stiffness c'", (wheels.single_stiffness,), "N/(mm um)", _SINGLE),
            ("stiffness c_γα", (wheels.mesh_stiffness,), "N/(mm um)", _MEAN),
            ("C_min", (self.stiffness_min,), "N/mm", "c' b"),
            ("C_s", (self.stiffness_mean,), "N/mm", "c_γα b"),
            ("C_max", (self.mesh_stiffness_max,), "N/mm", "C_min + (C_s − C_min)/(ε − 1), eq. (5)"),
            ("stiffness ratio κ", (self.stiffness_ratio,), "1", "C_min/C_max"),
        )
        return [
            (name, ", ".join(f"{value:.7g}" for value in values), unit, formula)
            for name, values, unit, formula in listed
        ]


def geometry(
    *,
    module: object,
    teeth: object,
    face_width: object,
    pressure_angle: object = "20 deg",
    profile_shift: object = 0.0,
    addendum: float = 1.0,
    dedendum: float = 1.25,
    centre_distance: object = None,
    tip_diameters: object = None,
) -> Geometry:
    """Compute contact ratio and mesh stiffness of steel wheels from their drawing.

    The contact ratio is that of standard involute geometry with profile shift. The stiffness
    follows ISO 6336-1 (2006), clause 9, Method B, for solid steel wheels and line loads of 100
    N/mm and more: one pair of teeth has c' b, and the mean over the mesh period is c_γα b.

    Parameters
    ----------
    module : str
        m_n with its unit, as ``"3 mm"``.
    teeth : int or pair of int
        Numbers of teeth: one for both wheels, or those of wheels 3 and 2.
    face_width : str
        Common face width b, with its unit.
    pressure_angle : str
        Of the basic rack.
    profile_shift : float or pair of float
        x in modules: one for both wheels, or those of wheels 3 and 2.
    addendum, dedendum : float
        h_aP and h_fP of the basic rack, in modules.
    centre_distance : str, optional
        By default the one without backlash.
    tip_diameters : str or pair of str, optional
        By default with the tip clearance of the basic rack.

    Returns
    -------
    Geometry
        ``pair.replace(**geometry.parameters)`` takes the numbers over.

    Raises
    ------
    InputError
        One line, if an argument is wrong, or the wheels do not mesh with a contact ratio from 1
        to 2.

    Examples
    --------
    >>> import gearmesh as gm
    >>> wheels = gm.geometry(module="3 mm", teeth=21, face_width="20 mm")
    >>> round(wheels.contact_ratio, 4)
    1.5691
    """
    z_3, z_2 = _both("teeth", teeth, "1", 3, 1000)
    if z_3 % 1 or z_2 % 1:
        raise InputError(f"teeth: found {shown(teeth)}; allowed are whole numbers")
    shift = _both("profile_shift", profile_shift, "1", -1.0, 2.0)
    tips = None
    if tip_diameters is not None:
        tips = _both("tip_diameters", tip_diameters, "mm", 1e-3, 1e6)
    distance = None
    if centre_distance is not None:
        distance = _read("centre_distance", centre_distance, "mm", 1e-3, 1e6)
    wheels = Involute(
        module=_read("module", module, "mm", 1e-2, 1000.0),
        teeth=(int(z_3), int(z_2)),
        pressure_angle=_read("pressure_angle", pressure_angle, "rad", 1e-3, 0.8),
        profile_shift=shift,
        addendum=_read("addendum", addendum, "1", 0.1, 2.0),
        dedendum=_read("dedendum", dedendum, "1", 0.1, 2.0),
        centre_distance=distance,
        tip_diameters=tips,
    )
    found = Geometry(_read("face_width", face_width, "mm", 1e-3, 1e5), wheels)
    _check(found)
    return found


def _check(found: Geometry) -> None:
    wheels = found.wheels
    shortest = sum(wheels.base_diameters) / 2.0
    if wheels.centre_distance is not None and wheels.centre_distance <= shortest:
        raise InputError(
            f"centre_distance: found {wheels.centre_distance:g} mm; allowed is more than half the "
            f"sum of the base diameters, {shortest:g} mm"
        )
    for tip, base in zip(wheels.outside_diameters, wheels.base_diameters, strict=True):
        if tip <= base:
            raise InputError(
                f"tip_diameters: found {tip:g} mm; allowed is more than the base diameter, "
                f"{base:g} mm"
            )
    if not 1.0 < found.contact_ratio <= 2.0:
        raise InputError(
            f"geometry: the contact ratio is {found.contact_ratio:.4g}; allowed is more than 1 and "
            "at most 2"
        )


def _read(name: str, value: object, unit: str, low: float, high: float) -> float:
    try:
        number = units.parse(value, unit)
    except ValueError as error:
        raise InputError(f"{name}: found {shown(value)}; {error}") from None
    if not low <= number <= high:
        written = "" if unit == "1" else f" {unit}"
        raise InputError(f"{name}: found {shown(value)}; allowed is {low:g} to {high:g}{written}")
    return number


def _both(name: str, value: object, unit: str, low: float, high: float) -> tuple[float, float]:
    """Read one value for both wheels, or two."""
    if not isinstance(value, list | tuple):
        return (_read(name, value, unit, low, high),) * 2
    if len(value) != 2:
        raise InputError(f"{name}: found {len(value)} values; allowed is one, or two for 3 and 2")
    first, second = (_read(name, item, unit, low, high) for item in value)
    return first, second
