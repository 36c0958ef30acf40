"""The interfaces that curves of orbits need from a motion, whichever solver integrates it."""

from typing import Protocol, Self

import numpy as np

from gearmesh.dynamics.periodic.orbits import TimeCourse
from gearmesh.model.problem import Problem


class Motion(Protocol):
    """The part of a `Shot` that curves and the tests for special points read.

    Compiled code gives these numbers at once, before a `Shot` is made of them.
    """

    @property
    def period(self) -> float:
        """Mesh period T in tau_s."""

    @property
    def periods(self) -> int:
        """Mesh periods of the motion."""

    @property
    def backlash(self) -> float:
        """Constant part of the backlash, s / y_st."""

    @property
    def monodromy(self) -> np.ndarray:
        """The matrix whose eigenvalues are the Floquet multipliers."""

    @property
    def undamped(self) -> bool:
        """Whether no damping of the mesh acts along the orbit."""

    @property
    def extrema(self) -> np.ndarray:
        """Extrema of y, shape (n, 3): time, y, kind (1 or -1)."""

    @property
    def gap_extrema(self) -> np.ndarray:
        """Extrema of y + s(t), as of `extrema`; they touch 0 where the back flanks graze."""

    @property
    def stiffness_jumps(self) -> np.ndarray:
        """Events at which C(t) jumps, with the columns of `reduced.derivatives.variational`."""

    @property
    def y(self) -> float:
        """Relative motion y at the initial phase."""

    @property
    def y_max(self) -> float:
        """Greatest y."""

    @property
    def y_min(self) -> float:
        """Least y."""


class Shot(Motion, Protocol):
    """A motion over whole mesh periods; it is an orbit if its defect is 0.

    `orbits.Orbit` is one of the reduced system, with exact derivatives, and
    `general_orbits.GeneralOrbit` one of the general solver.
    """

    @property
    def problem(self) -> Problem:
        """The gear pair."""

    @property
    def repeats_after(self) -> int:
        """Mesh periods after which the excitation repeats."""

    @property
    def state(self) -> np.ndarray:
        """The k numbers that determine the motion, shape (k,)."""

    @property
    def defect(self) -> np.ndarray:
        """By how much the motion fails to close, shape (k,)."""

    @property
    def gradient(self) -> np.ndarray:
        """Jacobian of the defect in the state, shape (k, k)."""

    @property
    def stretched(self) -> np.ndarray | None:
        """Derivative of the defect with respect to the logarithm of the mesh period, if known."""

    @property
    def multipliers(self) -> np.ndarray:
        """Floquet multipliers, the largest modulus first."""

    @property
    def multiplier_error(self) -> float:
        """Estimated error of the multipliers."""

    @property
    def growth(self) -> float:
        """Logarithm of the greatest growth of a deviation in a mesh period."""

    @property
    def stable(self) -> bool:
        """Whether all multipliers are inside the unit circle and the orbit is not neutral."""

    @property
    def neutral(self) -> bool:
        """Whether no damping of the mesh acts along the orbit and nothing grows."""

    @property
    def v(self) -> float:
        """Velocity y' at the initial phase."""

    @property
    def strobes(self) -> np.ndarray:
        """Stroboscopic points: y and y' at the start of each mesh period, shape (periods, 2)."""

    @property
    def residual(self) -> float:
        """Size of the defect."""

    @property
    def signature(self) -> tuple[int, ...]:
        """Regimes in their order over the period."""

    def time_course(self, samples_per_period: int = 256) -> TimeCourse:
        """Return the time course over the period."""

    def shot(self, problem: Problem, state: np.ndarray, periods: int) -> Self:
        """Return another motion of the same kind; raises NoOrbit if it cannot be integrated."""

    def at_phase(self, phase: float) -> Self:
        """Return the orbit with its state taken at another mesh phase."""
