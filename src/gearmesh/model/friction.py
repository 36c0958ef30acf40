"""Friction in the mesh: eq. (6), its signs, and the arms of its moments.

Geometry
--------
y runs along the mesh line, in the direction in which wheel 3 pushes wheel 2, and z across it. The
centre of wheel 3 lies at z = -R_b3, that of wheel 2 at z = +R_b2, and the mesh line touches the
base circles (R_b3 + R_b2) tan(alpha) apart; the pitch point divides this in the ratio of the radii.
A pair of teeth touches at the distance sigma from the pitch point; sigma grows with time, from
where the pair comes into contact to where it leaves epsilon p_b later, at one base pitch
p_b = 2 pi R_bi / Z_i in a mesh period. For equal wheels the pitch point is the middle of this path;
for others see `pitch_offset`. Seen from the points where the mesh line touches the base circles,
the contact is at

    rho_3 = R_b3 tan(alpha) + sigma,    rho_2 = R_b2 tan(alpha) - sigma.

A rotation phi_3 moves the flank of wheel 3 by R_b3 phi_3 along y and by -rho_3 phi_3 along z; a
rotation phi_2, counted in the same sense, moves that of wheel 2 by -R_b2 phi_2 and +rho_2 phi_2.
The friction force F_T on wheel 3 along +z, and -F_T on wheel 2, therefore do the virtual work

    F_T (dz_3 - dz_2) - rho_3 F_T dphi_3 - rho_2 F_T dphi_2,

which gives its generalised forces: F_T and -F_T on z_3 and z_2, and the additional moments
Delta M_T = -rho_3 F_T on phi_3 and -rho_2 F_T on phi_2. For equal wheels the arms in phi_3 + phi_2
add up to 2 R_b tan(alpha) wherever the contact is.

Sign
----
In steady rotation wheel 3 turns by +omega and wheel 2 by -omega, so the flanks slide at
-omega rho_3 + omega rho_2 = -2 omega sigma along z. With both signs of eq. (6) positive,
F_T = -f_T E gamma with gamma > 0 before the pitch point (sigma < 0): F_T opposes the sliding, and
dissipates, as long as the elastic force E is positive. In inverse mesh E is negative while gamma is
not, so eq. (6) as printed drives the sliding there; it is kept as printed.

Without run-out both signs are +1 (`follows_run_out`).

Rules with run-out
------------------
With run-out both signs of eq. (6) act: F_T = -A sign(z_3' - z_2') with A = f_T E gamma times the
first sign, that of the bracket. The paper does not state what holds if an argument is 0. The
following rules define it. They affect results: with other rules y_max of a run may change in its
second digit.

1. Opposed sliding sticks. Where A > 0 friction opposes the sliding. At z_3' = z_2' the flanks then
   stick (Filippov) while the force that holds them (`holding_force`) is within <-A; A>, and F_T
   takes that value. They slide again as soon as it takes more.
2. Driven sliding does not stick. Where A < 0 eq. (6) drives the sliding, and nothing can hold it.
   From z_3' = z_2' the flanks go where the bearings pull them.
3. In double contact and in contact loss friction neither holds nor drives, because A = 0. In double
   contact the forces of both pairs cancel. From z_3' = z_2' the flanks go where the bearings pull
   them, and the second sign follows.
4. From exact rest, where the bearings do not pull, the second sign is +1. This is how a run starts
   in double contact, where the sign acts on the moments alone.
5. At the start of a run the first sign is that of the bracket, +1 if it is 0.
6. The first sign cannot stick. Where friction turns the bracket back to 0 from both sides, no sign
   lasts, and eq. (6) has no solution. This takes run-outs that nearly cancel each other in eq. (3)
   (e_3 = e_2 and Delta = pi, where the bracket vanishes at all times), or friction far beyond that
   of gears. Such a run ends with the status ``friction_undefined``.

Nothing balances the moments of friction on the mean rotation (phi_3 - phi_2)/2: in the paper's
model the static moments are constant, and there is no damping to the frame. So the mean rotation
drifts, and with it the place of the run-out. The drift is part of the model, and is reported
(`gearmesh.solvers.response.Response.rotation_drift`); after some radians a run no longer has the
speed that it states.

Two pairs
---------
gamma halves in double contact, and for equal wheels one pair is before the pitch point when the
other is behind it: their forces cancel. Their moments on each wheel do not, because the arms differ
by a base pitch; they cancel only in the sum coordinate phi_3 + phi_2.
"""

import math
from typing import NamedTuple

from gearmesh.model import stiffness
from gearmesh.model.functions import Number


