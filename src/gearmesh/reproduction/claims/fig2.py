"""Fig. 2: resonance characteristics of a to d and h."""

from gearmesh.dynamics.response_curves import WIDTH
from gearmesh.reproduction.claims.evidence import Evidence
from gearmesh.reproduction.thresholds import NONLINEAR

LUBRICANT = [f"{letter}-lubricant" for letter in NONLINEAR]
ALL_LUBRICANT = ["b-lubricant", *LUBRICANT]
IN_MATERIAL = [f"{letter}-{symbol}" for letter in NONLINEAR for symbol in ("material", "both")]


def continuous_courses(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F2.1: what is left of the greatest step of y_max under refinement."""
    steps = evidence.located("largest_step", IN_MATERIAL)
    left = {name: step["step"] for name, step in steps.items()}
    return left, f"step of y_max in y_st that is left over an interval of {WIDTH:g} in ν_s"


def material_or_both(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F2.2: how far damping in contact loss, too, changes y_max."""
    differences = evidence.located("material_or_both", NONLINEAR)
    return differences, "greatest relative difference of y_max between □ and ×"


def jump_places(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F2.3: the two jumps of every • course."""
    places = {
        "near 0.66": evidence.located("first_jump", ALL_LUBRICANT),
        "near 0.8": evidence.located("second_jump", ALL_LUBRICANT),
    }
    return places, "ν_s of the jumps upwards, located by refinement"


def agreement_between_jumps(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F2.4: spread between the • courses of c, d and h below and above the second jump."""
    spread = evidence.located("course_spread", ("below", "above"))
    measured = {"ratio": spread["below"] / spread["above"], **spread}
    return measured, "median relative spread of y_max in ⟨0.66; 0.8⟩ and ⟨0.8; 1.1⟩"


def rounded_peaks(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F2.5: how far the peaks of d and h lie beyond the jump, and beyond the peak of c."""
    peaks = {name: found["nu"] for name, found in evidence.located("peak", LUBRICANT).items()}
    jumps = evidence.located("second_jump", LUBRICANT)
    quadratic, *rounded = LUBRICANT
    measured = {
        "beyond the jump": {name: peaks[name] - jumps[name] for name in rounded},
        "beyond the peak of c": {name: peaks[name] - peaks[quadratic] for name in rounded},
    }
    shown = ", ".join(f"{name[0]} {nu:.3f}" for name, nu in peaks.items())
    return measured, f"distances in ν_s; peaks at {shown}"


def no_inverse_mesh(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F2.6: how far c, d and h with • stay away from inverse mesh."""
    backlash = evidence.pair.backlash / evidence.pair.static_deflection
    least = evidence.located("lowest", LUBRICANT)
    return {name: y + backlash for name, y in least.items()}, "least y + s, in y_st"


def linear_jumps(evidence: Evidence) -> tuple[dict[str, int], str]:
    """F2.7: jumps of the linearly damped courses."""
    found = evidence.located("jumps", ("b-material", "b-both"))
    places = sorted(jump["nu"] for jumps in found.values() for jump in jumps)
    shown = ", ".join(f"{nu:.3f}" for nu in places) or "none"
    return {name: len(jumps) for name, jumps in found.items()}, f"number of jumps; at ν_s {shown}"


MEASURES = {
    "F2.1": continuous_courses,
    "F2.2": material_or_both,
    "F2.3": jump_places,
    "F2.4": agreement_between_jumps,
    "F2.5": rounded_peaks,
    "F2.6": no_inverse_mesh,
    "F2.7": linear_jumps,
}
