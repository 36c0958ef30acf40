"""Fig. 3: bifurcation diagrams of c, d and h."""

from gearmesh.dynamics.response_curves import SCAN
from gearmesh.reproduction.claims.evidence import Evidence
from gearmesh.reproduction.claims.fig2 import LUBRICANT
from gearmesh.reproduction.mechanisms.bands import EDGE_STEP


def bifurcation_onset(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F3.1: lowest ν_s from which the • curves are split."""
    onsets = {
        "y_max": evidence.located("onset_maxima", LUBRICANT),
        "y_min": evidence.located("onset_minima", LUBRICANT),
    }
    return onsets, "ν_s above which the extrema of the mesh periods differ visibly"


def further_branches(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F3.2: upper end of the further extremum branches of c-□."""
    name = "c-material"
    before = evidence.located("turning_points_before", [name])[name]
    end = evidence.located("loop_end", [name])[name]
    measured = {"end": end, "turning points before": before}
    return measured, "ν_s where the branches end; fewest turning points a period from 0.6 to there"


def contact_loss(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F3.3: least y of the • curves; negative in contact loss."""
    return evidence.located("lowest", LUBRICANT), "least y in y_st"


def order_below(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F3.4: spread of the maxima below 0.8 (without the jump near 0.66), relative to above 1.1."""
    spreads = evidence.located("maxima_spread", LUBRICANT)
    ratios = {name: s["below"] / s["above"] for name, s in spreads.items()}
    below = {name: s["below"] for name, s in spreads.items()}
    return {"ratio": ratios, "below": below}, "median spread of the maxima of the periods, in y_st"


def orderly_bands(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F3.4b: how smoothly the edges of the bands of extrema change in ⟨0.6; 0.8⟩."""
    found = evidence.located("band", LUBRICANT)
    measured = {
        key: {name: measures[key] for name, measures in found.items()}
        for key in ("smooth", "growth")
    }
    return measured, (
        f"share of the steps of {SCAN:g} in ν_s over which both edges of the band change by at "
        f"most {EDGE_STEP:g} y_st, and the greatest maximum near 0.66 over the median elsewhere"
    )


def loss_at_jumps(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F3.5: increase of contact loss at the jumps."""
    gained = evidence.located("loss_gained", LUBRICANT)
    measured = {
        jump: {name: found[jump] for name, found in gained.items()} for jump in ("first", "second")
    }
    return measured, "share of contact loss just above the jump minus that just below"


def orderly_decline(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F3.6: greatest rise of y_max between the peak and the onset of the bifurcation."""
    return evidence.located("largest_rise", LUBRICANT), "greatest rise of y_max, in y_st"


MEASURES = {
    "F3.1": bifurcation_onset,
    "F3.2": further_branches,
    "F3.3": contact_loss,
    "F3.4": order_below,
    "F3.4b": orderly_bands,
    "F3.5": loss_at_jumps,
    "F3.6": orderly_decline,
}
