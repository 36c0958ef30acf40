"""Basins: the attractor that each of many initial conditions leads to.

The runs of one gear pair at one frequency go on together. A run is over as soon as it is in the
trapping region of a known orbit (`regions`), or in contact for ever (`envelopes`). Orbits are
searched for from the states of runs that are not over. Some runs, the pilots, go first: they find
most attractors, and how shallow contact losses have to be to vanish in the end.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gearmesh.dynamics.attraction.attractors import Attractor
from gearmesh.dynamics.attraction.maps import map_of
from gearmesh.dynamics.attraction.search import Search
from gearmesh.model.problem import Problem

TRANSIENT = 60
"""Revolutions after which a motion that has not settled is classified as it is."""

_BLOCK = 20  # least mesh periods from one check of the runs to the next
_FIRST = 2  # blocks before the first search for orbits
_EVERY = 3  # blocks from one search to the next
_PILOTS = 256
_HEIGHTS = (0.0, 1.0, 2.0, 4.0)
_RATES = (-4.0, -2.0, -0.7, 0.7, 2.0, 4.0)


class Reached(NamedTuple):
    """Which attractor each of several runs reaches.

    Attributes
    ----------
    attractors : list of Attractor
        Orbits in the order of their period and their greatest y, then the other kinds.
    labels : ndarray of int, shape (n,)
        Index of the attractor of each run.
    """

    attractors: list[Attractor]
    labels: np.ndarray


def reached(problem: Problem, states: np.ndarray, transient: int = TRANSIENT) -> Reached:
    """Return which attractors runs of one gear pair at one frequency reach.

    Parameters
    ----------
    problem : Problem
        Its initial state does not matter.
    states : ndarray, shape (n, k)
        State of each run as the Poincaré map takes it: y, y', b, b' in the reduced system.
    transient : int
        Revolutions after which a motion that has not settled is classified as it is.
    """
    search = Search(map_of(problem))
    block = search.moved.block * _steps(search)
    blocks = math.ceil(transient * problem.teeth / block)
    order = np.random.default_rng(0).permutation(len(states))
    pilots, others = order[:_PILOTS], order[_PILOTS:]
    labels = np.empty(len(states), int)
    labels[pilots], margins = _follow(search, states[pilots], blocks)
    if others.size:
        search.learn(labels[pilots], margins)
        labels[others], _ = _follow(search, states[others], blocks)
    ranks = [one.rank for one in search.attractors]
    ordered = sorted(range(len(ranks)), key=ranks.__getitem__)
    return Reached([search.attractors[i] for i in ordered], np.argsort(ordered)[labels])


def _steps(search: Search) -> int:
    """Return the steps of the Poincaré map from one check of the runs to the next."""
    return math.ceil(_BLOCK / search.moved.block)


def _follow(search: Search, states: np.ndarray, blocks: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the attractor of each run, and its highest margin after the first blocks."""
    n, envelope = len(states), search.envelope
    labels, states = np.full(n, -1), states.copy()
    highest, middle = np.full(n, -math.inf), np.full(n, -math.inf)
    runs = np.arange(n)
    for block in range(blocks + 1):
        found = search.captured(states[runs])
        if block % _EVERY == _FIRST and (found < 0).any():
            search.find_orbits(states[runs[found < 0]])
            found = search.captured(states[runs])
        labels[runs] = found
        runs = runs[found < 0]
        if not runs.size or block == blocks:
            break
        if envelope and block >= _FIRST:
            margins = envelope.margins(states[runs])
            highest[runs] = np.maximum(highest[runs], margins)
            if block == blocks // 2:
                middle[runs] = margins
        states[runs] = search.moved.advance(states[runs], _steps(search))
    if runs.size:
        labels[runs] = search.classified(states[runs], middle[runs])
    return labels, highest


def grid(problem: Problem) -> np.ndarray:
    """Return states that reach through the backlash, shape (36, k)."""
    heights = (-problem.backlash - 1.0, -0.5 * problem.backlash, *_HEIGHTS)
    phases = [problem.initial_phase]
    return map_of(problem).starts(np.array(heights), np.array(_RATES), phases)


class Basins(NamedTuple):
    """Which attractor each initial condition leads to.

    Attributes
    ----------
    attractors : list of Attractor
    labels : ndarray of int, shape (phases, heights, velocities)
        Index of the attractor that each initial condition leads to.
    shares : ndarray, shape (n_attractors, 3)
        Share of the initial conditions that lead to each attractor (basin stability), and the ends
        of its 95 % Wilson interval.
    """

    attractors: list[Attractor]
    labels: np.ndarray
    shares: np.ndarray


def basins(
    problem: Problem,
    y: np.ndarray,
    v: np.ndarray,
    phases: Sequence[float] | None = None,
    transient: int = TRANSIENT,
) -> Basins:
    """Return the attractors to which the initial conditions of a grid of y, y' and phase lead.

    Parameters
    ----------
    problem : Problem
    y, v : array_like, shape (heights,) and (velocities,)
        Initial relative motion and its rate; the bodies are in static equilibrium under F_st.
    phases : sequence of float, optional
        Initial phases; that of `problem` if not given.
    transient : int
        Revolutions before the motion is classified.
    """
    phases = [problem.initial_phase] if phases is None else list(phases)
    states = map_of(problem).starts(np.asarray(y), np.asarray(v), phases)
    found = reached(problem, np.concatenate([grid(problem), states]), transient)
    labels = found.labels[-len(states) :]
    counts = np.bincount(labels, minlength=len(found.attractors))
    shares = np.array([wilson_interval(count, len(labels)) for count in counts])
    return Basins(found.attractors, labels.reshape(len(phases), len(y), len(v)), shares)


def wilson_interval(count: int, total: int, deviations: float = 1.959964) -> list[float]:
    """Return the share of `count` in `total`, and its Wilson interval (95 % by default)."""
    share, square = count / total, deviations**2
    middle = (share + 0.5 * square / total) / (1.0 + square / total)
    half = deviations / (1.0 + square / total)
    half *= math.sqrt(share * (1.0 - share) / total + 0.25 * square / total**2)
    return [share, middle - half, middle + half]
