"""Fig. 5: phase portrait of c-□ over ν_s."""

from gearmesh.model.stiffness import switch_phases
from gearmesh.reproduction.claims.evidence import Evidence


def loops_vanish(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F5.1: turning points in a mesh period below and above the end of the loops."""
    name = "c-material"
    measured = {
        side: evidence.located(f"turning_points_{side}", [name])[name]
        for side in ("before", "beyond")
    }
    end = evidence.located("loop_end", [name])[name]
    return measured, f"turning points a period below and above ν_s = {end:.4f}"


def distance_to_switch(evidence: Evidence, name: str) -> float:
    """Return the distance in mesh periods from the closing of the last loop to a switch of C(t)."""
    closing = evidence.located("loop_place", [name])[name]
    phases = switch_phases(evidence.pair.contact_ratio)
    return float(min(abs((closing - phase + 0.5) % 1.0 - 0.5) for phase in phases))


def loops_melt(evidence: Evidence) -> tuple[float, str]:
    """F5.2: the last loop closes at a switch."""
    measured = distance_to_switch(evidence, "c-material")
    return measured, "distance of the last loop from a switch of C(t), in mesh periods"


MEASURES = {"F5.1": loops_vanish, "F5.2": loops_melt}
