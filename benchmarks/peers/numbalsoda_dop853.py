"""numbalsoda's compiled DOP853, piece by piece between switches, all inside one numba loop.

Each piece is integrated in the regime it begins in, with output on a grid (the samples where
they are kept). Where y leaves the regime between two grid points, the quintic through them
tells when, one short integration and a Newton correction bring the state there, and the rest of
the piece goes on in the new regime. A dip that leaves and returns between two grid points shows
in the quintic's turning point.
"""

from collections.abc import Sequence

import numpy as np
from numba import carray, cfunc, njit
from numbalsoda import dop853, lsoda_sig

from benchmarks.outcome import SAMPLES_PER_PERIOD, Outcome
from benchmarks.peers.compiled import (
    N_CONSTANTS,
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

EARLY_POINTS = 64
"""Grid points a period where no samples are kept: dense enough for the quintic."""

SHALLOW = 3e-8
"""Dips between two grid points less deep than this are let pass: the quintic cannot tell them
from none, and what they change is far less, as they are short too."""

MOST_STEPS = 10_000
MOST_EXTREMA_PER_PERIOD = 64


def solve(problems: Sequence[Problem], tolerance: float) -> list[Outcome]:
    """Solve the runs one after the other."""
    outcomes = []
    for problem in problems:
        total, first_kept = periods(problem)
        outputs = _run(
            _right_hand_side.address,
            constants(problem),
            np.array(initial_state(problem)),
            piece_table(pieces_of(problem)),
            problem.material,
            problem.lubricant,
            problem.backlash,
            problem.period,
            total,
            first_kept,
            tolerance,
        )
        outcomes.append(Outcome(*outputs))
    return outcomes


@cfunc(lsoda_sig)
def _right_hand_side(t, x_pointer, out_pointer, p_pointer):
    x, out, p = (
        carray(x_pointer, (4,)),
        carray(out_pointer, (4,)),
        carray(p_pointer, (N_CONSTANTS,)),
    )
    out[0], out[2] = x[1], x[3]
    out[1], out[3] = accelerate(x, p)


@njit
def _grid(start, end, per_period):
    """Return `start`, the whole multiples of 1/per_period between, and `end` (mesh periods)."""
    first = int(np.floor(start * per_period + 1e-9)) + 1
    last = int(np.ceil(end * per_period - 1e-9)) - 1
    grid = np.empty(max(last - first + 1, 0) + 2)
    grid[0], grid[-1] = start, end
    for i in range(first, last + 1):
        grid[1 + i - first] = i / per_period
    return grid


@njit
def _left(regime, y, backlash):
    """Return the regime that `y` lies in, seen from `regime`."""
    if regime > 0:
        return 1 if y >= 0 else 0
    if regime < 0:
        return -1 if y <= -backlash else 0
    return 1 if y > 0 else (-1 if y < -backlash else 0)


@njit
def _exit(regime, h, left, right, backlash):
    """Return the fraction of the interval at which y leaves the regime, and the next regime."""
    turn = -1.0
    if left[1] * right[1] < 0:
        turn = root(slope, 0.0, 0.0, 1.0, h, left, right)
        y_turn = at(turn, h, left, right)
        following = _left(regime, y_turn, backlash)
        level = 0.0 if regime > 0 or following > 0 else -backlash
        if following != regime and abs(y_turn - level) > SHALLOW:
            return root(at, level, 0.0, turn, h, left, right), following
    following = _left(regime, right[0], backlash)
    if following == regime:
        return 2.0, regime
    level = 0.0 if regime > 0 or following > 0 else -backlash
    return root(at, level, max(turn, 0.0), 1.0, h, left, right), following


@njit
def _follow(address, p, x, times, tolerance):
    """Return the states at `times` (in 1/Ω_s), the first of which is that of `x`.

    The wrapper leaves the last time's state unwritten where the last step ends a rounding short
    of it, so the integration goes on a few roundings more.
    """
    beyond = np.append(times, times[-1] * (1 + 1e-14))
    states, success = dop853(address, x, beyond, p, tolerance, tolerance, MOST_STEPS)
    if not success:
        states[:] = np.nan
    return states[:-1]


@njit
def _land(address, p, x, start, guess, level, tolerance):
    """Bring the state from `start` to the instant near `guess` at which y = level."""
    for _ in range(30):
        reached = _follow(address, p, x, np.array([start, guess]), tolerance)[1]
        delta = -(reached[0] - level) / reached[1]
        # The series below is used this close only; the solver cannot go back behind its start.
        guess = max(guess + delta, start * (1 + 1e-14))
        if abs(delta) < 1e-7:
            break
    acceleration, body_acceleration = accelerate(reached, p)
    reached[0] = level
    reached[1] += acceleration * delta
    reached[2] += reached[3] * delta
    reached[3] += body_acceleration * delta
    return guess, reached


@njit
def _run(address, p, x, table, contact, loss, backlash, length, total, first_kept, tolerance):
    strobes = np.empty((total + 1, 2))
    strobes[0] = x[:2]
    samples = np.empty((2, (total - first_kept) * SAMPLES_PER_PERIOD))
    samples[:, 0] = np.nan
    extrema = np.empty((total - first_kept) * MOST_EXTREMA_PER_PERIOD)
    n_extrema = 0
    regime = 1
    left, right = np.empty(3), np.empty(3)
    for n in range(total):
        kept = n >= first_kept
        per_period = SAMPLES_PER_PERIOD if kept else EARLY_POINTS
        for i_piece in range(len(table)):
            now, end = n + table[i_piece, 0], n + table[i_piece, 1]
            while now < end:
                set_regime(p, regime, table[i_piece], contact, loss, backlash)
                grid = _grid(now, end, per_period)
                states = _follow(address, p, x, grid * length, tolerance)
                now = end
                following = regime
                left[0], left[1] = x[0], x[1]
                left[2] = accelerate(x, p)[0]
                for j in range(1, len(grid)):
                    right[0], right[1] = states[j, 0], states[j, 1]
                    right[2] = accelerate(states[j], p)[0]
                    h = (grid[j] - grid[j - 1]) * length
                    s, following = _exit(regime, h, left, right, backlash)
                    if kept:
                        i = round((grid[j - 1] - first_kept) * SAMPLES_PER_PERIOD)
                        if abs(i / SAMPLES_PER_PERIOD + first_kept - grid[j - 1]) < 1e-12:
                            samples[0, i], samples[1, i] = left[0], left[1]
                        if left[1] * right[1] < 0:
                            turn = root(slope, 0.0, 0.0, 1.0, h, left, right)
                            if turn < s:
                                extrema[n_extrema] = at(turn, h, left, right)
                                n_extrema += 1
                    if following != regime:
                        level = 0.0 if regime > 0 or following > 0 else -backlash
                        start = grid[j - 1] * length
                        before = x if j == 1 else states[j - 1]
                        time, x = _land(address, p, before, start, start + s * h, level, tolerance)
                        now = time / length
                        break
                    left[:] = right
                else:
                    x = states[-1]
                regime = following
        strobes[n + 1] = x[:2]
    return extrema[:n_extrema].copy(), strobes[:, 0], strobes[:, 1], samples[0], samples[1]
