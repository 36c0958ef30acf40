"""The long-run motion of many cases, each with its own laws and its own start."""

import math
import operator
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from gearmesh.dynamics.attraction.attractors import MOST_PERIODS, Attractor, returns_after
from gearmesh.dynamics.attraction.envelopes import RISE, Envelope, envelope_of
from gearmesh.dynamics.attraction.irregular import irregular_kinds
from gearmesh.dynamics.attraction.kinds import LOST, MOVING, NEUTRAL, PERIODIC
from gearmesh.dynamics.attraction.maps import WEIGHTS, ReducedMap
from gearmesh.dynamics.periodic.orbits import Orbit, correct, newton_correction
from gearmesh.dynamics.starts import initial_coordinates
from gearmesh.errors import NoOrbit
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.derivatives.period_map import passage
from gearmesh.solvers.reduced.ensembles import advance, laws_of, trace

CHECKED_AFTER = (105, 210, 420, 840, 1260)
"""Mesh periods after which motions are compared with orbits."""

SETTLED = 1e-3
"""Distance from an orbit, in y_st, within which a motion has settled on it."""

_CHUNK = 512  # cases at a time; it bounds the memory
_NEAR = 0.05  # distance after n periods, in y_st, of a motion that may approach an orbit
_REACH = 0.1  # first correction, in y_st, of a motion that Newton's method may bring to an orbit


class LongRun(NamedTuple):
    """Where a run ends.

    Attributes
    ----------
    attractor : Attractor
        ``"moving"`` if the run still approaches its attractor after the last check; its
        `time_constant` is then that of the approach, if it is known.
    settled : int or None
        Mesh periods from the start until the stroboscopic point (y, y') stays within `SETTLED` of
        the orbit, or until contact is certain not to be lost again. None if it does not settle.
    orbit : Orbit or None
        The stable orbit on which the run is, or which it approaches.
    """

    attractor: Attractor
    settled: int | None
    orbit: Orbit | None = None


@dataclass(slots=True)
class _Run:
    """A run that is followed, and the stable orbits that runs of its gear pair have led to."""

    problem: Problem
    envelope: Envelope | None
    known: list[Orbit]
    margin: float = -math.inf
    strobes: list[np.ndarray] = field(default_factory=list)


def classify(problems: Sequence[Problem]) -> list[LongRun]:
    """Return the long-run motion of runs, and how long each takes to settle.

    Parameters
    ----------
    problems : sequence of Problem
        Without run-out, profile deviation and Fourier stiffness. Their revolutions do not matter.

    Returns
    -------
    list of LongRun
        In the order of `problems`.
    """
    found: list[LongRun] = []
    for first in range(0, len(problems), _CHUNK):
        found += _classify(problems[first : first + _CHUNK])
    return found


def _classify(problems: Sequence[Problem]) -> list[LongRun]:
    known: defaultdict[Problem, list[Orbit]] = defaultdict(list)
    runs = [
        _Run(problem, envelope_of(problem), known[replace(problem, initial_state=None)])
        for problem in problems
    ]
    laws = laws_of(problems)
    states = np.array([initial_coordinates(problem) for problem in problems])
    found: dict[int, LongRun] = {}
    open_ = list(range(len(runs)))
    for before, after in pairwise((0, *CHECKED_AFTER)):
        last = after == CHECKED_AFTER[-1]
        ends, strobes = trace(laws[open_], states[open_], after - before)
        begun = states[open_]
        states[open_] = ends
        for i, points, end in zip(open_, strobes, ends, strict=True):
            runs[i].strobes.append(points[1:] if before else points)
            ending = _ending(runs[i], end, last)
            if ending:
                found[i] = ending
        contact = [
            k for k, i in enumerate(open_) if i in found and found[i].attractor.kind == NEUTRAL
        ]
        envelopes = [envelope for k in contact if (envelope := runs[open_[k]].envelope)]
        counts = _last_loss(laws[open_][contact], begun[contact], envelopes, after - before)
        for k, count in zip(contact, counts.tolist(), strict=True):
            found[open_[k]] = found[open_[k]]._replace(settled=before + count)
        open_ = [i for i in open_ if i not in found]
        if not open_:
            break
    if open_:
        kinds, rates = irregular_kinds(ReducedMap([problems[i] for i in open_]), states[open_])
        for i, kind, rate in zip(open_, kinds, rates.tolist(), strict=True):
            found[i] = LongRun(Attractor(kind, exponent=rate), 0 if kind == NEUTRAL else None)
    return [found[i] for i in range(len(runs))]


