"""Locate by refinement in nu_s what the paper states as numbers: jumps, ends, onsets, crossings."""

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gearmesh.parameters import Parameters


def locate(
    parameters: "Parameters",
    variants: Collection[str],
    span: tuple[float, float] = (0.6, 1.2),
) -> dict[str, Any]:
    """Locate every threshold that the variants allow.

    Parameters
    ----------
    parameters : Parameters
        The parameters of the study.
    variants : collection of str
        Names of the variants of the study, `c-material-5x` among them where it is in.
    span : tuple of float
        Least and greatest nu_s of the study.

    Returns
    -------
    dict
        Observable -> variant -> value; what `results/datasets/thresholds.json` holds.
    """
    raise NotImplementedError
