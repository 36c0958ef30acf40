"""The branches of the laws that jump, and the forces that act on them."""

from dataclasses import dataclass
from typing import NamedTuple

from gearmesh.model.functions import Number


@dataclass(frozen=True, slots=True)
class Mode:
    """The branch of every law that jumps; between jumps the equations of motion are smooth.

    Attributes
    ----------
    regime : int
        `NORMAL_MESH`, `CONTACT_LOSS` or `INVERSE_MESH`.
    segment : float
        Any mesh phase between the same two jumps of C(t) and gamma(t).
    run_out_sign : int
        First sign of eq. (6).
    slip_sign : int
        Second sign of eq. (6), that of z_3' - z_2'; 0 while the flanks stick, with z_3' = z_2'.
    parted : bool
        Whether the contact force is set to 0 because it would pull (`GeneralTerms.non_adhesive`).
    pressing : tuple of float
        1 for each pair of teeth that presses and 0 for the others, if pairs touch singly
        (`gearmesh.model.flanks`); else empty. The regime is normal mesh while any pair presses.
    """

    regime: int
    segment: float
    run_out_sign: Number = 1
    slip_sign: Number = 1
    parted: bool = False
    pressing: tuple[Number, ...] = ()


class Forces(NamedTuple):
    """Stiffness of the mesh, and all forces that the wheels exert on each other, in F_st.

    Attributes
    ----------
    stiffness : float
        C / C_s.
    elastic : float
        Elastic force, from which the friction follows.
    contact : float
        Elastic and damping force of the flanks in contact, and damping of the lubricant in contact
        loss; positive where it presses the flanks of normal mesh.
    normal : float
        The contact force that acts: `contact`, or 0 while the flanks are parted.
    friction : float
        F_T on wheel 3.
    moment_3, moment_2 : float
        Additional moments of friction over R_bi.
    """

    stiffness: Number
    elastic: Number
    contact: Number
    normal: Number
    friction: Number
    moment_3: Number
    moment_2: Number
