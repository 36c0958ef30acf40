"""What is measured on one run: extrema, strobes, spans and, on request, its time course.

Everything here is dimensionless: lengths in static deflections y_st, times in
tau_s = Omega_s t counted from the start of the run, forces in the static mesh force F_st.
"""

from dataclasses import dataclass, field

import numpy as np

NORMAL_MESH, CONTACT_LOSS, INVERSE_MESH = 1, 0, -1
"""Regimes of the mesh: y >= 0, -s < y < 0 and y <= -s."""

MAXIMUM, MINIMUM = 1, -1
"""Kinds of extrema."""


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
        u, u', b, b' at the end of the run (`gearmesh.taylor`), to go on from in a sweep.
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
