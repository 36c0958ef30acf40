"""Involute geometry of two external spur wheels, and the stiffness of their teeth.

Lengths are in mm, angles in rad, stiffnesses per face width in N/(mm um).
"""

import math
from dataclasses import dataclass
from functools import cached_property

SINGLE_FLEXIBILITY = (
    *(0.04723, 0.15551, 0.25791, -0.00635, -0.11654),
    *(-0.00193, -0.24188, 0.00529, 0.00182),
)
"""C_1 to C_9 of ISO 6336-1 (2006), clause 9, Method B: the flexibility q' of one pair of teeth."""

CORRECTION = 0.8
"""C_M of ISO 6336-1 (2006), clause 9: measured stiffness of solid disc gears over theoretical."""


def involute(angle: float) -> float:
    """Return inv(angle) = tan(angle) - angle."""
    return math.tan(angle) - angle


def inverse_involute(value: float) -> float:
    """Return the angle whose involute is `value`, by Newton's method."""
    # Both bounds are above the angle x, for inv(x) > x^3/3 and tan(x) < value + pi/2. The involute
    # is convex, so Newton's method descends to the angle from there.
    angle = min((3.0 * value) ** (1.0 / 3.0), math.atan(value + 0.5 * math.pi))
    for _ in range(50):
        step = (involute(angle) - value) / math.tan(angle) ** 2
        angle -= step
        if abs(step) < 1e-15:
            break
    return angle


@dataclass(frozen=True)
class Involute:
    """Two external spur wheels of standard basic rack with profile shift.

    Attributes
    ----------
    module : float
        m_n of the basic rack.
    teeth : tuple of two int
        Z_3 and Z_2.
    pressure_angle : float
        alpha of the basic rack.
    profile_shift : tuple of two float
        x_3 and x_2, in modules.
    addendum, dedendum : float
        h_aP and h_fP of the basic rack, in modules.
    centre_distance : float, optional
        a; by default without backlash, from the sum of the profile shifts.
    tip_diameters : tuple of two float, optional
        d_a3 and d_a2; by default with the tip clearance of the basic rack.
    """

    module: float
    teeth: tuple[int, int]
    pressure_angle: float
    profile_shift: tuple[float, float] = (0.0, 0.0)
    addendum: float = 1.0
    dedendum: float = 1.25
    centre_distance: float | None = None
    tip_diameters: tuple[float, float] | None = None

    @cached_property
    def base_diameters(self) -> tuple[float, float]:
        """d_b = m Z cos(alpha)."""
        pitch = self.module * math.cos(self.pressure_angle)
        return pitch * self.teeth[0], pitch * self.teeth[1]

    @cached_property
    def working_pressure_angle(self) -> float:
        """alpha_w: inv alpha_w = inv alpha + 2 (x_3 + x_2)/(Z_3 + Z_2) tan(alpha), or from a."""
        if self.centre_distance is not None:
            return math.acos(sum(self.base_diameters) / 2.0 / self.centre_distance)
        if sum(self.profile_shift) == 0.0:
            return self.pressure_angle
        opening = 2.0 * sum(self.profile_shift) / sum(self.teeth) * math.tan(self.pressure_angle)
        return inverse_involute(involute(self.pressure_angle) + opening)

    @cached_property
    def working_centre_distance(self) -> float:
        """A = (d_b3 + d_b2)/(2 cos(alpha_w))."""
        return sum(self.base_diameters) / 2.0 / math.cos(self.working_pressure_angle)

    @cached_property
    def working_module(self) -> float:
        """2 a/(Z_3 + Z_2): with alpha_w it gives the same base circles as m_n with alpha."""
        return 2.0 * self.working_centre_distance / sum(self.teeth)

    @cached_property
    def outside_diameters(self) -> tuple[float, float]:
        """d_a: given, or m (Z_3 + 2 (h_aP + y - x_2)) and vice versa.

        y = a/m - (Z_3 + Z_2)/2 is the change of the centre distance.
        """
        if self.tip_diameters is not None:
            return self.tip_diameters
        change = self.working_centre_distance / self.module - sum(self.teeth) / 2.0
        (z_3, z_2), (x_3, x_2) = self.teeth, self.profile_shift
        return (
            self.module * (z_3 + 2.0 * (self.addendum + change - x_2)),
            self.module * (z_2 + 2.0 * (self.addendum + change - x_3)),
        )

    @cached_property
    def contact_ratio(self) -> float:
        """Path of contact over the base pitch pi m cos(alpha)."""
        reach = sum(
            math.sqrt(tip**2 - base**2) / 2.0
            for tip, base in zip(self.outside_diameters, self.base_diameters, strict=True)
        )
        path = reach - self.working_centre_distance * math.sin(self.working_pressure_angle)
        return path / (math.pi * self.module * math.cos(self.pressure_angle))

    @cached_property
    def single_stiffness(self) -> float:
        """C' of ISO 6336-1, Method B: greatest stiffness of one pair of solid steel wheels.

        c' = C_M C_R C_B/q', with C_R = 1 and C_B = (1 + 0.5 (1.2 - h_fP)) (1 - 0.02 (20 - alpha)).
        """
        (z_1, x_1), (z_2, x_2) = sorted(
            zip(self.teeth, self.profile_shift, strict=True), key=lambda one: (one[0], -one[1])
        )
        terms = (1.0, 1 / z_1, 1 / z_2, x_1, x_1 / z_1, x_2, x_2 / z_2, x_1**2, x_2**2)
        flexibility = sum(c * term for c, term in zip(SINGLE_FLEXIBILITY, terms, strict=True))
        rack = 1.0 + 0.5 * (1.2 - self.dedendum)
        rack *= 1.0 - 0.02 * (20.0 - math.degrees(self.pressure_angle))
        return CORRECTION * rack / flexibility

    @cached_property
    def mesh_stiffness(self) -> float:
        """c_gamma_alpha of ISO 6336-1 (2006), clause 9: the mean, c' (0.75 epsilon + 0.25)."""
        return self.single_stiffness * (0.75 * self.contact_ratio + 0.25)
