"""Locate what the paper states as numbers in ν_s: jumps, ends of loops, onsets, crossings.

`locate` returns all of them for a pair. The searches cover the paper's range of ν_s; they do not
depend on the grid of the study. Lengths are in static deflections y_st.
"""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import asdict

import numpy as np

from gearmesh.dynamics import response_curves as curves
from gearmesh.dynamics.refinement import Batch
from gearmesh.dynamics.response_curves import FailedRun, Jump, ResponseCurve
from gearmesh.model.variants import variant
from gearmesh.reproduction.frequencies import FIG_4, FIRST, FIRST_JUMP, LAST
from gearmesh.reproduction.mechanisms.bands import RANGES, band
from gearmesh.solvers.response import MAXIMUM, MINIMUM, Response
from gearmesh.study.pair import Pair

BETWEEN_JUMPS = 0.73
"""Half-way between the paper's jumps, near 0.66 and near 0.8."""

LAST_JUMP = 1.0
"""Upper end of the searches for jumps."""

LOOPS_FROM = 0.5
"""Lower end of the searches for loops. With more damping the loops may end below `FIRST`."""

NONLINEAR = ("c", "d", "h")
"""Letters of the variants with nonlinear damping in Figs. 2 and 3."""

Searches = dict[str, Callable[[], object]]
"""Observable -> the search for it."""


def curve_of(pair: Pair, name: str) -> ResponseCurve:
    """Return the response curve of a variant, such as ``c-lubricant``."""
    chosen = variant(name)
    return ResponseCurve(lambda nu: pair.problem(chosen, nu), pair.tolerance, name)


def locate(pair: Pair, variants: Collection[str]) -> dict[str, dict[str, object]]:
    """Locate every threshold that the variants allow.

    Parameters
    ----------
    pair : Pair
        The pair of the study.
    variants : collection of str
        Names of the variants of the study, such as ``c-material-5x``.

    Returns
    -------
    dict
        Observable -> variant (or group of variants) -> value, ready for JSON. Frequencies are
        ν_s, lengths are in y_st. A threshold that does not exist is None. A threshold whose
        variants are missing is left out. A threshold that depends on a failed run is
        ``{"not_located": reason}``.
    """
    return locate_on({name: curve_of(pair, name) for name in sorted(variants)}, pair)


def locate_on(known: Mapping[str, ResponseCurve], pair: Pair) -> dict[str, dict[str, object]]:
    """Locate every threshold that the given curves allow; they are keyed by variant."""
    found: dict[str, dict[str, object]] = {}

    def note(observable: str, name: str, search: Callable[[], object]) -> None:
        try:
            value = _plain(search())
        except FailedRun as error:
            value = {"not_located": str(error)}
        found.setdefault(observable, {})[name] = value

    def note_all(name: str, searches: Searches) -> None:
        for observable, search in searches.items():
            note(observable, name, search)

    for letter in ("b", *NONLINEAR):
        if (name := f"{letter}-lubricant") in known:
            note_all(name, _lubricant_searches(known[name], pair))
    for name in (f"{letter}-{symbol}" for letter in NONLINEAR for symbol in ("material", "both")):
        if name in known:
            note("largest_step", name, _of(curves.largest_step, known[name], FIRST, LAST))
    for name in ("b-material", "b-both"):
        if name in known:
            note("jumps", name, _of(curves.jumps, known[name], FIRST, LAST))
    for letter in NONLINEAR:
        both = [known.get(f"{letter}-{symbol}") for symbol in ("material", "both")]
        if None not in both:
            search = _of(curves.relative_difference, *both, FIRST, LAST)
            note("material_or_both", letter, search)
    group = [known.get(f"{letter}-lubricant") for letter in NONLINEAR]
    if None not in group:
        note("course_spread", "below", _of(curves.typical_spread, group, FIRST_JUMP, 0.80))
        note("course_spread", "above", _of(curves.typical_spread, group, 0.80, 1.10))
    for name in ("c-material", "c-material-5x"):
        if name in known:
            note_all(name, _loop_searches(known[name], pair))
    both = [known.get(name) for name in ("c-material-5x", "c-material")]
    if None not in both:
        note("exceedance", "c-material-5x", _of(curves.exceedance, *both, FIRST, 0.8))
    return found


def _of(function: Callable[..., object], *arguments: object) -> Callable[[], object]:
    return lambda: function(*arguments)


def _plain(value: object) -> object:
    """Return a value as JSON can hold it; not-a-number becomes None."""
    if isinstance(value, Jump):
        return asdict(value)
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


def strobe_spread(pair: Pair) -> curves.Measure:
    """Return a measure of the spread of the kept stroboscopic points; a periodic motion has 0."""
    kept = pair.kept_revolutions * pair.teeth_3 + 1

    def spread(response: Response) -> float:
        points = response.strobe_y[-kept:], response.strobe_v[-kept:]
        return float(max(np.ptp(coordinate) for coordinate in points))

    return spread


