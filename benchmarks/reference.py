"""The reference solution of a run, and whether its orbit lets solvers be compared at all.

The reference is heyoka's Taylor method at the tolerance of rounding. It is run twice, the second
time with y displaced by `DISPLACEMENT` at the start: the largest difference of any output, divided
by that, is the orbit's amplification. Where it exceeds `SENSITIVE` (chaos, or grazing within the
run), an error says more of the orbit than of the solver; such runs are timed like all others,
but left out of the errors, and listed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.outcome import Outcome, deviation
from benchmarks.peers.heyoka_scalar import solve_accurately
from gearmesh.model.problem import Problem

DISPLACEMENT = 1e-9
SENSITIVE = 1e3


@dataclass(frozen=True, slots=True)
class Reference:
    """Reference outcome of a run.

    Attributes
    ----------
    outcome : Outcome
    amplification : float
        How much a displacement at the start grows until it is largest.
    """

    outcome: Outcome
    amplification: float

    @property
    def sensitive(self) -> bool:
        """Whether the run is left out of the errors."""
        return self.amplification > SENSITIVE


def references(problems: Sequence[Problem]) -> list[Reference]:
    """Solve `problems` to rounding."""
    return [_reference(problem) for problem in problems]


def _reference(problem: Problem) -> Reference:
    outcome = solve_accurately(problem)
    displaced = deviation(solve_accurately(problem, DISPLACEMENT), outcome)
    return Reference(outcome, displaced.error / DISPLACEMENT)
