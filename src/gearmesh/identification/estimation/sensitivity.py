"""Sensitivity of the thresholds to the parameters: PAWN indices of the samples.

The Kolmogorov-Smirnov distance compares the distribution of a measured value over a slice of the
factor's range with that over all samples. The index is the median of this distance over the slices
(Pianosi and Wagener, Environ. Model. Softw. 67, 2015, and 108, 2018). It is 0 for a factor without
influence and 1 at most. Values that do not exist form a class of their own.
"""

from dataclasses import dataclass

import numpy as np

SLICES = 8
"""Slices of a factor's range."""


def pawn(places: np.ndarray, values: np.ndarray, slices: int = SLICES) -> float:
    """Return the index of one factor for one measured value.

    Parameters
    ----------
    places : ndarray, shape (n,)
        Factor on the unit interval.
    values : ndarray, shape (n,)
        What was measured, NaN where it does not exist.
    slices : int
        Slices of the unit interval; 3 for the three kinds of run.
    """
    return _index(_slice(places, slices), _ranks(values), slices)


def _slice(places: np.ndarray, slices: int) -> np.ndarray:
    return np.minimum((places * slices).astype(int), slices - 1)


def _ranks(values: np.ndarray) -> np.ndarray:
    """Return the rank of each value among the distinct ones; all NaN share the last."""
    return np.unique(values, return_inverse=True, equal_nan=True)[1].ravel()


def _index(which: np.ndarray, ranks: np.ndarray, slices: int) -> float:
    size = int(ranks.max()) + 1
    counts = np.bincount(which * size + ranks, minlength=slices * size).reshape(slices, size)
    counts = counts[counts.any(axis=1)]
    below = np.cumsum(counts, axis=1) / counts.sum(axis=1, keepdims=True)
    everywhere = np.cumsum(counts.sum(axis=0)) / ranks.size
    return float(np.median(np.abs(below - everywhere).max(axis=1)))


@dataclass(frozen=True, slots=True)
class Index:
    """A PAWN index with its uncertainty.

    Attributes
    ----------
    value : float
        The index.
    low, high : float
        Its 90 % interval by bootstrap.
    chance : float
        Index that a factor without influence exceeds in one case of twenty.
    """

    value: float
    low: float
    high: float
    chance: float


def index(
    places: np.ndarray, values: np.ndarray, slices: int, resamples: int = 100, seed: int = 0
) -> Index:
    """Return the index of one factor for one measured value, with its uncertainty.

    Parameters
    ----------
    places, values, slices
        As for `pawn`.
    resamples : int
        Number of resamples of the bootstrap, and of permutations for `chance`.
    seed : int
        Seed of both.
    """
    rng = np.random.default_rng(seed)
    which, ranks = _slice(places, slices), _ranks(values)
    again = []
    for _ in range(resamples):
        drawn = rng.integers(0, ranks.size, ranks.size)
        again.append(_index(which[drawn], ranks[drawn], slices))
    nothing = [_index(rng.permutation(which), ranks, slices) for _ in range(resamples)]
    value = _index(which, ranks, slices)
    # Resampling increases the distance, so the interval is centred on the index itself.
    low, high = value + np.percentile(again, [5, 95]) - np.mean(again)
    return Index(value, max(float(low), 0.0), float(high), float(np.percentile(nothing, 95)))
