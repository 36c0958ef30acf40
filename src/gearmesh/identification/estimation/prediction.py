"""Test of the inference: fit one half of the claims and predict the other half."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gearmesh.identification.estimation.inference import Fit, fit, predictive, quantile
from gearmesh.identification.estimation.wording import Columns, Statement, columns_of

COVERED = 0.9
"""Probability of the intervals in which held-out numbers should lie."""


@dataclass(frozen=True)
class Prediction:
    """Claims predicted by others.

    Attributes
    ----------
    before, after : dict of str to float
        Held-out claim -> its probability before and after the fit to the other claims.
    covered : dict of str to bool
        Column of a held-out number -> whether the number lies in the predicted interval.
    narrowed : dict of str to float
        Column -> length of that interval, as a share of the one before the fit.
    found : Fit
        The fit.
    """

    before: dict[str, float]
    after: dict[str, float]
    covered: dict[str, bool]
    narrowed: dict[str, float]
    found: Fit

    @property
    def gain(self) -> float:
        """Mean information on a held-out claim, in bits: above 0 if the fit helps."""
        gains = [np.log2(self.after[name] / self.before[name]) for name in self.after]
        return float(np.mean(gains))


def halves(
    claims: Sequence[str], together: Iterable[Sequence[str]], count: int, seed: int
) -> list[tuple[list[str], list[str]]]:
    """Return `count` random cuts of the claims into two halves.

    Parameters
    ----------
    claims : sequence of str
        What is cut.
    together : iterable of sequence of str
        Claims that must stay in the same half.
    count, seed : int
        How many cuts, and the seed of the random order.
    """
    groups = [[name for name in group if name in claims] for group in together]
    groups += [[name] for name in claims if not any(name in group for group in groups)]
    rng = np.random.default_rng(seed)
    cuts = []
    for _ in range(count):
        order = [name for i in rng.permutation(len(groups)) for name in groups[i]]
        cuts.append((order[: len(order) // 2], order[len(order) // 2 :]))
    # A group that the cut would split goes to the first half as a whole.
    return [_healed(first, second, groups) for first, second in cuts]


def _healed(
    first: list[str], second: list[str], groups: list[list[str]]
) -> tuple[list[str], list[str]]:
    last = next(group for group in groups if first[-1] in group)
    moved = [name for name in second if name in last]
    return [*first, *moved], [name for name in second if name not in last]


def predict(
    fitted: Sequence[str],
    held_out: Sequence[str],
    weight: Mapping[str, np.ndarray],
    stated: Sequence[Statement],
    measured: Columns,
    prior: np.ndarray,
) -> Prediction:
    """Fit some claims and predict others.

    Parameters
    ----------
    fitted, held_out : sequence of str
        Claims.
    weight : mapping of str to ndarray, shape (n_samples,)
        Claim -> how well each sample fits it.
    stated : sequence of Statement
        What the claims state.
    measured : mapping of str to ndarray, shape (n_samples,)
        Column -> what the model measures.
    prior : ndarray, shape (n_samples,)
        Weights that make the samples an even design.
    """
    before = Fit(prior / prior.sum(), 0)
    found = fit([weight[name] for name in fitted], prior)
    numbers = {
        column: statement
        for statement in stated
        if statement.claim in held_out and statement.is_number and statement.quantity
        for column in columns_of(statement, measured)
    }
    covered, narrowed = {}, {}
    for column, statement in numbers.items():
        low, high = _interval(measured[column], found.weights)
        first, last = _interval(measured[column], prior)
        covered[column] = low <= statement.high and high >= statement.low
        narrowed[column] = (high - low) / (last - first) if last > first else 1.0
    return Prediction(
        {name: predictive(weight[name] > 0, before) for name in held_out},
        {name: predictive(weight[name] > 0, found) for name in held_out},
        covered,
        narrowed,
        found,
    )


def _interval(values: np.ndarray, weights: np.ndarray) -> tuple[float, float]:
    exists = np.isfinite(values) & (weights > 0)
    if not exists.any():
        return np.nan, np.nan
    ends = 0.5 * (1 - COVERED), 0.5 * (1 + COVERED)
    low, high = (quantile(values[exists], weights[exists], p) for p in ends)
    return low, high
