"""Fig. 3: bifurcation characteristics of c, d and h."""

from gearmesh.reproduction.claims.evidence import Evidence
from gearmesh.reproduction.claims.fig2 import LUBRICANT


def bifurcation_onset(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F3.1: from where on the • courses split up."""
    onsets = {
        "y_max": evidence.located("onset_maxima", LUBRICANT),
        "y_min": evidence.located("onset_minima", LUBRICANT),
    }
    return onsets, "ν_s from which the extrema of the mesh periods visibly differ"


def further_branches(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F3.2: range of the further extremum branches of c-□."""
    name = "c-material"
    before = evidence.located("turning_points_before", [name])[name]
    end = evidence.located("loop_end", [name])[name]
    measured = {"end": end, "turning points before": before}
    return measured, "ν_s where the branches end; least turning points a period from 0.6 up to it"


def contact_loss(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F3.3: the • courses reach into contact loss."""
    return evidence.located("lowest", LUBRICANT), "least y in y_st"


def order_below(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F3.4: spread of the maxima below 0.8, beside 0.66, against that above 1.1."""
    spreads = evidence.located("maxima_spread", LUBRICANT)
    ratios = {name: s["below"] / s["above"] for name, s in spreads.items()}
    below = {name: s["below"] for name, s in spreads.items()}
    return {"ratio": ratios, "below": below}, "median spread of the periods' maxima, in y_st"


def loss_at_jumps(evidence: Evidence) -> tuple[dict[str, dict[str, float]], str]:
    """F3.5: contact loss that comes with the jumps."""
    gained = evidence.located("loss_gained", LUBRICANT)
    measured = {
        jump: {name: found[jump] for name, found in gained.items()} for jump in ("first", "second")
    }
    return measured, "share of contact loss just above the jump less that just below"


def orderly_decline(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F3.6: rises of y_max between the peak and the onset."""
    return evidence.located("largest_rise", LUBRICANT), "greatest rise of y_max, in y_st"


MEASURES = {
    "F3.1": bifurcation_onset,
    "F3.2": further_branches,
    "F3.3": contact_loss,
    "F3.4": order_below,
    "F3.5": loss_at_jumps,
    "F3.6": orderly_decline,
}
