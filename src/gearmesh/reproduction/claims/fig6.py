"""Fig. 6: c-□ with the damping k2 and with 5 k2."""

import math

from gearmesh.reproduction.claims.evidence import Evidence
from gearmesh.reproduction.claims.fig5 import distance_to_switch
from gearmesh.reproduction.frequencies import CROSSING

LESS, MORE = "c-material", "c-material-5x"


def more_damped_exceeds(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F6.1: the interval around 0.61 where y_max of the more damped curve is greater."""
    intervals = evidence.located("exceedance", [MORE])[MORE]
    nearest = min(
        intervals,
        key=lambda ends: max(ends[0] - CROSSING, CROSSING - ends[1], 0.0),
        default=(math.nan, math.nan),
    )
    measured = dict(zip(("from", "to"), nearest, strict=True))
    return measured, "interval of ν_s in ⟨0.6; 0.8⟩ where y_max with 5k exceeds that with k"


def loop_ends(evidence: Evidence) -> tuple[dict[str, float], str]:
    """F6.2: where the loops end with each damping."""
    ends = evidence.located("loop_end", (LESS, MORE))
    measured = {"k": ends[LESS], "5k": ends[MORE], "lead of 5k": ends[LESS] - ends[MORE]}
    return measured, "ν_s where the loops end"


def corner_of_more_damped(evidence: Evidence) -> tuple[float, str]:
    """F6.3: distance of the last loop with 5k from a switch of C(t)."""
    measured = distance_to_switch(evidence, MORE)
    return measured, "distance of the last loop with 5k from a switch of C(t), in mesh periods"


MEASURES = {"F6.1": more_damped_exceeds, "F6.2": loop_ends, "F6.3": corner_of_more_damped}
