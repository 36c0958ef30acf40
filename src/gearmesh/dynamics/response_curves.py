"""Response curves: measures of the runs of one variant against the mesh frequency ν_s.

A `ResponseCurve` integrates runs on demand and keeps their responses. The functions here
scan it and locate its features by refinement: jumps, peaks, onsets, crossings. Lengths are in
static deflections y_st.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from gearmesh.dynamics.refinement import Batch, refine_change, refine_peak, refine_step
from gearmesh.model.problem import Problem
from gearmesh.solvers.response import Response
from gearmesh.solvers.simulation import simulate

SCAN = 0.0025
"""Spacing in ν_s of a scan. Narrower features may be overlooked."""

WIDTH = 1e-4
"""Interval of ν_s to which features are narrowed. A result is accurate to half of it."""

JUMP_WIDTH = 5e-4
"""A step of the scan counts as a jump if an interval of ν_s this wide holds a third of it."""

SMALLEST_JUMP = 0.2
"""Least step of y_max that counts as a jump: a twentieth of the height of Fig. 2."""

VISIBLE_SPREAD = 0.02
"""Spread of extrema above which one curve is seen as several: the width of a line in Fig. 3."""

Measure = Callable[[Response], float]


class FailedRun(LookupError):
    """A run that a feature depends on could not be integrated."""


@dataclass(frozen=True, slots=True)
class Jump:
    """A jump of y_max: where it is, and its signed step."""

    nu: float
    step: float


class ResponseCurve:
    """Responses of one variant against ν_s.

    Parameters
    ----------
    state : callable
        Function from ν_s to the problem of its run.
    tolerance : float
        Local error tolerance of the runs.
    name : str
        Name of the variant, for messages.
    """

    width = WIDTH
    """Interval of ν_s to which a bracket is narrowed."""

    steepest = 3
    """Number of the steepest pieces that are refined where the greatest step is sought."""

    def __init__(self, state: Callable[[float], Problem], tolerance: float, name: str) -> None:
        self._state = state
        self._tolerance = tolerance
        self.name = name
        self._known: dict[float, Response] = {}

    @property
    def runs(self) -> int:
        """Number of runs so far."""
        return len(self._known)

    def at(self, nu: Iterable[float]) -> list[Response]:
        """Return the responses at mesh frequencies ν_s, in their order."""
        wanted = [float(x) for x in nu]
        new = [x for x in dict.fromkeys(wanted) if x not in self._known]
        problems = [self._state(x) for x in new]
        found = simulate(problems, self._tolerance, estimate_errors=False) if problems else []
        self._known.update(zip(new, found, strict=True))
        return [self._known[x] for x in wanted]

    def of(self, measure: Measure) -> Batch:
        """Return a function from mesh frequencies to values, shape (n,).

        The function raises FailedRun, with the name of the run, if a run could not be integrated. A
        feature is therefore never located next to a missing run.
        """

        def values(nu: np.ndarray) -> np.ndarray:
            responses = self.at(nu)
            for x, response in zip(nu, responses, strict=True):
                if response.status != "ok":
                    raise FailedRun(f"the run of {self.name} at nu_s = {x:.10g}: {response.status}")
            return np.array([measure(response) for response in responses])

        return values

    def scan(self, low: float, high: float) -> np.ndarray:
        """Return the mesh frequencies of a scan between two of them."""
        return scan(low, high)


def y_max(response: Response) -> float:
    """Greatest y of the kept revolutions."""
    return response.y_max


def y_min(response: Response) -> float:
    """Least y of the kept revolutions."""
    return response.y_min


def turning_points(response: Response) -> float:
    """Mean number of turning points of y in a mesh period."""
    return response.turning_points_per_period


def contact_loss(response: Response) -> float:
    """Share of the kept time with contact lost."""
    return response.contact_loss_fraction


def extremum_spread(kind: int) -> Measure:
    """Return the measure of how far the maxima (minima) of the mesh periods lie apart.

    Parameters
    ----------
    kind : int
        `gearmesh.solvers.response.MAXIMUM` or `MINIMUM`; the outermost of each period counts.
    """

    def spread(response: Response) -> float:
        chosen = response.extremum_kind == kind
        if not chosen.any():
            return 0.0
        periods = np.floor(response.extremum_time[chosen] / response.period)
        first_of_each = np.flatnonzero(np.diff(periods, prepend=-1.0))
        return float(np.ptp(np.maximum.reduceat(kind * response.extremum_y[chosen], first_of_each)))

    return spread


def scan(low: float, high: float) -> np.ndarray:
    """Return the two ends and the multiples of `SCAN` between them; nothing if the ends cross.

    All scans use the same frequencies, so a run of one scan serves the others.
    """
    if high < low:
        return np.empty(0)
    inside = np.round(np.arange(np.ceil(low / SCAN), np.floor(high / SCAN) + 1) * SCAN, 10)
    return np.unique(np.concatenate([[low], inside[(inside > low) & (inside < high)], [high]]))


def jumps(curve: ResponseCurve, low: float, high: float) -> list[Jump]:
    """Find the jumps of y_max: steps that do not shrink as the interval around them does.

    After a finite number of periods no jump is sharp: in the fifth revolution it is still spread
    over 1e-4 to 3e-4 in ν_s, because a run with an initial condition near the boundary between two
    motions takes long to leave it. A step of the scan therefore counts as a jump if an interval of
    at most `JUMP_WIDTH` still holds a third of it. Of a straight slope such an interval would hold
    at most a fifth.
    """
    places = curve.scan(low, high)
    height = curve.of(y_max)
    steps = np.diff(height(places))
    found = []
    for i in np.flatnonzero(np.abs(steps) >= SMALLEST_JUMP):
        left, right, step = refine_step(height, places[i], places[i + 1], JUMP_WIDTH)
        if abs(step) > abs(steps[i]) / 3:
            left, right, _ = refine_step(height, left, right, curve.width)
            found.append(Jump((left + right) / 2, float(steps[i])))
    return found


def great_rises(found: Iterable[Jump], low: float, high: float) -> list[float]:
    """Return the ν_s at which y_max jumps up by at least half the greatest rise in an interval."""
    rises = [jump for jump in found if low <= jump.nu <= high and jump.step > 0]
    enough = max((jump.step for jump in rises), default=0.0) / 2
    return [jump.nu for jump in rises if jump.step >= enough]


def largest_step(curve: ResponseCurve, low: float, high: float) -> Jump:
    """Return the greatest step of y_max that remains over `WIDTH`, as a measure of continuity."""
    places = curve.scan(low, high)
    height = curve.of(y_max)
    steepest = np.argsort(np.abs(np.diff(height(places))))[-curve.steepest :]
    pieces = [refine_step(height, places[i], places[i + 1], WIDTH) for i in steepest]
    left, right, step = max(pieces, key=lambda piece: abs(piece[2]))
    return Jump((left + right) / 2, abs(step))


def loop_end(curve: ResponseCurve, low: float, high: float) -> float | None:
    """Find the end of the loops: the last ν_s at which four turning points a period become two."""
    places = curve.scan(low, high)
    turning = curve.of(turning_points)

    def has_loops(nu: np.ndarray) -> np.ndarray:
        return turning(nu) > 3.0

    ends = np.flatnonzero(np.diff(has_loops(places).astype(int)) < 0)
    return _changes(has_loops, places, ends[-1:], curve.width)[0] if ends.size else None


def onset(curve: ResponseCurve, spread: Batch, low: float, high: float) -> float | None:
    """Find the ν_s above which the spread of the curve is visible throughout, up to `high`."""
    places = curve.scan(low, high)

    def is_split(nu: np.ndarray) -> np.ndarray:
        return spread(nu) > VISIBLE_SPREAD

    single = np.flatnonzero(~is_split(places))
    if not single.size or single[-1] == places.size - 1:
        return None
    return _changes(is_split, places, single[-1:], curve.width)[0]


def exceedance(
    more: ResponseCurve, less: ResponseCurve, low: float, high: float
) -> list[list[float]]:
    """Find the intervals of ν_s where y_max of the first curve lies above that of the second."""
    places = more.scan(low, high)
    over, under = more.of(y_max), less.of(y_max)

    def exceeds(nu: np.ndarray) -> np.ndarray:
        return over(nu) > under(nu)

    above = exceeds(places)
    ends = [low] if above[0] else []
    ends += _changes(exceeds, places, np.flatnonzero(above[1:] != above[:-1]), more.width)
    ends += [high] if above[-1] else []
    return [list(pair) for pair in zip(ends[::2], ends[1::2], strict=True)]


def _changes(holds: Batch, places: np.ndarray, left: Iterable[int], width: float) -> list[float]:
    """Refine the changes between the frequencies `places[left]` and their right neighbours."""
    return [float(np.mean(refine_change(holds, places[i], places[i + 1], width))) for i in left]


def peak(curve: ResponseCurve, low: float, high: float) -> tuple[float, float]:
    """Locate the greatest y_max between two frequencies; returns ν_s and y_max."""
    places = curve.scan(low, high)
    height = curve.of(y_max)
    best = int(np.argmax(height(places)))
    around = places[max(best - 1, 0)], places[min(best + 1, places.size - 1)]
    return refine_peak(height, *around, curve.width)


def largest_rise(curve: ResponseCurve, low: float, high: float) -> float:
    """Return the greatest rise of y_max between neighbours of a scan; 0 if it falls throughout."""
    return float(np.max(np.diff(curve.of(y_max)(curve.scan(low, high))), initial=0.0))


def relative_difference(one: ResponseCurve, other: ResponseCurve, low: float, high: float) -> float:
    """Return the greatest relative difference of y_max between two curves."""
    places = one.scan(low, high)
    heights = one.of(y_max)(places), other.of(y_max)(places)
    return float(np.max(np.abs(heights[0] - heights[1]) / heights[0]))


def typical_spread(curves: Sequence[ResponseCurve], low: float, high: float) -> float:
    """Return how far curves of y_max lie apart, relative to their mean: the median over ν_s."""
    heights = np.array([curve.of(y_max)(curve.scan(low, high)) for curve in curves])
    return float(np.median(np.ptp(heights, axis=0) / heights.mean(axis=0)))
