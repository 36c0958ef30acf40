"""Lyapunov exponents of the conservative variant a against ν_s."""

import numpy as np
import xarray as xr

from gearmesh.interface.lyapunov import lyapunov_spectrum
from gearmesh.study.pair import Pair

VARIANT = "a-conservative"
FROM, TO = 0.6, 1.2
PERIODS = 420
"""Mesh periods over which growth is measured: 20 revolutions."""

TRANSIENT = 105
"""Mesh periods before: the paper's five revolutions."""


def exponents(pair: Pair, resolution: int) -> xr.Dataset:
    """Return the exponents of the motion from the start of the study.

    Parameters
    ----------
    pair : Pair
        The gear pair.
    resolution : int
        Number of frequencies.
    """
    nus = np.round(np.linspace(FROM, TO, resolution), 10)
    return lyapunov_spectrum(pair, VARIANT, nus, periods=PERIODS, transient=TRANSIENT)
