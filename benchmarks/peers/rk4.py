"""Plain RK4 in numba: equal steps, no events.

The coefficients at each stage are those of the phase and the regime found there, so steps walk
over switches and contact changes. What falls between steps is read off the quintic.
"""

from collections.abc import Sequence

import numpy as np
from numba import njit

from benchmarks.outcome import SAMPLES_PER_PERIOD, Outcome
from benchmarks.peers.compiled import (
    accelerate,
    at,
    constants,
    piece_table,
    root,
    set_regime,
    slope,
)
from benchmarks.reduced import initial_state, periods, pieces_of
from gearmesh.model.problem import Problem


def solve(problems: Sequence[Problem], steps_per_period: float) -> list[Outcome]:
    """Solve the runs one after the other, with `steps_per_period` steps a mesh period."""
    outcomes = []
    for problem in problems:
        total, first_kept = periods(problem)
        outputs = _run(
            constants(problem),
            initial_state(problem),
            piece_table(pieces_of(problem)),
            problem.material,
            problem.lubricant,
            problem.backlash,
            problem.period,
            total,
            first_kept,
            int(steps_per_period),
        )
        outcomes.append(Outcome(*outputs))
    return outcomes


@njit
def _derivative(phase, x, p, table, contact, loss, backlash):
    """Return the derivative of the state `x`, a tuple."""
    piece = 0
    while phase >= table[piece, 1] and piece < len(table) - 1:
        piece += 1
    regime = 1 if x[0] >= 0 else (-1 if x[0] <= -backlash else 0)
    set_regime(p, regime, table[piece], contact, loss, backlash)
    acceleration, body_acceleration = accelerate(x, p)
    return x[1], acceleration, x[3], body_acceleration


@njit
def _ahead(x, h, k):
    return x[0] + h * k[0], x[1] + h * k[1], x[2] + h * k[2], x[3] + h * k[3]


@njit
def _run(p, x, table, contact, loss, backlash, length, total, first_kept, n_steps):
    h = length / n_steps
    law = (p, table, contact, loss, backlash)
    strobes = np.empty((total + 1, 2))
    strobes[0] = x[0], x[1]
    samples = np.empty((2, (total - first_kept) * SAMPLES_PER_PERIOD))
    extrema = np.empty((total - first_kept) * n_steps)
    n_extrema = i_sample = 0
    k1 = _derivative(0.0, x, *law)
    for n in range(total):
        for i in range(n_steps):
            left = x[0], x[1], k1[1]
            middle, end = (i + 0.5) / n_steps, ((i + 1) / n_steps) % 1.0
            k2 = _derivative(middle, _ahead(x, h / 2, k1), *law)
            k3 = _derivative(middle, _ahead(x, h / 2, k2), *law)
            k4 = _derivative(end, _ahead(x, h, k3), *law)
            x = _ahead(_ahead(_ahead(_ahead(x, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4)
            k1 = _derivative(end, x, *law)
            if n < first_kept:
                continue
            right = x[0], x[1], k1[1]
            if left[1] * right[1] < 0:
                extrema[n_extrema] = at(root(slope, 0.0, 0.0, 1.0, h, left, right), h, left, right)
                n_extrema += 1
            while i_sample < samples.shape[1]:
                s = (i_sample / SAMPLES_PER_PERIOD - (n - first_kept)) * n_steps - i
                if s >= 1:
                    break
                samples[0, i_sample] = at(s, h, left, right)
                samples[1, i_sample] = slope(s, h, left, right)
                i_sample += 1
        strobes[n + 1] = x[0], x[1]
    return extrema[:n_extrema].copy(), strobes[:, 0], strobes[:, 1], samples[0], samples[1]
