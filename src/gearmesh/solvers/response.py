"""What is measured on one run: extrema, strobes, spans and, on request, its time course.

Everything here is dimensionless: lengths in static deflections y_st, times in
tau_s = Omega_s t counted from the start of the run, forces in the static mesh force F_st.
"""

import math
from dataclasses import dataclass, field

import numpy as np

OK, STEP_LIMIT, EXTREMUM_OVERFLOW, NOT_FINITE = range(4)
"""Outcome of a run, as the compiled solvers tell it."""

STATUSES = ("ok", "step_limit", "extremum_overflow", "not_finite")
"""Their names, as `Response.status` tells them."""

LOOSENING = 100.0
"""How much looser the companion run is whose difference estimates the errors."""

SENSITIVE = 1e5
"""An estimated error above this multiple of the tolerance marks a sensitive orbit."""

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
"""Fields of what a compiled solver measures on a run besides its extrema, strobes and samples."""


@dataclass(slots=True)
class Samples:
    """Time course of the kept revolution; every array has shape (n_samples,)."""

    time: np.ndarray
    y: np.ndarray
    v: np.ndarray
    a: np.ndarray
    stiffness: np.ndarray
    modified_stiffness: np.ndarray
    force_dynamic: np.ndarray
    force_friction: np.ndarray
    regime: np.ndarray


def _nothing() -> np.ndarray:
    return np.empty(0)


@dataclass(slots=True)
class Response:
    """Measured response of one run.

    Attributes
    ----------
    status : str
        ``"ok"``, or why the run could not be integrated.
    period : float
        Mesh period T in tau_s.
    extremum_time, extremum_y, extremum_kind : ndarray, shape (n_extrema,)
        Every local extremum of y in the kept revolutions.
    strobe_y, strobe_v : ndarray, shape (n_periods + 1,)
        y and dy/dtau_s at the boundaries of the mesh periods.
    y_max, y_min, y_rms : float
        Largest and least value and root mean square of y over the kept revolutions.
    contact_loss_fraction, inverse_mesh_fraction : float
        Shares of the kept time with -s < y < 0 and with y <= -s.
    n_contact_losses : int
        Number of times that contact is lost in the kept revolutions.
    turning_points_per_period : float
        Mean number of extrema in a kept mesh period.
    y_max_error, y_min_error : float
        Estimated errors of `y_max` and `y_min`.
    final_state : tuple of four float
        u, u', b, b' at the end of the run, to go on from in a sweep.
    sensitive : bool
        Whether the orbit amplifies integration errors (grazing, chaos).
    samples : Samples or None
        The time course, where it was asked for.
    """

    status: str
    period: float
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
    n_contact_losses: int = 0
    turning_points_per_period: float = np.nan
    y_max_error: float = np.nan
    y_min_error: float = np.nan
    final_state: tuple[float, float, float, float] | None = None
    sensitive: bool = False
    samples: Samples | None = None


def assemble(
    summary, companion, strobes, extrema, period, kept_periods, final_state, tolerance, samples
) -> Response:
    """Return the response that a compiled solver has measured.

    Parameters
    ----------
    summary, companion : record with the fields `MEASURED`
        Of the run and of its companion, which may be None.
    strobes : ndarray, shape (n_periods + 1, 2)
    extrema : ndarray of `EXTREMUM`
        Copied: it may be a piece of a workspace, as `strobes` may.
    period : float
        T in tau_s.
    kept_periods : int
        Mesh periods that are measured.
    final_state : tuple of four float
    tolerance : float
        Of the run.
    samples : Samples or None
    """
    if summary["status"] != OK:
        return Response(STATUSES[summary["status"]], period)
    errors = [np.nan, np.nan]
    if companion is not None:
        lost = companion["status"] != OK
        errors = [
            np.inf if lost else abs(float(summary[name] - companion[name]))
            for name in ("y_max", "y_min")
        ]
    duration = kept_periods * period
    return Response(
        status="ok",
        period=period,
        extremum_time=extrema["time"].copy(),
        extremum_y=extrema["y"].copy(),
        extremum_kind=extrema["kind"].copy(),
        strobe_y=strobes[:, 0].copy(),
        strobe_v=strobes[:, 1].copy(),
        y_max=float(summary["y_max"]),
        y_min=float(summary["y_min"]),
        y_rms=math.sqrt(summary["square_integral"] / duration),
        contact_loss_fraction=float(summary["loss_time"]) / duration,
        inverse_mesh_fraction=float(summary["inverse_time"]) / duration,
        n_contact_losses=int(summary["contact_losses"]),
        turning_points_per_period=len(extrema) / kept_periods,
        y_max_error=errors[0],
        y_min_error=errors[1],
        final_state=final_state,
        sensitive=any(error > SENSITIVE * tolerance for error in errors),
        samples=samples,
    )
