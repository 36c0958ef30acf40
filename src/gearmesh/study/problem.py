"""The dimensionless problem that a pair states for one variant and mesh frequency."""

from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.errors import InputError
from gearmesh.model.motion import state_at
from gearmesh.model.problem import Problem
from gearmesh.model.variants import Variant

if TYPE_CHECKING:
    from gearmesh.study.pair import Pair


def problem_of(pair: "Pair", variant: Variant, nu: float) -> Problem:
    """State one run in static deflections, 1/Ω_s and static forces (`Pair.problem`)."""
    if pair.mass_ratio != 1.0:
        raise InputError(
            f"mass_ratio: found {pair.mass_ratio:g}; allowed is 1, wheels with equal J/R_b²"
        )
    y_st, c_s = pair.static_deflection, pair.stiffness_mean
    eccentricity_3, eccentricity_2 = pair.eccentricity
    problem = Problem(
        nu=nu,
        contact_ratio=pair.contact_ratio,
        stiffness_max=pair.mesh_stiffness_max / c_s,
        stiffness_min=pair.stiffness_min / c_s,
        material=_damping_law(
            pair, variant, variant.material_powers, ("damping_1", "damping_2", "damping_3")
        ),
        lubricant=_damping_law(
            pair, variant, variant.lubricant_powers, ("damping_1m", "damping_2m", "damping_3m")
        ),
        backlash=pair.backlash / y_st,
        body_mass=pair.body_mass / pair.reduced_mass,
        bearing_stiffness=pair.bearing_stiffness / c_s,
        bearing_damping_ratio=pair.bearing_damping_ratio,
        friction_coefficient=pair.friction_coefficient,
        pressure_angle=pair.pressure_angle,
        teeth=pair.teeth,
        base_radius=pair.base_radius / y_st,
        eccentricity_3=eccentricity_3 / y_st,
        eccentricity_2=eccentricity_2 / y_st,
        eccentricity_angle=pair.eccentricity_angle,
        deviation=tuple((c / y_st, s / y_st) for c, s in pair.profile_deviation),
        stiffness_harmonics=pair.stiffness_harmonics,
        initial_phase=pair.initial_phase,
        revolutions=pair.revolutions,
        kept_revolutions=pair.kept_revolutions,
    )
    if pair.initial_displacement is None and pair.initial_velocity == 0.0:
        return problem  # at rest in static equilibrium
    y = 1.0 if pair.initial_displacement is None else pair.initial_displacement / y_st
    return replace(problem, initial_state=state_at(problem, y, pair.initial_velocity / y_st))


def _damping_law(
    pair: "Pair", variant: Variant, powers: tuple[bool, bool, bool], names: tuple[str, str, str]
) -> tuple[float, float, float]:
    """Return the coefficients of v, |v| v and v³ in eq. (7), in units of C_s y_st."""
    reach = pair.static_deflection / pair.damping_length
    stated = (getattr(pair, name) for name in names)
    linear, quadratic, cubic = (
        2.0 * pair.damping_ratio_of(pair.damping if k is None else k) * variant.factor * acts
        for acts, k in zip(powers, stated, strict=True)
    )
    return linear, quadratic * reach, cubic * reach**2
