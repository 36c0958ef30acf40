"""Locate by refinement in nu_s what the paper states as numbers: jumps, ends, onsets, crossings.

`locate` returns all of it for a set of parameters. It looks at the paper's range of nu_s whatever
grid a study has: each observable is a function of `Courses`, the response of one variant against
nu_s, run where it is asked for and remembered. A scan with the spacing `SCAN` brackets what is
looked for, and `gearmesh.dynamics.refinement` narrows the bracket to `WIDTH`; courses of another
make may scan and narrow less closely. Lengths are in static deflections y_st.
"""

from collections.abc import Callable, Collection, Iterable, Mapping

import numpy as np

from gearmesh.dynamics.refinement import Batch, refine_change, refine_peak, refine_step
from gearmesh.model.variants import variant
from gearmesh.solvers.response import MAXIMUM, MINIMUM, Response
from gearmesh.solvers.simulation import simulate
from gearmesh.study.parameters import Parameters

FIRST, LAST = 0.6, 1.2
"""The paper's range of nu_s."""

BETWEEN_JUMPS = 0.73
"""Half-way between the jumps that the paper sees near 0.66 and near 0.8."""

LAST_JUMP = 1.0
"""Above it no jump is looked for."""

LOOPS_FROM = 0.5
"""From here on loops are looked for: those of a more damped course may end below `FIRST`."""

SCAN = 0.0025
"""Spacing in nu_s of the first look; narrower features may be overlooked."""

WIDTH = 1e-4
"""Interval of nu_s to which everything is narrowed: an answer is good to half of it."""

JUMP_WIDTH = 5e-4
"""Interval of nu_s that must hold a third of a step of the scan if it is to count as a jump."""

SMALLEST_JUMP = 0.2
"""Least step of y_max that counts as a jump: a twentieth of the height of Fig. 2."""

VISIBLE_SPREAD = 0.02
"""Spread of extrema from which one course looks like several: the width of a line in Fig. 3."""

STROBED_AT = (0.60, 1.05, 1.20)
"""Tunings of Fig. 4."""

NONLINEAR = ("c", "d", "h")
"""Letters of the variants that Figs. 2 and 3 set beside the linear one."""

Measure = Callable[[Response], float]


class Courses:
    """Responses of one variant, run where they are asked for and remembered.

    Parameters
    ----------
    parameters : Parameters
        The parameters of all runs.
    name : str
        Name of the variant, as ``c-lubricant``.
    """

    width = WIDTH
    """Interval of nu_s to which a bracket is narrowed."""

    steepest = 3
    """How many of the steepest pieces are looked into where the greatest step is sought."""

    def __init__(self, parameters: Parameters, name: str) -> None:
        self._parameters = parameters
        self._variant = variant(name)
        self._known: dict[float, Response] = {}

    @property
    def runs(self) -> int:
        """How many runs it took so far."""
        return len(self._known)

    def at(self, nu: Iterable[float]) -> list[Response]:
        """Return the responses at tunings nu_s, in their order."""
        wanted = [float(x) for x in nu]
        new = [x for x in dict.fromkeys(wanted) if x not in self._known]
        problems = [self._parameters.problem(self._variant, x) for x in new]
        if problems:
            tolerance = self._parameters.solver.tolerance
            found = simulate(problems, tolerance, estimate_errors=False)
            self._known.update(zip(new, found, strict=True))
        return [self._known[x] for x in wanted]

    def of(self, measure: Measure) -> Callable[[np.ndarray], np.ndarray]:
        """Return a function from tunings to values, shape (n,); not-a-number where a run failed."""

        def values(nu: np.ndarray) -> np.ndarray:
            return np.array([measure(r) if r.status == "ok" else np.nan for r in self.at(nu)])

        return values

    def scan(self, low: float, high: float) -> np.ndarray:
        """Return the places of a first look between two tunings."""
        return scan(low, high)

    def strobe_spread(self, response: Response) -> float:
        """How far the stroboscopic points kept in y and y' lie apart: 0 for a steady motion."""
        kept = self._parameters.run.kept_revolutions * self._parameters.printed.teeth + 1
        points = response.strobe_y[-kept:], response.strobe_v[-kept:]
        return float(max(np.ptp(coordinate) for coordinate in points))


