"""Values of the open parameters that are compatible with the claims of the paper.

The method is approximate Bayesian computation by rejection (Beaumont, Annu. Rev. Stat. Appl. 6,
2019). The weight of a sample of the prior states how well its measured values fit the words of the
paper. The prior is even over the ranges of the settings, on their scales.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

ROBUST, CONDITIONAL, CONTRADICTED = "robust", "conditional", "contradicted"

ROBUST_FROM = 0.9
"""A claim that holds in this share of the plausible space, or more, is robust."""

CONTRADICTED_BELOW = 0.01
"""A claim that holds in less than this share is contradicted."""

ENOUGH = 40
"""Effective number of samples that an inference needs. With fewer, more statements may fail."""

LEVEL = 0.95
"""Probability of the regions."""

PARTS = 12
"""Number of equal parts of a factor's range in which the density is given."""

_GRID = 401


def effective_size(weights: np.ndarray) -> float:
    """Return the effective number of weighted samples (Kish)."""
    total = weights.sum()
    return float(total**2 / np.sum(weights**2)) if total > 0 else 0.0


def share(held: np.ndarray, prior: np.ndarray) -> tuple[float, float]:
    """Return the share of the prior where something holds, and its standard error."""
    prior = prior / prior.sum()
    value = float(prior @ held)
    return value, float(np.sqrt(np.sum(prior**2 * (held - value) ** 2)))


def standing(value: float) -> str:
    """Call a claim robust, conditional or contradicted by its share of the plausible space."""
    if value >= ROBUST_FROM:
        return ROBUST
    return CONTRADICTED if value < CONTRADICTED_BELOW else CONDITIONAL


@dataclass(frozen=True)
class Fit:
    """Weights of the samples after a fit.

    Attributes
    ----------
    weights : ndarray, shape (n_samples,)
        With sum 1.
    forgiven : int
        How many statements a sample may miss; 0 if enough samples miss none.
    """

    weights: np.ndarray
    forgiven: int

    @property
    def size(self) -> float:
        """Effective number of samples."""
        return effective_size(self.weights)


def fit(evidence: Sequence[np.ndarray], prior: np.ndarray, enough: float = ENOUGH) -> Fit:
    """Weigh samples by how well they fit.

    Parameters
    ----------
    evidence : sequence of ndarray, shape (n_samples,)
        For each statement, how well each sample fits it, 0 to 1.
    prior : ndarray, shape (n_samples,)
        Weights that make the samples an even design.
    enough : float
        Effective number of samples below which a sample may miss one statement more.
    """
    fits = np.array(evidence)
    missed = np.sum(fits == 0.0, axis=0)
    kept = np.prod(np.where(fits == 0.0, 1.0, fits), axis=0)
    for forgiven in range(int(missed.min()), len(fits) + 1):
        weights = prior * kept * (missed <= forgiven)
        if effective_size(weights) >= enough:
            break
    return Fit(weights / weights.sum(), forgiven)


def region(places: np.ndarray, weights: np.ndarray, level: float = LEVEL) -> tuple[float, float]:
    """Return the central interval of a factor, on the unit interval.

    The samples are first smoothed by a kernel of Silverman's width, because a few samples do not
    resolve the ends of a region.
    """
    kept = weights > 0
    places, weights = places[kept], weights[kept] / weights[kept].sum()
    grid = np.linspace(0.0, 1.0, _GRID)
    below = _smoothed(places, weights, grid)
    low, high = np.interp([0.5 * (1 - level), 0.5 * (1 + level)], below, grid)
    return float(low), float(high)


def shape(places: np.ndarray, weights: np.ndarray, parts: int = PARTS) -> np.ndarray:
    """Return the density in equal parts of a factor's range, relative to the prior."""
    filled, _ = np.histogram(places, parts, (0.0, 1.0), weights=weights)
    return parts * filled / weights.sum()


def _smoothed(places: np.ndarray, weights: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """Return the smoothed distribution function; the kernel is folded back at both ends."""
    spread = np.sqrt(weights @ (places - weights @ places) ** 2)
    middle = quantile(places, weights, 0.75) - quantile(places, weights, 0.25)
    scale = min(spread, middle / 1.34) or spread
    width = max(0.9 * scale * effective_size(weights) ** -0.2, 1e-6)
    images = np.concatenate([places, -places, 2.0 - places])
    below = ndtr((grid[:, None] - images) / width) @ np.tile(weights, 3)
    return below - below[0]


def quantile(places: np.ndarray, weights: np.ndarray, probability: float) -> float:
    """Return a quantile of weighted places."""
    order = np.argsort(places)
    cumulative = np.cumsum(weights[order])
    middle = cumulative - 0.5 * weights[order]
    return float(np.interp(probability * cumulative[-1], middle, places[order]))


def joint_level(factors: int, level: float = LEVEL) -> float:
    """Return the level of each factor's region at which all together have `level` (Bonferroni)."""
    return 1.0 - (1.0 - level) / factors


def joint_sets(
    held: Mapping[str, np.ndarray], prior: np.ndarray, most: int = 5
) -> list[tuple[tuple[str, ...], np.ndarray]]:
    """Return the largest sets of claims that hold together somewhere.

    Returns
    -------
    list of (names of the claims that do not hold, which samples meet all others)
        Sets that are not part of another set, sorted by size and then by share of the prior; at
        most `most`.
    """
    names = list(held)
    patterns, which = np.unique(np.array(list(held.values())).T, axis=0, return_inverse=True)
    which = which.ravel()
    shares = np.bincount(which, prior, len(patterns))
    largest = [
        i
        for i, pattern in enumerate(patterns)
        if not any(np.all(other >= pattern) and other.sum() > pattern.sum() for other in patterns)
    ]
    largest.sort(key=lambda i: (-patterns[i].sum(), -shares[i]))
    return [(tuple(np.array(names)[~patterns[i]].tolist()), which == i) for i in largest[:most]]


def predictive(held: np.ndarray, found: Fit) -> float:
    """Return the probability of a claim after a fit, never quite 0 or 1 (Laplace)."""
    return float((found.weights @ held * found.size + 1.0) / (found.size + 2.0))
