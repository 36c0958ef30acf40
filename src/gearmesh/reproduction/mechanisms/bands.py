"""The bands of extrema with lubricant damping, after 5, 50 and 500 revolutions.

With • the extrema of one revolution fill a band at each ν_s. Its edges are the greatest maximum and
the least minimum. Where the edges change little from one ν_s to the next, a reader of Fig. 3 sees
an orderly band, although no point in it can be followed: in five revolutions the phase of the
ringing turns so fast with ν_s that the extrema of one mesh period change by the width of the band.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from gearmesh.dynamics.response_curves import SCAN, extremum_spread, scan
from gearmesh.interface.lengths import with_lengths
from gearmesh.model.variants import variant
from gearmesh.solvers.response import MAXIMUM, Response
from gearmesh.solvers.simulation import simulate
from gearmesh.study.pair import Pair

VARIANTS = ("c-lubricant", "d-lubricant", "h-lubricant")
REVOLUTIONS = (5, 50, 500)
RANGES = ((0.6, 0.8), (1.1, 1.2))

FOLLOWED_AT = (0.61, 0.63)
"""Ends of the range in which single extrema are followed."""

STEPS = (SCAN, 0.1 * SCAN, 0.01 * SCAN)
"""Steps in ν_s at which they are followed."""


NEAR_FIRST_JUMP = (0.64, 0.68)
"""Range of ν_s around the first jump, which the paper excepts from its orderly curves."""

EDGE_STEP = 0.1
"""Change of an edge of a band, in y_st, up to which it counts as smooth over a step of a scan: a
twentieth of the height of the upper row of Fig. 3."""


def band(
    nu: np.ndarray, high: np.ndarray, low: np.ndarray, spread: np.ndarray, end: float
) -> dict[str, float]:
    """Return how orderly the band of extrema of one variant is in ⟨0.6; 0.8⟩.

    Parameters
    ----------
    nu : ndarray, shape (n,)
        Mesh frequencies of scans of `RANGES`.
    high, low : ndarray, shape (n,)
        Edges of the band, in y_st: the greatest maximum and the least minimum.
    spread : ndarray, shape (n,)
        How far the maxima of the mesh periods lie apart, in y_st.
    end : float
        The second jump; not-a-number if there is none.

    Returns
    -------
    dict
        `below` and `above`: median spread in ⟨0.6; 0.8⟩ without the first jump, and from 1.1 on;
        `lowest`: median of `low` in ⟨0.6; 0.8⟩ without the jumps;
        `smooth`: share of the steps in ν_s over which both edges change by at most `EDGE_STEP`;
        not-a-number if no two of the frequencies are a step apart;
        `growth`: greatest maximum near the first jump over the median elsewhere.
    """
    near = (nu > NEAR_FIRST_JUMP[0]) & (nu < NEAR_FIRST_JUMP[1])
    outside = (nu <= RANGES[0][1]) & ~near
    band = outside & ~(nu >= end)
    neighbours = band[:-1] & band[1:] & (np.diff(nu) < 1.5 * SCAN)
    steps = np.maximum(np.abs(np.diff(high)), np.abs(np.diff(low)))[neighbours]
    return {
        "below": float(np.median(spread[outside])),
        "above": float(np.median(spread[nu >= RANGES[1][0]])),
        "lowest": float(np.median(low[band])),
        "smooth": float((steps <= EDGE_STEP).mean()) if steps.size else np.nan,
        "growth": float(high[near].max() / np.median(high[band])),
    }


def bands(pair: Pair, variants: Sequence[str]) -> xr.Dataset:
    """Return the edges of the bands over (variant, revolutions, nu).

    Returns
    -------
    xarray.Dataset
        `y_max`, `y_min` (mm, and ``_rel`` in static deflections) and `spread_rel`, how far the
        maxima of the mesh periods lie apart; `change_rel` over (variant, step): the median change
        of the n-th maximum of a run from one ν_s to the next, if these are a step apart.
    """
    names = [name for name in VARIANTS if name in variants]
    nus = np.concatenate([scan(low, high) for low, high in RANGES])
    shape = len(names), len(REVOLUTIONS), len(nus), 3
    found = np.reshape(
        [
            _measured(run)
            for name in names
            for revolutions in REVOLUTIONS
            for run in _runs(pair, name, nus, revolutions)
        ],
        shape,
    )
    axes = "variant", "revolutions", "nu"
    dataset = with_lengths(
        {
            "y_max": (axes, found[..., 0], "greatest maximum of y in the last revolution"),
            "y_min": (axes, found[..., 1], "least minimum of y in the last revolution"),
        },
        pair.static_deflection,
    )
    stated = {"units": "1", "long_name": "spread of the maxima, in static deflections y_st"}
    dataset["spread_rel"] = (axes, found[..., 2], stated)
    changes = [[_change(pair, name, step) for step in STEPS] for name in names]
    stated = {"units": "1", "long_name": "median change of a maximum, in static deflections y_st"}
    dataset["change_rel"] = (("variant", "step"), np.reshape(changes, (len(names), -1)), stated)
    return dataset.assign_coords(
        variant=("variant", names, {"long_name": "name of the damping variant"}),
        revolutions=(
            *("revolutions", np.array(REVOLUTIONS, np.int32)),
            {"units": "1", "long_name": "revolutions from the start"},
        ),
        nu=("nu", nus, {"units": "1", "long_name": "mesh frequency nu_s"}),
        step=("step", np.array(STEPS), {"units": "1", "long_name": "step in nu_s"}),
    )


def _runs(pair: Pair, name: str, nus: np.ndarray, revolutions: int) -> list[Response]:
    one = pair.replace(revolutions=revolutions, kept_revolutions=1)
    problems = [one.problem(variant(name), float(nu)) for nu in nus]
    return simulate(problems, pair.tolerance, estimate_errors=False)


def _measured(run: Response) -> tuple[float, float, float]:
    if run.y_max is None or run.y_min is None:
        return np.nan, np.nan, np.nan
    return run.y_max, run.y_min, extremum_spread(MAXIMUM)(run)


def _change(pair: Pair, name: str, step: float) -> float:
    """Return the median change of the n-th maximum of the fifth revolution over a step in ν_s."""
    low, high = FOLLOWED_AT
    nus = np.linspace(low, high, 8)
    runs = _runs(pair, name, np.concatenate([nus, nus + step]), REVOLUTIONS[0])
    maxima = [run.extremum_y[run.extremum_kind == MAXIMUM] for run in runs]
    pairs = zip(maxima[: nus.size], maxima[nus.size :], strict=True)
    shorter = [(one, other, min(one.size, other.size)) for one, other in pairs]
    return float(np.median([np.abs(one[:n] - other[:n]).max() for one, other, n in shorter]))
