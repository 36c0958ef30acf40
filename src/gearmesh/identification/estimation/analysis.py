"""Samples of the open parameters, weighed by how well they fit the claims."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearmesh.identification.estimation import inference
from gearmesh.identification.estimation.inference import ENOUGH, Fit, effective_size
from gearmesh.identification.estimation.wording import Statement, statements, weight_of_claims
from gearmesh.identification.sampling.boxes import Box, prior_weights
from gearmesh.identification.sampling.store import Samples
from gearmesh.identification.settings import Settings
from gearmesh.reproduction.claims import Claim


@dataclass(frozen=True)
class Family:
    """An even design with the focused ones that follow it, weighed as one even design."""

    samples: Samples
    prior: np.ndarray
    factors: tuple[str, ...]

    @classmethod
    def of(
        cls, samples: Samples, chain: Sequence[str], boxes: Sequence[Box], settings: Settings
    ) -> "Family":
        """Put the designs of a chain together."""
        factors = settings.designs[chain[0]].vary
        parts = [samples.of(name) for name in chain]
        places = np.concatenate([part.unit(factors) for part in parts])
        sizes = [part.design.size for part in parts]
        order = np.concatenate([np.flatnonzero(samples.design == name) for name in chain])
        prior = np.empty(order.size)
        prior[np.argsort(np.argsort(order))] = prior_weights(places, sizes, boxes)
        return cls(samples.of(*chain), prior, factors)


@dataclass(frozen=True)
class Analysis:
    """Samples, seen through a ledger.

    Attributes
    ----------
    samples : Samples
        Of all designs.
    boxes : dict of str to Box
        Of the focused designs.
    ledger : sequence of Claim
        The claims that may depend on the open parameters.
    settings : Settings
        Ranges, designs, wordings.
    """

    samples: Samples
    boxes: dict[str, Box]
    ledger: Sequence[Claim]
    settings: Settings

    @cached_property
    def stated(self) -> list[Statement]:
        """What the claims state."""
        return statements(self.ledger, self.settings.wordings)

    @cached_property
    def claims(self) -> list[str]:
        """Ids of the claims."""
        return [claim.id for claim in self.ledger]

    def family(self, first: str) -> Family:
        """Return an even design with all focused ones that follow it."""
        chain = [first]
        while following := [n for n, d in self.settings.designs.items() if d.around == chain[-1]]:
            chain.append(following[0])
        boxes = [self.boxes[name] for name in chain[1:]]
        return Family.of(self.samples, chain, boxes, self.settings)

    def weights(self, samples: Samples) -> dict[str, np.ndarray]:
        """Return claim -> how well each sample fits it."""
        return weight_of_claims(self.stated, samples.measured)

    def held(self, samples: Samples) -> dict[str, np.ndarray]:
        """Return claim -> whether it holds on each sample."""
        return {name: weight > 0 for name, weight in self.weights(samples).items()}

    def evidence(self, family: Family) -> list[str]:
        """Return the largest set of claims that enough samples fit together.

        Of sets of the same size it is the one that fits most of the prior.
        """
        weight = np.array(list(self.weights(family.samples).values()))
        patterns = np.unique(weight.T > 0, axis=0)
        counts = patterns.sum(axis=1)
        for count in np.unique(counts)[::-1]:
            sizes = {
                tuple(pattern): effective_size(family.prior * np.prod(weight[pattern], axis=0))
                for pattern in patterns[counts == count]
            }
            best = max(sizes, key=lambda pattern: sizes[pattern])
            if sizes[best] >= ENOUGH:
                return [name for name, kept in zip(self.claims, best, strict=True) if kept]
        return self.claims

    def fit(self, family: Family, claims: Sequence[str]) -> Fit:
        """Fit some claims."""
        weight = self.weights(family.samples)
        return inference.fit([weight[name] for name in claims], family.prior)