def _ending(run: _Run, end: np.ndarray, last: bool) -> LongRun | None:
    """Return where a run ends if that shows at this check."""
    if np.isnan(end[0]):
        return LongRun(Attractor(LOST), None)
    before = run.margin
    if run.envelope:
        run.margin = float(run.envelope.margins(end[None])[0])
        if run.margin > 0.0:
            return LongRun(_in_contact(run, run.envelope, NEUTRAL), None)
    strobes, near = np.concatenate(run.strobes), []
    for orbit in _candidates(run, strobes, end):
        away = np.abs((orbit.points - end) * WEIGHTS).max(axis=1)
        if away.min() < SETTLED:
            settled = _settled(strobes, orbit.points, int(away.argmin()))
            return LongRun(Attractor.of(orbit), settled, orbit)
        near += [(float(away.min()), orbit)] if away.min() < _NEAR else []
    if last and run.envelope and any(run.problem.lubricant) and run.margin > RISE * before:
        return LongRun(_in_contact(run, run.envelope, MOVING), None)
    if last and near:
        _, orbit = min(near, key=operator.itemgetter(0))
        slow = Attractor.of(orbit)
        moving = Attractor(MOVING, exponent=slow.exponent, time_constant=slow.time_constant)
        return LongRun(moving, None, orbit)
    return None


def _in_contact(run: _Run, envelope: Envelope, kind: str) -> Attractor:
    """Return the attractor of a motion whose contact losses vanish, or have vanished."""
    constant = envelope.time_constant
    return Attractor(kind, exponent=-1.0 / (constant * run.problem.period), time_constant=constant)


def _candidates(run: _Run, strobes: np.ndarray, end: np.ndarray) -> Iterator[Orbit]:
    """Yield the stable orbits that a run may approach: those known before, and a new one."""
    yield from run.known
    back = np.abs(strobes[-2 : -2 - MOST_PERIODS : -1] - strobes[-1]).max(axis=1)
    if not back.min() < _NEAR:
        return
    periods = returns_after(back)
    moved = passage(run.problem, end, periods)
    if not np.abs(newton_correction(moved, end) * WEIGHTS).max() < _REACH:
        return
    try:
        orbit = correct(run.problem, end, periods)
    except NoOrbit:
        return
    found = Attractor(PERIODIC, orbit)
    if orbit.stable and not any(found.same_as(Attractor(PERIODIC, one)) for one in run.known):
        run.known.append(orbit)
        yield orbit


def _settled(strobes: np.ndarray, points: np.ndarray, at_end: int) -> int:
    """Return the period after which stroboscopic points stay near those of an orbit."""
    n = len(strobes)
    order = (at_end + np.arange(n) - (n - 1)) % len(points)
    far = np.flatnonzero(np.abs(strobes - points[order, :2]).max(axis=1) >= SETTLED)
    return int(far[-1]) + 1 if far.size else 0


def _last_loss(
    laws: np.ndarray, states: np.ndarray, envelopes: Sequence[Envelope], periods: int
) -> np.ndarray:
    """Return after how many of the last periods each motion is above its envelope for ever."""
    n = len(states)
    low, high = np.full(n, -1), np.full(n, periods)
    while (high - low > 1).any():
        middle = (low + high + 1) // 2
        there = states.copy()
        moving = middle > 0
        there[moving] = advance(laws[moving], states[moving], middle[moving])
        above = np.array(
            [one.margins(state[None])[0] > 0.0 for one, state in zip(envelopes, there, strict=True)]
        )
        high, low = np.where(above, middle, high), np.where(above, low, middle)
    return high
