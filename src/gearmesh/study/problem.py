"""The dimensionless problem that a pair states for one variant and mesh frequency."""

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.model.motion import state_at, state_of, static_equilibrium
from gearmesh.model.problem import GeneralTerms, Problem, ToothFactor, Wheel
from gearmesh.model.variants import Variant
from gearmesh.study.flanks import flanks_of
from gearmesh.study.reading.schema import of_wheels
from gearmesh.study.relative import MM_PER_M

if TYPE_CHECKING:
    from gearmesh.study.pair import Pair


def problem_of(pair: "Pair", variant: Variant, nu: float) -> Problem:
    """State one run in static deflections, 1/Ω_s and static forces (`Pair.problem`)."""
    final_nu = None if pair.final_nu == nu else pair.final_nu
    problem = replace(_at_resonance(pair, variant), nu=nu, final_nu=final_nu)
    y_st = pair.static_deflection
    if pair.initial_coordinates or pair.initial_rates:
        q, v = static_equilibrium(problem)
        if pair.initial_coordinates:
            q = np.array(pair.initial_coordinates) / y_st
        if pair.initial_rates:
            v = np.array(pair.initial_rates) / y_st
        return replace(problem, initial_state=state_of(problem, q, v))
    if pair.initial_displacement is None and pair.initial_velocity == 0.0:
        return problem  # at rest in static equilibrium
    y = 1.0 if pair.initial_displacement is None else pair.initial_displacement / y_st
    return replace(problem, initial_state=state_at(problem, y, pair.initial_velocity / y_st))


@lru_cache(maxsize=64)
def _at_resonance(pair: "Pair", variant: Variant) -> Problem:
    """State a run at ν_s = 1 from static equilibrium. Only ν_s changes with the frequency."""
    y_st, c_s = pair.static_deflection, pair.stiffness_mean
    eccentricity_3, eccentricity_2 = pair.eccentricity
    wheel_3, wheel_2 = (_wheel(pair, place) for place in (0, 1))
    return Problem(
        nu=1.0,
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
        body_mass=wheel_3.body_mass,
        bearing_stiffness=wheel_3.bearing_stiffness[0],
        bearing_damping_ratio=wheel_3.bearing_damping_ratio[0],
        friction_coefficient=pair.friction_coefficient,
        pressure_angle=pair.pressure_angle,
        teeth=wheel_3.teeth,
        base_radius=wheel_3.base_radius,
        eccentricity_3=eccentricity_3 / y_st,
        eccentricity_2=eccentricity_2 / y_st,
        eccentricity_angle=pair.eccentricity_angle,
        deviation=tuple((c / y_st, s / y_st) for c, s in pair.profile_deviation),
        stiffness_harmonics=pair.stiffness_harmonics,
        initial_phase=pair.initial_phase,
        revolutions=pair.revolutions,
        kept_revolutions=pair.kept_revolutions,
        wheels=None if _alike(wheel_3, wheel_2) else (wheel_3, wheel_2),
        terms=_general_terms(pair),
    )


def _wheel(pair: "Pair", place: int) -> Wheel:
    """Return wheel 3 or 2, the places 0 and 1."""

    def of(name: str) -> Any:
        return of_wheels(getattr(pair, name))[place]

    across, ratio_across = of("bearing_stiffness_z"), of("bearing_damping_ratio_z")
    along, ratio = of("bearing_stiffness"), of("bearing_damping_ratio")
    return Wheel(
        teeth=of("teeth"),
        base_radius=pair.base_radii[place] / pair.static_deflection,
        inertia=(1.0 + pair.mass_ratio, 1.0 + 1.0 / pair.mass_ratio)[place],
        body_mass=of("body_mass") / pair.reduced_mass,
        bearing_stiffness=(
            along / pair.stiffness_mean,
            (along if across is None else across) / pair.stiffness_mean,
        ),
        bearing_damping_ratio=(ratio, ratio if ratio_across is None else ratio_across),
    )


def _alike(wheel_3: Wheel, wheel_2: Wheel) -> bool:
    """Return whether the wheels are equal, on bearings that are equal along and across."""
    stiffnesses, ratios = wheel_3.bearing_stiffness, wheel_3.bearing_damping_ratio
    return wheel_3 == wheel_2 and stiffnesses[0] == stiffnesses[1] and ratios[0] == ratios[1]


def _general_terms(pair: "Pair") -> GeneralTerms:
    teeth, c_s = of_wheels(pair.teeth), pair.stiffness_mean
    table = pair.stiffness_table
    torsion = [
        b_phi * MM_PER_M / radius**2 * pair.natural_frequency / c_s
        for b_phi, radius in zip(pair.torsional_damping, pair.base_radii, strict=True)
    ]
    return GeneralTerms(
        torque_harmonics_3=tuple(
            wave.harmonic(teeth) for wave in pair.torque_harmonics if wave.wheel == 3
        ),
        torque_harmonics_2=tuple(
            wave.harmonic(teeth) for wave in pair.torque_harmonics if wave.wheel == 2
        ),
        torsional_damping=(torsion[0], torsion[1]),
        stiffness_fourier=pair.stiffness_fourier,
        stiffness_table=tuple(
            (i / len(table), value / c_s) for i, value in enumerate((*table, *table[:1]))
        ),
        tooth_pair_stiffness=tuple(value / c_s for value in pair.tooth_pair_stiffness),
        tooth_factors=tuple(
            ToothFactor(one.wheel, one.tooth, one.factor) for one in pair.tooth_factors
        ),
        restoring_2=pair.restoring_2,
        restoring_3=pair.restoring_3,
        restoring_fourier=pair.restoring_fourier,
        restoring_power=pair.restoring_power,
        non_adhesive=pair.non_adhesive,
        damping_power={"none": 0.0, "sqrt": 0.5, "linear": 1.0}[pair.damping_follows_stiffness],
        backlash_harmonics=tuple(
            wave.harmonic(teeth, pair.static_deflection) for wave in pair.backlash_harmonics
        ),
        backlash_follows_centres=pair.backlash_follows_centres,
        **flanks_of(pair),
    )


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
