"""Fig. 2: response curves of a to d and h."""

from gearmesh.dynamics.response_curves import WIDTH
from gearmesh.reproduction.claims.evidence import Evidence
from gearmesh.reproduction.thresholds import NONLINEAR

LUBRICANT = [f"{letter}-lubricant" for letter in NONLINEAR]
ALL_LUBRICANT = ["b-lubricant", *LUBRICANT]
IN_MATERIAL = [f"{letter}-{symbol}" for letter in NONLINEAR for symbol in ("material", "both")]


def continuous_curves(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F2.1: the greatest step of y_max that remains under refinement."""
    steps = evidence.located("largest_step", IN_MATERIAL)
    remaining = {name: step["step"] for name, step in steps.items()}
    return remaining, f"greatest step of y_max in y_st over an interval of {WIDTH:g} in ν_s"


def material_or_both(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F2.2: how much additional damping in contact loss changes y_max."""
    differences = evidence.located("material_or_both", NONLINEAR)
    return differences, "greatest relative difference of y_max between □ and ×"


def jump_frequencies(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F2.3: the two jumps of every • curve."""
    jumps = {
        "near 0.66": evidence.located("first_jump", ALL_LUBRICANT),
        "near 0.8": evidence.located("second_jump", ALL_LUBRICANT),
    }
    return jumps, "ν_s of the upward jumps, located by refinement"


def agreement_between_jumps(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F2.4: spread between the • curves of c, d and h below and above the second jump."""
    spread = evidence.located("course_spread", ("below", "above"))
    measured = {"ratio": spread["below"] / spread["above"], **spread}
    return measured, "median relative spread of y_max in ⟨0.66; 0.8⟩ and ⟨0.8; 1.1⟩"


def rounded_peaks(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F2.5: distance in ν_s of the peaks of d and h from the jump and from the peak of c."""
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
    """F2.6: distance of c, d and h with • from inverse mesh."""
    backlash = evidence.pair.backlash / evidence.pair.static_deflection
    least = evidence.located("lowest", LUBRICANT)
    return {name: y + backlash for name, y in least.items()}, "least y + s, in y_st"


def linear_jumps(evidence: Evidence) -> tuple[dict[str, int], str]:
    """F2.7: number of jumps of the linearly damped curves."""
    found = evidence.located("jumps", ("b-material", "b-both"))
    nus = sorted(jump["nu"] for jumps in found.values() for jump in jumps)
    shown = ", ".join(f"{nu:.3f}" for nu in nus) or "none"
    return {name: len(jumps) for name, jumps in found.items()}, f"number of jumps; at ν_s {shown}"


MEASURES = {
    "F2.1": continuous_curves,
    "F2.2": material_or_both,
    "F2.3": jump_frequencies,
    "F2.4": agreement_between_jumps,
    "F2.5": rounded_peaks,
    "F2.6": no_inverse_mesh,
    "F2.7": linear_jumps,
}