class Pair(NamedTuple):
    """A pair of teeth in contact: its gamma, and sigma in base pitches from the pitch point."""

    gamma: float
    sigma: float


def pairs_in_contact(phase: float, contact_ratio: float, pitch_offset: float = 0.0) -> list[Pair]:
    """Return the pairs of teeth in contact at the mesh phase `phase`.

    gamma runs through 0.5, 1, 0, -1, -0.5 along the path of a pair: an equal share of the load for
    each pair in contact, and a change of sign at the pitch point, `pitch_offset` base pitches
    behind the middle of the path.
    """
    places = [touching.place for touching in stiffness.touching_pairs(phase, contact_ratio)]
    found = []
    for place in places:
        sigma = place - pitch_offset
        side = 0.0 if sigma == 0.0 else -math.copysign(1.0, sigma)
        found.append(Pair(side / len(places), sigma))
    return found


def mesh_gamma(phase: float, contact_ratio: float, pitch_offset: float = 0.0) -> float:
    """Return gamma summed over the pairs in contact: 0 for two pairs, +1 then -1 for one."""
    return sum(pair.gamma for pair in pairs_in_contact(phase, contact_ratio, pitch_offset))


def pitch_offset(teeth_3: int, teeth_2: int, pressure_angle: float, contact_ratio: float) -> float:
    """Return how far the pitch point lies behind the middle of the path of contact.

    Returns
    -------
    float
        In base pitches; 0 for equal wheels.

    Notes
    -----
    The path of contact begins where the tip circle of wheel 2 meets the mesh line and ends where
    that of wheel 3 does. For standard wheels (addendum m_n) the two parts, up to the pitch point
    and from it on, are sqrt(r_a2^2 - r_b2^2) - r_2 sin(alpha) and sqrt(r_a3^2 - r_b3^2) -
    r_3 sin(alpha), and neither goes beyond the point where the mesh line touches the base circle.
    They share the path of the stated contact ratio in this proportion.
    """
    r_3, r_2 = 0.5 * teeth_3, 0.5 * teeth_2
    approach = min(_part_of_path(r_2, pressure_angle), r_3 * math.sin(pressure_angle))
    recess = min(_part_of_path(r_3, pressure_angle), r_2 * math.sin(pressure_angle))
    return contact_ratio * (approach / (approach + recess) - 0.5)


def _part_of_path(pitch_radius: float, pressure_angle: float) -> float:
    """Return the part of the path of contact that the tip circle of a wheel ends, in modules."""
    base_radius = pitch_radius * math.cos(pressure_angle)
    reach = math.sqrt((pitch_radius + 1.0) ** 2 - base_radius**2)
    return reach - pitch_radius * math.sin(pressure_angle)


def arms(sigma: Number, pressure_angle: float, teeth_3: int, teeth_2: int) -> tuple[Number, Number]:
    """Return rho_3 / R_b3 and rho_2 / R_b2 at `sigma` base pitches from the pitch point."""
    middle = math.tan(pressure_angle)
    return middle + 2.0 * math.pi / teeth_3 * sigma, middle - 2.0 * math.pi / teeth_2 * sigma


def follows_run_out(eccentricity_3: float, eccentricity_2: float) -> bool:
    """Return whether the signs of eq. (6) act: its Kronecker symbol is 1 for e_2 + e_3 = 0.

    With the Kronecker symbol both arguments are 1 plus a velocity that is small against 1, and
    both signs are +1.
    """
    return eccentricity_3 + eccentricity_2 != 0.0


def friction_force(
    elastic_force: float, coefficient: float, gamma: float, run_out_sign: float, slip_sign: float
) -> float:
    """Return F_T of eq. (6) in the unit of `elastic_force`.

    Parameters
    ----------
    elastic_force : float
        C(t) (y H1 + (y + s) H2), negative in inverse mesh and 0 in contact loss.
    coefficient : float
        f_T.
    gamma : float
        Of one pair, or summed over the pairs in contact.
    run_out_sign, slip_sign : float
        The two signs of eq. (6).
    """
    return -coefficient * elastic_force * gamma * run_out_sign * slip_sign


def holding_force(pull_3: Number, pull_2: Number, mass_3: float, mass_2: float) -> Number:
    """Return the F_T on wheel 3 that keeps z_3' - z_2' constant while the flanks stick.

    Parameters
    ----------
    pull_3, pull_2 : float
        Force c_b z + b_b z' of the bearings against z of each body.
    mass_3, mass_2 : float
        Masses of the bodies. Equal bodies take half of the difference of the pulls each.
    """
    return (pull_3 * mass_2 - pull_2 * mass_3) / (mass_3 + mass_2)
