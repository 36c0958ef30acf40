"""How well a measured value fits the words of the paper."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gearmesh.errors import InputError
from gearmesh.identification.settings import Wording
from gearmesh.reproduction.claims import Bound, Claim

Columns = Mapping[str, np.ndarray]
"""Column -> values of all samples, shape (n_samples,); see the package `sampling`."""


@dataclass(frozen=True, slots=True)
class Statement:
    """One statement of a paper: one quantity of one claim.

    Attributes
    ----------
    claim, quantity : str
        Id of the claim, and the name of the quantity within it ('' if there is only one).
    low, high : float
        Ends of the values that fit.
    sure_low, sure_high : float
        Ends of the values with weight 1. From there the weight falls to 0 at the outer ends.
    """

    claim: str
    quantity: str
    low: float
    high: float
    sure_low: float
    sure_high: float

    @property
    def name(self) -> str:
        """Claim and quantity in one."""
        return f"{self.claim}|{self.quantity}" if self.quantity else self.claim

    @property
    def is_number(self) -> bool:
        """Whether the paper states a number rather than an order or a shape."""
        return bool(np.isfinite(self.low) and np.isfinite(self.high))

    @property
    def number(self) -> float:
        """The number that the paper states."""
        return 0.5 * (self.low + self.high)

    def weight(self, value: np.ndarray) -> np.ndarray:
        """Return how well values fit, 0 to 1; a value that does not exist has 0."""
        with np.errstate(invalid="ignore", divide="ignore"):
            rising = np.where(
                value >= self.sure_low, 1.0, self._slope(value, self.low, self.sure_low)
            )
            falling = np.where(
                value <= self.sure_high, 1.0, self._slope(value, self.high, self.sure_high)
            )
            weight = np.clip(np.minimum(rising, falling), 0.0, 1.0)
        return np.where(np.isfinite(value), weight, 0.0)

    @staticmethod
    def _slope(value: np.ndarray, outer: float, inner: float) -> np.ndarray:
        return (value - outer) / (inner - outer) if inner != outer else np.zeros_like(value)


def statements(ledger: Iterable[Claim], wordings: Sequence[Wording] = ()) -> list[Statement]:
    """Return the statements of a ledger, in its order, with the wordings of their numbers.

    Raises
    ------
    InputError
        If a wording refers to something that the ledger does not state as a number.
    """
    sure = {(wording.claim, wording.quantity): wording.sure for wording in wordings}
    found = []
    for claim in ledger:
        for quantity, target, tolerance in claim.targets():
            if isinstance(target, Bound):
                low = -np.inf if target.at_least is None else target.at_least
                high = np.inf if target.at_most is None else target.at_most
                found.append(Statement(claim.id, quantity, low, high, low, high))
            else:
                # A value at the limit must not fail because of rounding.
                assert tolerance is not None  # checked by Claim
                reach = tolerance * (1.0 + 1e-9)
                core = min(sure.pop((claim.id, quantity), tolerance), reach)
                ends = (target - reach, target + reach, target - core, target + core)
                found.append(Statement(claim.id, quantity, *ends))
    for name, quantity in sure:
        raise InputError(f"wordings: the ledger states no number {quantity!r} in claim {name}")
    return found


def columns_of(statement: Statement, columns: Iterable[str]) -> list[str]:
    """Return the columns of a statement: one for each variant, or a single one."""
    return [c for c in columns if c == statement.name or c.startswith(f"{statement.name}|")]


def weights(statement: Statement, measured: Columns) -> np.ndarray:
    """Return how well each sample fits a statement; the worst variant counts.

    Returns
    -------
    ndarray, shape (n_samples,)
        0 to 1; also 0 if the quantity does not exist.
    """
    about = columns_of(statement, measured)
    size = len(next(iter(measured.values())))
    if not about:
        return np.zeros(size)
    return np.min([statement.weight(measured[column]) for column in about], axis=0)


def closeness(statement: Statement, measured: Columns) -> np.ndarray:
    """Return how close each sample comes to a statement: 1 if it fits, less with the distance.

    This ranks samples that do not fit, for which the weights are all 0. Only numbers have a scale
    for the distance, their tolerance; for an order or a shape that fails the result is 0.
    """
    fits = weights(statement, measured) > 0
    about = columns_of(statement, measured)
    if not statement.is_number or not about:
        return fits.astype(float)
    reach = 0.5 * (statement.high - statement.low)
    missed = np.max([np.abs(measured[column] - statement.number) for column in about], axis=0)
    near = np.nan_to_num(1.0 / (1.0 + (missed / max(reach, 1e-12)) ** 2))
    return np.where(fits, 1.0, near)


def weight_of_claims(found: Sequence[Statement], measured: Columns) -> dict[str, np.ndarray]:
    """Return how well each sample fits each claim: the product over its statements."""
    result: dict[str, np.ndarray] = {}
    for statement in found:
        weight = weights(statement, measured)
        result[statement.claim] = result.get(statement.claim, 1.0) * weight
    return result
