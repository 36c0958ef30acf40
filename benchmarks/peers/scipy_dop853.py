"""SciPy's DOP853 with events, piece by piece between switches, the right-hand side compiled.

In each piece y leaving the regime is a terminal event. SciPy sees an event by the change of sign
over a step; a dip inside one shows as a turning point beyond the boundary, or as one before an
end beyond it, and the piece is then integrated again up to there, which brackets the crossing.
"""

from collections.abc import Sequence

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

from benchmarks.outcome import SAMPLES_PER_PERIOD, Outcome
from benchmarks.peers.compiled import (
    accelerate,
    constants,
    piece_table,
    set_regime,
)
from benchmarks.reduced import initial_state, periods, pieces_of
from gearmesh.model.problem import Problem

SHORTEST = 1e-9
"""No turning point this soon after a start counts: it is the one that ended the last part."""


def solve(problems: Sequence[Problem], tolerance: float) -> list[Outcome]:
    """Solve the runs one after the other."""
    return [Run(problem, tolerance).outcome() for problem in problems]


@njit
def _right_hand_side(t, x, p):
    out = np.empty(4)
    out[0], out[2] = x[1], x[3]
    out[1], out[3] = accelerate(x, p)
    return out


def _turning(t, x, p):
    return x[1]


def _boundary(level: float, direction: int):
    def distance(t, x, p):
        return x[0] - level

    distance.terminal, distance.direction = True, direction
    return distance


class Run:
    """One run under way."""

    def __init__(self, problem: Problem, tolerance: float):
        self.tolerance = tolerance
        self.problem = problem
        self.constants = constants(problem)
        self.dampings = (problem.material, problem.lubricant)
        self.state = np.array(initial_state(problem))
        self.regime = 1
        self.extrema = []
        back = -problem.backlash
        self.exits = {
            1: [(_boundary(0.0, -1), 0)],
            0: [(_boundary(0.0, 1), 1), (_boundary(back, -1), -1)],
            -1: [(_boundary(back, 1), 0)],
        }
        self.range = {1: (0.0, np.inf), 0: (back, 0.0), -1: (-np.inf, back)}

    def outcome(self) -> Outcome:
        """Integrate the run and collect its outputs."""
        total, first_kept = periods(self.problem)
        length = self.problem.period
        times = np.arange((total - first_kept) * SAMPLES_PER_PERIOD) / SAMPLES_PER_PERIOD
        times = (first_kept + times) * length
        self.samples = np.full((2, len(times)), np.nan)
        strobes = [self.state[:2]]
        for n in range(total):
            for piece in piece_table(pieces_of(self.problem)):
                start, end = (n + piece[0]) * length, (n + piece[1]) * length
                self.integrate_piece(piece, start, end, times if n >= first_kept else None)
            strobes.append(self.state[:2])
        strobes = np.array(strobes)
        return Outcome(
            np.array(self.extrema), strobes[:, 0], strobes[:, 1], self.samples[0], self.samples[1]
        )

    def integrate_piece(self, piece, time, end, sample_times):
        """Move from `time` to the `end` of a piece of the mesh period, over all contact events."""
        while time < end:
            set_regime(self.constants, self.regime, piece, *self.dampings, self.problem.backlash)
            solution = self._solve(time, end, sample_times is not None)
            if sample_times is not None:
                inside = slice(*np.searchsorted(sample_times, (time, solution.t[-1])))
                if inside.start < inside.stop:
                    self.samples[:, inside] = solution.sol(sample_times[inside])[:2]
                self.extrema += [x[0] for x in solution.y_events[-1]]
            time, self.state = solution.t[-1], solution.y[:, -1]
            for (_, following), crossed in zip(
                self.exits[self.regime], solution.t_events, strict=False
            ):
                if len(crossed):
                    self.regime = following
                    break

    def _solve(self, start, end, dense):
        solution = solve_ivp(
            _right_hand_side,
            (start, end),
            self.state,
            method="DOP853",
            rtol=self.tolerance,
            atol=self.tolerance,
            args=(self.constants,),
            events=[*(event for event, _ in self.exits[self.regime]), _turning],
            dense_output=dense,
        )
        low, high = self.range[self.regime]
        stays = low <= solution.y[0, -1] <= high
        for time, state in zip(solution.t_events[-1], solution.y_events[-1], strict=True):
            in_sight = start + SHORTEST < time < solution.t[-1]
            if in_sight and not (stays and low <= state[0] <= high):
                return self._solve(start, time, dense)
        return solution