def _lubricant_searches(curve: ResponseCurve, pair: Pair) -> Searches:
    """Return the searches on a curve with lubricant damping (Figs. 2 to 4)."""
    maxima, minima = (curve.of(curves.extremum_spread(kind)) for kind in (MAXIMUM, MINIMUM))
    stroboscopic = curve.of(strobe_spread(pair))

    def rises() -> list[Jump]:
        return curves.jumps(curve, FIRST, LAST_JUMP)

    def first() -> float | None:
        return next(iter(curves.great_rises(rises(), FIRST, BETWEEN_JUMPS)), None)

    def second() -> float | None:
        return next(reversed(curves.great_rises(rises(), BETWEEN_JUMPS, LAST_JUMP)), None)

    def summit() -> tuple[float, float]:
        return curves.peak(curve, second() or BETWEEN_JUMPS, LAST)

    def split() -> float | None:
        return curves.onset(curve, maxima, LAST_JUMP, LAST)

    return {
        "first_jump": first,
        "second_jump": second,
        "peak": lambda: dict(zip(("nu", "y_max"), summit(), strict=True)),
        "lowest": lambda: _least(curve.of(curves.y_min)(curve.scan(FIRST, LAST))),
        "onset_maxima": split,
        "onset_minima": _of(curves.onset, curve, minima, LAST_JUMP, LAST),
        "onset_strobes": _of(curves.onset, curve, stroboscopic, LAST_JUMP, LAST),
        "largest_rise": lambda: curves.largest_rise(curve, summit()[0], split() or LAST),
        "loss_gained": lambda: {
            name: None if nu is None else loss_gained(curve, nu)
            for name, nu in (("first", first()), ("second", second()))
        },
        "maxima_spread": lambda: _spread_below_and_above(curve, maxima),
        "band": lambda: _band(curve, maxima, second()),
        "strobe_spread": lambda: {
            f"{nu:.2f}": spread
            for nu, spread in zip(FIG_4, stroboscopic(np.array(FIG_4)).tolist(), strict=True)
        },
    }


def _spread_below_and_above(curve: ResponseCurve, spread: Batch) -> dict[str, float]:
    """Return the median spread below 0.8, without the jump near 0.66, and above 1.1."""
    below = np.array([nu for nu in curve.scan(FIRST, 0.80) if abs(nu - FIRST_JUMP) > 0.02])
    return {
        "below": float(np.median(spread(below))),
        "above": float(np.median(spread(curve.scan(1.1, LAST)))),
    }


def _band(curve: ResponseCurve, spread: Batch, end: float | None) -> dict[str, float]:
    """Return how orderly the band of extrema is, see `gearmesh.reproduction.mechanisms.bands`."""
    nu = np.concatenate([curve.scan(low, high) for low, high in RANGES])
    high, low = curve.of(curves.y_max)(nu), curve.of(curves.y_min)(nu)
    return band(nu, high, low, spread(nu), np.nan if end is None else end)


def loss_gained(curve: ResponseCurve, jump: float) -> float:
    """Return how much the share of contact loss increases at a jump."""
    loss = curve.of(curves.contact_loss)
    below = curve.scan(jump - 8 * curves.SCAN, jump - curves.SCAN)
    above = curve.scan(jump + curves.SCAN, jump + 8 * curves.SCAN)
    return float(np.median(loss(above)) - np.median(loss(below)))


def _loop_searches(curve: ResponseCurve, pair: Pair) -> Searches:
    """Return the searches for the loops of a curve (Figs. 3 and 5 to 7)."""
    turning = curve.of(curves.turning_points)

    def end() -> float | None:
        return curves.loop_end(curve, LOOPS_FROM, LAST)

    def at_end(measure: Callable[[float], float]) -> Callable[[], float | None]:
        def search() -> float | None:
            nu = end()
            return None if nu is None else measure(nu)

        return search

    return {
        "loop_end": end,
        "loop_place": at_end(lambda nu: loop_place(curve, nu, pair.initial_phase)),
        "turning_points_before": at_end(
            lambda nu: _least(turning(curve.scan(FIRST, nu - curve.width)))
        ),
        "turning_points_beyond": at_end(
            lambda nu: -_least(-turning(curve.scan(nu + curve.width, LAST)))
        ),
    }


def loop_place(curve: ResponseCurve, end: float, initial_phase: float) -> float:
    """Return the phase of the mesh period at which the loop closes, just below its end in ν_s."""

    def phase(response: Response) -> float:
        closest = int(np.argmin(np.abs(np.diff(response.extremum_y))))
        time = response.extremum_time[closest : closest + 2].mean()
        return float((time / response.period + initial_phase) % 1.0)

    return float(curve.of(phase)(np.array([end - curve.width]))[0])


def _least(values: Iterable[float]) -> float:
    """Return the least value; infinity if there is none."""
    return float(np.min(np.asarray(values), initial=np.inf))
