"""The stroboscopic map with SciPy's DOP853 and events; its Jacobian by differences."""

import numpy as np

from benchmarks.peers.compiled import piece_table
from benchmarks.peers.scipy_dop853 import Run
from benchmarks.reduced import pieces_of
from gearmesh.model.problem import Problem

TOLERANCE = 1e-12
STEP = 1e-6
"""Of the differences, in y_st and y_st Omega_s."""


class Stroboscope:
    """The map of one problem."""

    def __init__(self, problem: Problem, tolerance: float = TOLERANCE):
        self.problem, self.tolerance = problem, tolerance
        self.pieces = piece_table(pieces_of(problem))

    def __call__(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the state one mesh period later and the Jacobian."""
        end = self.move(state)
        columns = [(self.move(state + away) - end) / STEP for away in STEP * np.eye(4)]
        return end, np.array(columns).T

    def move(self, state: np.ndarray) -> np.ndarray:
        """Return the state one mesh period later."""
        run, length = Run(self.problem, self.tolerance), self.problem.period
        run.state = np.array(state)
        run.regime = 1 if state[0] >= 0 else (-1 if state[0] <= -self.problem.backlash else 0)
        for piece in self.pieces:
            run.integrate_piece(piece, piece[0] * length, piece[1] * length, None)
        return run.state
