"""Synthetic papers with known parameters, to test whether the inference finds them.

A synthetic paper states the results of the model at a sample that the inference does not use, with
the accuracy of the real paper. Numbers are rounded to the tolerance of the ledger, orders and
shapes are yes or no, and quantities that do not exist are stated as absent.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gearmesh.identification.estimation.inference import Fit, fit, joint_level, region
from gearmesh.identification.estimation.wording import Columns, Statement, columns_of


def paper(truth: Mapping[str, float], stated: Sequence[Statement]) -> dict[str, Statement | bool]:
    """Write the paper of one sample.

    Parameters
    ----------
    truth : mapping of str to float
        Column -> what the model measures there.
    stated : sequence of Statement
        What the real paper states.

    Returns
    -------
    dict
        Column -> rounded number as a statement; or whether the statement of the real paper about it
        holds. Numbers that do not exist are False, because no statement about them can hold.
    """
    written: dict[str, Statement | bool] = {}
    for statement in stated:
        for column in columns_of(statement, truth):
            value = truth[column]
            if statement.is_number and np.isfinite(value):
                reach = 0.5 * (statement.high - statement.low)
                number = round(value / (2.0 * reach)) * 2.0 * reach
                ends = number - reach, number + reach
                written[column] = Statement(statement.claim, statement.quantity, *ends, *ends)
            elif statement.is_number:
                written[column] = False
            else:
                written[column] = bool(statement.weight(np.array([value]))[0])
    return written


def evidence(
    written: Mapping[str, Statement | bool], stated: Sequence[Statement], measured: Columns
) -> list[np.ndarray]:
    """Return how well samples fit a synthetic paper, column by column."""
    found = []
    for statement in stated:
        for column in columns_of(statement, written):
            says, values = written[column], measured[column]
            if isinstance(says, Statement):
                found.append(says.weight(values))
            elif statement.is_number:
                found.append((~np.isfinite(values)).astype(float))
            else:
                found.append(((statement.weight(values) > 0) == says).astype(float))
    return found


@dataclass(frozen=True)
class Recovery:
    """Result of the inference for one synthetic paper.

    Attributes
    ----------
    inside : dict of str to bool
        Factor -> whether its stated value lies in its region.
    width : dict of str to float
        Factor -> length of its region, as a share of the prior's.
    recovered : bool
        Whether all stated values lie in regions so wide that all together have the probability
        of one.
    found : Fit
        The fit.
    """

    inside: dict[str, bool]
    width: dict[str, float]
    recovered: bool
    found: Fit


def recover(
    truth: Mapping[str, float],
    place: Mapping[str, float],
    stated: Sequence[Statement],
    measured: Columns,
    places: Mapping[str, np.ndarray],
    prior: np.ndarray,
) -> Recovery:
    """Write the paper of a truth, and infer its parameters.

    Parameters
    ----------
    truth : mapping of str to float
        Column -> what the model measures at the truth.
    place : mapping of str to float
        Factor -> place of the truth in the unit cube.
    stated : sequence of Statement
        What the real paper states.
    measured : mapping of str to ndarray, shape (n_samples,)
        Column -> what the model measures at the samples.
    places : mapping of str to ndarray, shape (n_samples,)
        Factor -> places of the samples.
    prior : ndarray, shape (n_samples,)
        Weights that make the samples an even design.
    """
    found = fit(evidence(paper(truth, stated), stated, measured), prior)
    alone = {name: region(places[name], found.weights) for name in place}
    level = joint_level(len(place))
    together = {name: region(places[name], found.weights, level) for name in place}
    return Recovery(
        {name: low <= place[name] <= high for name, (low, high) in alone.items()},
        {name: high - low for name, (low, high) in alone.items()},
        all(low <= place[name] <= high for name, (low, high) in together.items()),
        found,
    )
