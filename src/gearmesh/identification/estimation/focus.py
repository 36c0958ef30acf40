"""The samples that meet most claims, and the box of a focused design around them."""

from collections.abc import Sequence

import numpy as np

from gearmesh.identification.estimation.wording import closeness, statements, weight_of_claims
from gearmesh.identification.sampling.boxes import Box, box_of
from gearmesh.identification.sampling.store import Samples
from gearmesh.identification.settings import Design
from gearmesh.reproduction.claims import Claim

BEST = 64
"""Number of best samples that span the box of a focused design."""


def best(held: np.ndarray, fit: np.ndarray, count: int = BEST) -> np.ndarray:
    """Return the indices of the samples that meet most claims, in ties the best fits first."""
    return np.lexsort((-fit, -held))[:count]


def around(before: Samples, design: Design, ledger: Sequence[Claim]) -> Box:
    """Return the box of a focused design around the best samples before it."""
    stated = statements(ledger)
    held = np.sum([w > 0 for w in weight_of_claims(stated, before.measured).values()], axis=0)
    fit = np.sum([closeness(statement, before.measured) for statement in stated], axis=0)
    return box_of(before.unit(design.vary)[best(held, fit)], design.vary)
