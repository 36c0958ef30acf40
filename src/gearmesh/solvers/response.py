"""What is measured on one run: extrema, stroboscopic points, shares and the time course.

Everything here is dimensionless: lengths in static deflections y_st, times in
tau_s = Omega_s t counted from the start of the run, forces in the static mesh force F_st.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from gearmesh.model.contact import CONTACT_LOSS
from gearmesh.model.problem import Problem, State
from gearmesh.model.speeds import kept_time, mean_period

OK, STEP_LIMIT, DIVERGED, FRICTION_UNDEFINED = range(4)
"""Outcome of a run, as the compiled solvers return it."""

STATUSES = ("ok", "step_limit", "diverged", "friction_undefined")
"""Names of the statuses, as `Response.status` holds them.

``step_limit``: the run needs too many steps, because a rate of the problem is too high.
``diverged``: y is far larger than every length of the problem.
``friction_undefined``: no sign of eq. (6) lasts (see `gearmesh.model.friction`).
"""

LOOSENING = 100.0
"""How much looser the companion run is whose difference estimates the errors."""

SENSITIVE = 1e5
"""A difference above this multiple of the tolerance marks a sensitive orbit."""

MAXIMUM, MINIMUM = 1, -1
"""Kinds of extrema."""


EXTREMUM = np.dtype([("time", np.float64), ("y", np.float64), ("kind", np.int8)])
"""An extremum of y in the kept revolutions; `time` in tau_s from the start of the run."""

MEASURED = [
    ("status", np.int64),
    ("steps", np.int64),
    ("extrema", np.int64),
    ("contact_losses", np.int64),
    ("y_max", np.float64),
    ("y_min", np.float64),
    ("square_integral", np.float64),
    ("loss_time", np.float64),
    ("inverse_time", np.float64),
]
"""Fields of the summary of a run by a compiled solver."""


@dataclass(slots=True)
class Samples:
    """Time course of the kept revolutions; every array has shape (n_samples,).

    `y`, `v` and `a` are y, dy/dtau_s and d2y/dtau_s2, the stiffnesses are in C_s, the forces in
    F_st, `regime` as in `gearmesh.model.contact`. `force_normal` is the elastic and the damping
    force, and `transmission_error` the sum of R_b phi of both wheels. `force_bearing_3` and
    `force_bearing_2` are the forces of the bodies on their bearings along the mesh line.
    `force_bearing_3_z` and `force_bearing_2_z` act across it, and are None for the reduced system,
    which does not contain them.

    `extremes`, of shape (6, 2), has the least and the greatest value of `force_normal`,
    `transmission_error` and the four bearing forces, in the order of the fields. It is None if the
    solver does not locate them between the samples.
    """

    time: np.ndarray
    y: np.ndarray
    v: np.ndarray
    a: np.ndarray
    stiffness: np.ndarray
    modified_stiffness: np.ndarray
    force_dynamic: np.ndarray
    force_normal: np.ndarray
    force_friction: np.ndarray
    force_bearing_3: np.ndarray
    force_bearing_2: np.ndarray
    transmission_error: np.ndarray
    regime: np.ndarray
    force_bearing_3_z: np.ndarray | None = None
    force_bearing_2_z: np.ndarray | None = None
    extremes: np.ndarray | None = None


def _nothing() -> np.ndarray:
    return np.empty(0)


@dataclass(slots=True)
class Response:
    """Measured response of one run.

    A run with another status than ``"ok"`` has nothing but `status`, `period`, `nu` and `steps`;
    all else is empty, not a number or None. The same holds for what a run without kept revolutions
    does not measure.

    Attributes
    ----------
    status : str
        One of `STATUSES`.
    period : float
        Mesh period T in tau_s; the mean of the kept ones if the speed changes.
    nu : float
        Mesh frequency nu_s, at the start if the speed changes.
    steps : int
        Steps that the integration took.
    extremum_time, extremum_y, extremum_kind : ndarray, shape (n_extrema,)
        Every local extremum of y in the kept revolutions.
    strobe_y, strobe_v : ndarray, shape (n_periods + 1,)
        y and dy/dtau_s at the boundaries of the mesh periods.
    y_max, y_min, y_rms : float
        Largest and least value and root mean square of y over the kept revolutions.
    contact_loss_fraction, inverse_mesh_fraction : float
        Shares of the kept time with -s < y < 0 and with y <= -s.
    n_contact_losses : int or None
        Number of times that contact is lost in the kept revolutions.
    located_contact_force : float
        The least contact force that the solver has located, else NaN; see `least_contact_force`.
    turning_points_per_period : float
        Mean number of extrema in a kept mesh period.
    y_max_error, y_min_error : float
        Estimated errors of `y_max` and `y_min`.
    sensitive : bool or None
        Whether the orbit amplifies integration errors (grazing, chaos): whether a companion run
        differs by more than `SENSITIVE` tolerances in `y_max`, in `y_min` or at any boundary of the
        whole run. None if errors were not estimated.
    rotation_drift : float
        Change of the mean rotation (phi_3 - phi_2)/2 over the run, in rad. Only friction turns it,
        and nothing holds it (`gearmesh.model.friction`). Not a number in the reduced system, which
        does not contain it.
    final_state : State or None
        The state at the end of the run, from which it can be continued.
    samples : Samples or None
        The time course, if it was requested.
    """

    status: str
    period: float
    nu: float = np.nan
    steps: int = 0
    extremum_time: np.ndarray = field(default_factory=_nothing)
    extremum_y: np.ndarray = field(default_factory=_nothing)
    extremum_kind: np.ndarray = field(default_factory=lambda: np.empty(0, np.int8))
    strobe_y: np.ndarray = field(default_factory=_nothing)
    strobe_v: np.ndarray = field(default_factory=_nothing)
    y_max: float = np.nan
    y_min: float = np.nan
    y_rms: float = np.nan
    contact_loss_fraction: float = np.nan
    inverse_mesh_fraction: float = np.nan
    n_contact_losses: int | None = None
    located_contact_force: float = np.nan
    turning_points_per_period: float = np.nan
    y_max_error: float = np.nan
    y_min_error: float = np.nan
    sensitive: bool | None = None
    rotation_drift: float = np.nan
    final_state: State | None = None
    samples: Samples | None = None

    @property
    def least_contact_force(self) -> float:
        """Least force that presses touching flanks in the kept revolutions, in F_st.

        It is negative if they pull, and infinite if they never touch. The general solver locates
        it. For the reduced solver it is taken from the samples, and is NaN if there are none.
        """
        if self.samples is None or not np.isnan(self.located_contact_force):
            return self.located_contact_force
        touching = self.samples.regime != CONTACT_LOSS
        pressing = self.samples.regime[touching] * self.samples.force_normal[touching]
        return float(np.min(pressing, initial=np.inf))


@dataclass(slots=True)
class Companion:
    """Result of a companion run: its summary (`MEASURED`) and its stroboscopic points."""

    summary: Mapping[str, Any]
    strobes: np.ndarray


def assemble(
    problem: Problem,
    summary: Mapping[str, Any],
    strobes: np.ndarray,
    extrema: np.ndarray,
    final_state: State,
    companion: Companion | None,
    tolerance: float,
    samples: Any,
    rotation_drift: float = np.nan,
    located_contact_force: float = np.nan,
) -> Response:
    """Return the response that a compiled solver has measured.

    Parameters
    ----------
    problem : Problem
    summary : record with the fields `MEASURED`
    strobes : ndarray, shape (n_periods + 1, 2)
    extrema : ndarray of `EXTREMUM`
        Copied: it may be a piece of a workspace, as `strobes` may.
    final_state : State
    companion : Companion or None
    tolerance : float
        Of the run.
    samples : Samples or None
    rotation_drift : float
        In rad.
    located_contact_force : float
        In F_st; not a number if the solver does not locate it.
    """
    response = Response(
        STATUSES[summary["status"]], mean_period(problem), problem.nu, int(summary["steps"])
    )
    if summary["status"] != OK:
        return response
    response.strobe_y = strobes[:, 0].copy()
    response.strobe_v = strobes[:, 1].copy()
    response.final_state = final_state
    response.rotation_drift = rotation_drift
    if problem.kept_periods:
        _measure(response, problem, summary, extrema, samples)
        response.located_contact_force = located_contact_force
    if companion is not None:
        _estimate(response, summary, strobes, companion, SENSITIVE * tolerance)
    return response


def _measure(
    response: Response,
    problem: Problem,
    summary: Mapping[str, Any],
    extrema: np.ndarray,
    samples: Any,
) -> None:
    """Write the quantities that are measured on the kept revolutions."""
    duration = kept_time(problem)
    response.extremum_time = extrema["time"].copy()
    response.extremum_y = extrema["y"].copy()
    response.extremum_kind = extrema["kind"].copy()
    response.y_max = float(summary["y_max"])
    response.y_min = float(summary["y_min"])
    response.y_rms = math.sqrt(summary["square_integral"] / duration)
    response.contact_loss_fraction = float(summary["loss_time"]) / duration
    response.inverse_mesh_fraction = float(summary["inverse_time"]) / duration
    response.n_contact_losses = int(summary["contact_losses"])
    response.turning_points_per_period = len(extrema) / problem.kept_periods
    response.samples = samples


def _estimate(
    response: Response,
    summary: Mapping[str, Any],
    strobes: np.ndarray,
    companion: Companion,
    bound: float,
) -> None:
    """Write the errors that are estimated from the companion run."""
    if companion.summary["status"] != OK:
        response.y_max_error = response.y_min_error = np.inf
        response.sensitive = True
        return
    errors = [abs(float(summary[name] - companion.summary[name])) for name in ("y_max", "y_min")]
    if response.n_contact_losses is not None:
        response.y_max_error, response.y_min_error = errors
    # Runs that have separated may have equal extremes by chance, and may come together again.
    apart = float(np.abs(strobes - companion.strobes).max())
    response.sensitive = max(*errors, apart) > bound
