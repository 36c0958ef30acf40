"""The solvers, each set up as its own experts would."""

import importlib
from collections.abc import Callable
from dataclasses import dataclass

Solve = Callable[..., list]
"""``solve(problems, setting) -> list of Outcome``."""

TOLERANCES = tuple(10.0**-k for k in range(6, 14))


@dataclass(frozen=True, slots=True)
class Solver:
    """A solver and how it is measured.

    Attributes
    ----------
    name : str
        In tables and legends.
    module, function : str
        Where its ``solve`` is found.
    setting : str
        What its setting is: a tolerance, or steps a period.
    settings : tuple of float
        For the work-precision diagram, the coarsest first.
    tabled : tuple of float
        Settings to list in the table; empty for the one that reaches the accuracy aimed at.
    slow : bool
        Whether it is measured on fewer frequencies.
    single : bool
        Whether it is made for single cases too.
    """

    name: str
    module: str
    function: str = "solve"
    setting: str = "tolerance"
    settings: tuple[float, ...] = TOLERANCES
    tabled: tuple[float, ...] = ()
    slow: bool = False
    single: bool = True

    def load(self) -> Solve:
        """Import the solver.

        Raises
        ------
        ImportError
            If a package that it needs is not installed.
        """
        return getattr(importlib.import_module(f"benchmarks.peers.{self.module}"), self.function)


OURS = Solver("gearmesh", "ours")
OURS_WITH_LESS = (
    Solver("gearmesh, no samples", "ours", function="solve_without_samples"),
    Solver("gearmesh, as in the pipeline", "ours", function="solve_with_estimates"),
)
"""Other outputs; at the setting of `OURS`."""
PEERS = (
    Solver("heyoka, batches", "heyoka_batch", single=False),
    Solver("heyoka, scalar", "heyoka_scalar"),
    Solver("numbalsoda DOP853", "numbalsoda_dop853"),
    Solver("SciPy DOP853", "scipy_dop853", settings=(1e-6, 1e-8, 1e-10, 1e-12, 1e-13), slow=True),
    Solver(
        "RK4",
        "rk4",
        setting="steps a period",
        settings=(100, 400, 1600, 6400, 20_000),
        tabled=(400, 20_000),
        slow=True,
    ),
)
