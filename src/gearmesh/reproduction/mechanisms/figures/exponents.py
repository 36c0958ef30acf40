"""Lyapunov exponents of the conservative variant a against ν_s."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import WIDTH, styled


@styled
def draw(lyapunov: xr.Dataset) -> Figure:
    """Draw the greatest and the least exponent with their standard errors.

    Parameters
    ----------
    lyapunov : xarray.Dataset
        ``exponents_rel`` and ``errors_rel`` over (nu, exponent).
    """
    figure = Figure(figsize=(WIDTH, 3.0), layout="constrained")
    axes = figure.subplots()
    nu = lyapunov["nu"].values
    exponents, errors = (lyapunov[f"{name}_rel"].values for name in ("exponents", "errors"))
    for column, colour, label in (
        (0, palette.RED, "greatest exponent"),
        (-1, palette.BLUE, "least exponent"),
    ):
        values, width = exponents[:, column], errors[:, column]
        axes.fill_between(nu, values - width, values + width, color=colour, alpha=0.18, lw=0)
        axes.plot(nu, values, color=colour, marker="o", ms=2.2, mew=0, lw=0.7, label=label)
    axes.axhline(0.0, color=palette.GREY, lw=0.6)
    axes.set_xlim(nu[0], nu[-1])
    reach = 1.15 * float(np.nanmax(np.abs(exponents)))
    axes.set_ylim(-reach, reach)
    axes.set_xlabel("mesh frequency $\\nu_s$")
    axes.set_ylabel("Lyapunov exponent in $\\Omega_s$")
    axes.set_title("a ○  conservative")
    figure.legend(loc="outside lower center", ncols=2)
    return figure