def highest(response: Response) -> float:
    """Greatest y of the kept revolution."""
    return response.y_max


def lowest(response: Response) -> float:
    """Least y of the kept revolution."""
    return response.y_min


def turning_points(response: Response) -> float:
    """Mean number of turning points in a mesh period."""
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

    Scans share their places, so that what one has run another finds known.
    """
    if high < low:
        return np.empty(0)
    inside = np.round(np.arange(np.ceil(low / SCAN), np.floor(high / SCAN) + 1) * SCAN, 10)
    return np.unique(np.concatenate([[low], inside[(inside > low) & (inside < high)], [high]]))


def jumps(courses: Courses, low: float, high: float) -> list[dict[str, float]]:
    """Find the jumps of y_max: steps that do not shrink as the interval around them does.

    After finitely many periods no answer is discontinuous to the last digit: in the fifth
    revolution a jump still takes 1e-4 to 3e-4 in nu_s, because motions that start beside the edge
    between two of them take long to leave it. So a step of the scan counts as a jump if an
    interval of `JUMP_WIDTH` at the most still holds a third of it; of a straight slope it would
    hold a fifth at the most.

    Returns
    -------
    list of dict
        ``nu`` and signed ``step`` of each, by ascending nu.
    """
    places = courses.scan(low, high)
    y_max = courses.of(highest)
    steps = np.diff(y_max(places))
    found = []
    for i in np.flatnonzero(np.abs(steps) >= SMALLEST_JUMP):
        left, right, step = refine_step(y_max, places[i], places[i + 1], JUMP_WIDTH)
        if abs(step) > abs(steps[i]) / 3:
            left, right, _ = refine_step(y_max, left, right, courses.width)
            found.append({"nu": (left + right) / 2, "step": float(steps[i])})
    return found


def great_rises(found: list[dict[str, float]], low: float, high: float) -> list[float]:
    """Return where y_max jumps up between two tunings, by half the greatest such rise or more."""
    rises = [jump for jump in found if low <= jump["nu"] <= high and jump["step"] > 0]
    enough = max((jump["step"] for jump in rises), default=0.0) / 2
    return [jump["nu"] for jump in rises if jump["step"] >= enough]


def largest_step(courses: Courses, low: float, high: float) -> dict[str, float]:
    """Measure continuity: the greatest step of y_max that is left over an interval of `WIDTH`."""
    places = courses.scan(low, high)
    y_max = courses.of(highest)
    steepest = np.argsort(np.nan_to_num(np.abs(np.diff(y_max(places)))))[-courses.steepest :]
    pieces = [refine_step(y_max, places[i], places[i + 1], WIDTH) for i in steepest]
    left, right, step = max(pieces, key=lambda piece: abs(piece[2]))
    return {"nu": (left + right) / 2, "step": abs(step)}


def loop_end(courses: Courses, low: float, high: float) -> float | None:
    """Find where the loops end: the last place where four turning points a period become two."""
    places = courses.scan(low, high)
    turning = courses.of(turning_points)

    def has_loops(nu: np.ndarray) -> np.ndarray:
        return turning(nu) > 3.0

    ends = np.flatnonzero(np.diff(has_loops(places).astype(int)) < 0)
    return _changes(has_loops, places, ends[-1:], courses.width)[0] if ends.size else None


def loop_place(courses: Courses, end: float, initial_phase: float) -> float:
    """Return the phase of the mesh period at which the last loop, just below its end, closes."""
    response = courses.at([end - courses.width])[0]
    closest = int(np.argmin(np.abs(np.diff(response.extremum_y))))
    time = response.extremum_time[closest : closest + 2].mean()
    return float((time / response.period + initial_phase) % 1.0)


def onset(courses: Courses, spread: Batch, low: float, high: float) -> float | None:
    """Find from where on a spread of the courses is visible up to `high`."""
    places = courses.scan(low, high)

    def is_split(nu: np.ndarray) -> np.ndarray:
        return spread(nu) > VISIBLE_SPREAD

    single = np.flatnonzero(~is_split(places))
    if not single.size or single[-1] == places.size - 1:
        return None
    return _changes(is_split, places, single[-1:], courses.width)[0]


def exceedance(more: Courses, less: Courses, low: float, high: float) -> list[list[float]]:
    """Find the intervals of nu_s where y_max of the first course lies above that of the second."""
    places = more.scan(low, high)
    over, under = more.of(highest), less.of(highest)

    def exceeds(nu: np.ndarray) -> np.ndarray:
        return over(nu) > under(nu)

    above = exceeds(places)
    ends = [low] if above[0] else []
    ends += _changes(exceeds, places, np.flatnonzero(above[1:] != above[:-1]), more.width)
    ends += [high] if above[-1] else []
    return [list(pair) for pair in zip(ends[::2], ends[1::2], strict=True)]


def _changes(holds: Batch, places: np.ndarray, left: Iterable[int], width: float) -> list[float]:
    """Refine the changes between the scanned places `left` and their right neighbours."""
    return [float(np.mean(refine_change(holds, places[i], places[i + 1], width))) for i in left]


def peak(courses: Courses, low: float, high: float) -> dict[str, float]:
    """Locate the greatest y_max between two tunings."""
    places = courses.scan(low, high)
    y_max = courses.of(highest)
    best = int(np.argmax(np.nan_to_num(y_max(places), nan=-np.inf)))
    around = places[max(best - 1, 0)], places[min(best + 1, places.size - 1)]
    nu, height = refine_peak(y_max, *around, courses.width)
    return {"nu": nu, "y_max": height}


def largest_rise(courses: Courses, low: float, high: float) -> float:
    """Return by how much y_max grows at the most between neighbours of a scan: 0 if it falls."""
    return float(np.nanmax(np.diff(courses.of(highest)(courses.scan(low, high))), initial=0.0))


def relative_difference(one: Courses, other: Courses, low: float, high: float) -> float:
    """Return the greatest relative difference of y_max between two courses."""
    places = one.scan(low, high)
    heights = one.of(highest)(places), other.of(highest)(places)
    return float(np.nanmax(np.abs(heights[0] - heights[1]) / heights[0]))


def loss_gained(courses: Courses, jump: float) -> float:
    """Return by how much the share of contact loss is greater above a jump than below it."""
    loss = courses.of(contact_loss)
    below = courses.scan(jump - 8 * SCAN, jump - SCAN)
    above = courses.scan(jump + SCAN, jump + 8 * SCAN)
    return float(np.nanmedian(loss(above)) - np.nanmedian(loss(below)))


def typical_spread(courses: Iterable[Courses], low: float, high: float) -> float:
    """Return how far courses of y_max lie apart, relative to their mean: the median over nu_s."""
    heights = np.array([c.of(highest)(c.scan(low, high)) for c in courses])
    return float(np.nanmedian(np.ptp(heights, axis=0) / heights.mean(axis=0)))


def locate(parameters: Parameters, variants: Collection[str]) -> dict[str, dict[str, object]]:
    """Locate every threshold that the variants allow.

    Parameters
    ----------
    parameters : Parameters
        The parameters of the study.
    variants : collection of str
        Names of the variants of the study, ``c-material-5x`` among them where it is in.

    Returns
    -------
    dict
        Observable -> variant (or group of variants) -> value, ready for JSON: what
        `results/datasets/thresholds.json` holds. Frequencies are nu_s, lengths in y_st. A
        threshold that does not exist is None; one whose variants are lacking is left out.
    """
    return locate_on({name: Courses(parameters, name) for name in sorted(variants)}, parameters)


def locate_on(known: Mapping[str, Courses], parameters: Parameters) -> dict[str, dict[str, object]]:
    """Locate every threshold that some courses, by the names of their variants, allow."""
    found: dict[str, dict[str, object]] = {}

    def note(observable: str, name: str, value: object) -> None:
        found.setdefault(observable, {})[name] = value

    for letter in ("b", *NONLINEAR):
        if (name := f"{letter}-lubricant") in known:
            for observable, value in _of_lubricant(known[name]).items():
                note(observable, name, value)
    for name in (f"{letter}-{symbol}" for letter in NONLINEAR for symbol in ("material", "both")):
        if name in known:
            note("largest_step", name, largest_step(known[name], FIRST, LAST))
    for name in ("b-material", "b-both"):
        if name in known:
            note("jumps", name, jumps(known[name], FIRST, LAST))
    for letter in NONLINEAR:
        pair = [known.get(f"{letter}-{symbol}") for symbol in ("material", "both")]
        if None not in pair:
            note("material_or_both", letter, relative_difference(*pair, FIRST, LAST))
    group = [known.get(f"{letter}-lubricant") for letter in NONLINEAR]
    if None not in group:
        note("course_spread", "below", typical_spread(group, 0.66, 0.80))
        note("course_spread", "above", typical_spread(group, 0.80, 1.10))
    for name in ("c-material", "c-material-5x"):
        if name in known:
            for observable, value in _of_loops(known[name], parameters).items():
                note(observable, name, value)
    pair = [known.get(name) for name in ("c-material-5x", "c-material")]
    if None not in pair:
        note("exceedance", "c-material-5x", exceedance(*pair, FIRST, 0.8))
    return _plain(found)


def _plain(value: object) -> object:
    """Write what is not a number, where every run failed, as JSON can hold it."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


def _least(values: np.ndarray) -> float:
    """Return the least value, infinity where there is none."""
    return float(np.nanmin(values, initial=np.inf))


def _of_lubricant(courses: Courses) -> dict[str, object]:
    """Return what Figs. 2 to 4 show of a course with damping in contact loss only."""
    found = jumps(courses, FIRST, LAST_JUMP)
    first = next(iter(great_rises(found, FIRST, BETWEEN_JUMPS)), None)
    second = next(reversed(great_rises(found, BETWEEN_JUMPS, LAST_JUMP)), None)
    maxima, minima = (courses.of(extremum_spread(kind)) for kind in (MAXIMUM, MINIMUM))
    summit = peak(courses, second or BETWEEN_JUMPS, LAST)
    strobes = courses.of(courses.strobe_spread)
    split = onset(courses, maxima, LAST_JUMP, LAST)
    orderly = [nu for nu in courses.scan(FIRST, 0.80) if abs(nu - 0.66) > 0.02]
    return {
        "first_jump": first,
        "second_jump": second,
        "peak": summit,
        "lowest": _least(courses.of(lowest)(courses.scan(FIRST, LAST))),
        "onset_maxima": split,
        "onset_minima": onset(courses, minima, LAST_JUMP, LAST),
        "onset_strobes": onset(courses, strobes, LAST_JUMP, LAST),
        "largest_rise": largest_rise(courses, summit["nu"], split or LAST),
        "loss_gained": {
            "first": first and loss_gained(courses, first),
            "second": second and loss_gained(courses, second),
        },
        "maxima_spread": {
            "below": float(np.nanmedian(maxima(orderly))),
            "above": float(np.nanmedian(maxima(courses.scan(1.1, LAST)))),
        },
        "strobe_spread": dict(
            zip((f"{nu:.2f}" for nu in STROBED_AT), strobes(STROBED_AT).tolist(), strict=True)
        ),
    }


def _of_loops(courses: Courses, parameters: Parameters) -> dict[str, object]:
    """Return what Figs. 3 and 5 to 7 show of the loops of a course."""
    end = loop_end(courses, LOOPS_FROM, LAST)
    turning, width = courses.of(turning_points), courses.width
    return {
        "loop_end": end,
        "loop_place": end and loop_place(courses, end, parameters.assumed.initial_phase),
        "turning_points_before": end and _least(turning(courses.scan(FIRST, end - width))),
        "turning_points_beyond": end and -_least(-turning(courses.scan(end + width, LAST))),
    }
