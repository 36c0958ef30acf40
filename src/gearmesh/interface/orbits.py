"""Periodic orbits, with units."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import xarray as xr

from gearmesh.dynamics.periodic import general_search, orbits
from gearmesh.dynamics.periodic.general_orbits import GeneralOrbit
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.dynamics.starts import coordinates
from gearmesh.errors import NoOrbit
from gearmesh.interface.lengths import with_lengths
from gearmesh.interface.statements import (
    Start,
    check_pair,
    read_frequency,
    read_variant,
    read_whole,
    with_settings,
)
from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH
from gearmesh.model.motion import state_at
from gearmesh.model.problem import State
from gearmesh.model.variants import Variant
from gearmesh.solvers.reduced.runs import is_reducible
from gearmesh.study.pair import Pair
from gearmesh.study.speeds import check_constant_speed

REGIMES = {
    NORMAL_MESH: "normal_mesh",
    CONTACT_LOSS: "contact_loss",
    INVERSE_MESH: "inverse_mesh",
}


@dataclass(frozen=True)
class Orbit:
    """A periodic orbit of a gear pair.

    Four properties certify its numbers: `residual`, `extremum_margin`, `least_force` and
    `multiplier_error`.

    Attributes
    ----------
    pair : Pair
    variant : Variant
    nu : float
        Mesh frequency ν_s.
    found : gearmesh.dynamics.periodic.shots.Shot
        The orbit in dimensionless form, of either solver.
    """

    pair: Pair
    variant: Variant
    nu: float
    found: Shot = field(repr=False)

    @property
    def reduced(self) -> orbits.Orbit:
        """The orbit in dimensionless form; raises NoOrbit if it is not of the reduced system."""
        if not isinstance(self.found, orbits.Orbit):
            raise NoOrbit("this needs an orbit of the reduced system, but the pair has other terms")
        return self.found

    @property
    def initial_state(self) -> State:
        """The state at the initial phase, from which a run or another search can start."""
        if isinstance(self.found, GeneralOrbit):
            return self.found.initial_state
        return State(*self.found.state.tolist())

    @property
    def periods(self) -> int:
        """Least period in mesh periods."""
        return self.found.periods

    @property
    def multipliers(self) -> np.ndarray:
        """Floquet multipliers, complex, the largest modulus first: 4 in the reduced system."""
        return self.found.multipliers

    @property
    def stable(self) -> bool:
        """Whether all multipliers are inside the unit circle, and damping acts."""
        return self.found.stable

    @property
    def neutral(self) -> bool:
        """Whether no damping of the mesh acts along the orbit and nothing grows."""
        return self.found.neutral

    @property
    def signature(self) -> tuple[str, ...]:
        """Regimes of the mesh in their order over the orbit's own period."""
        return tuple(REGIMES[regime] for regime in self.found.signature)

    @property
    def holding_moments(self) -> tuple[float, float]:
        """Constant moments that keep an eccentric pair at its speed, in addition to those stated.

        They act on wheels 3 and 2, and are given as shares of M_3 and M_2. They balance the effect
        of friction and damping on the mean rotation, so that a run with them repeats. They are 0 if
        nothing depends on the mean rotation.
        """
        found = self.found
        return found.holding_moments if isinstance(found, GeneralOrbit) else (0.0, 0.0)

    @property
    def residual(self) -> float:
        """Distance between the states at the two ends of one period, in y_st."""
        return self.found.residual

    @property
    def extremum_margin(self) -> float:
        """Least distance of an extremum of y from the ends of its regime, in y_st.

        It is near 0 if the orbit grazes, and negative if an event was missed. An orbit of the
        general solver, which checks its events itself, has not-a-number.
        """
        if isinstance(self.found, GeneralOrbit):
            return float("nan")
        return self.reduced.certificate.extremum_margin

    @property
    def least_force(self) -> float:
        """Least force between flanks that touch, in F_st; infinite if none do.

        If it is negative, the damping law pulls the flanks together.
        """
        if isinstance(self.found, GeneralOrbit):
            return self.found.response.least_contact_force
        return self.reduced.certificate.least_force

    @property
    def multiplier_error(self) -> float:
        """Estimated error of `multipliers`: their change when they are computed with finer steps.

        In the reduced system it includes the error of their product by Liouville's formula.
        """
        return self.found.multiplier_error

    def to_dataset(self, samples_per_period: int = 256) -> xr.Dataset:
        """Return the orbit with its time course over its own period.

        Returns
        -------
        xarray.Dataset
            `y`, `v`, `a` and `regime` over ``time``; `strobe_y` and `strobe_v` (y and dy/dτ_s at
            the initial phase), `y_max`, `y_min`, `stable`, `neutral`, `residual`; `multipliers`.
            Lengths are in mm and, with ``_rel`` appended to the name, in static deflections.

        Notes
        -----
        ``to_netcdf(path, engine="netcdf4", auto_complex=True)`` writes the complex `multipliers`,
        and ``xarray.open_dataset`` reads them with the same two arguments.
        """
        pair = self.pair.replace(samples_per_period=samples_per_period)
        course = self.found.time_course(pair.samples_per_period)
        lengths: dict[str, tuple[tuple[str, ...], Any, str]] = {
            "y": (("time",), course.y, "relative motion in the mesh"),
            "v": (("time",), course.v, "relative velocity dy/dtau_s (tau_s = Omega_s t)"),
            "a": (("time",), course.a, "relative acceleration d2y/dtau_s2"),
            "strobe_y": ((), self.found.y, "relative motion y at the initial phase"),
            "strobe_v": ((), self.found.v, "relative velocity dy/dtau_s at the initial phase"),
            "y_max": ((), self.found.y_max, "maximum of y"),
            "y_min": ((), self.found.y_min, "minimum of y"),
        }
        dataset = with_lengths(lengths, self.pair.static_deflection)
        time = course.time / self.pair.natural_frequency
        dataset = dataset.assign_coords(time=("time", time, {"units": "s", "long_name": "time"}))
        flags = {
            "units": "1",
            "long_name": "regime of the mesh",
            "flag_values": np.array(list(REGIMES), np.int8),
            "flag_meanings": " ".join(REGIMES.values()),
        }
        dataset["regime"] = ("time", course.regime, flags)
        for name, value, what in (
            ("stable", self.stable, "whether the orbit is stable"),
            ("neutral", self.neutral, "whether no damping acts along the orbit"),
            ("residual", self.residual, "distance from its start after one period, in y_st"),
            ("periods", self.periods, "least period in mesh periods"),
        ):
            dataset[name] = ((), value, {"units": "1", "long_name": what})
        stated = {"units": "1", "long_name": "Floquet multipliers"}
        dataset["multipliers"] = ("multiplier", self.multipliers, stated)
        dataset.attrs = {
            "variant": self.variant.name,
            "nu_s": self.nu,
            "signature": " ".join(self.signature),
            "parameters": self.pair.canonical(),
        }
        return dataset


def find_orbit(
    pair: Pair,
    variant: str | Variant,
    nu: float | str,
    *,
    periods: int = 1,
    start: Start | Orbit | None = None,
) -> Orbit:
    """Find a periodic orbit.

    Parameters
    ----------
    pair : Pair
        The gear pair. If eccentric wheels would drift from the stated speed, the orbit is that of
        a drive that holds the speed; see `Orbit.holding_moments`.
    variant : str or Variant
        Which damping terms act where.
    nu : float or str
        Mesh frequency ν_s, or the speed of wheel 3, as ``"3000 rpm"``.
    periods : int
        Least period of the orbit, in mesh periods. If single teeth differ or wheels are eccentric,
        it must be a multiple of the number of mesh periods after which the excitation repeats.
    start : tuple or Orbit, optional
        (y, dy/dτ_s) at the initial phase near the orbit, each with its unit or as a number of
        static deflections; or an orbit nearby. By default several initial conditions are tried;
        with terms that only the general solver knows, the end of a long run from rest.

    Returns
    -------
    Orbit

    Raises
    ------
    NoOrbit
        If none is found; the message gives the reason.
    InputError
        One line, if an argument is wrong.

    Examples
    --------
    >>> import gearmesh as gm
    >>> orbit = gm.find_orbit(gm.paper(), "c-material", 0.7)
    >>> orbit.stable
    True
    """
    check_pair(pair)
    periods = read_whole("periods", periods, 1, 1000)
    chosen, frequency = read_variant(variant), read_frequency(nu, pair)
    check_constant_speed(pair, "an orbit")
    problem = pair.problem(chosen, frequency)
    begun = None
    if isinstance(start, Orbit):
        begun = start.initial_state
    elif start is not None:
        stated = with_settings(pair, start, allowed="(y, dy/dtau_s), or an orbit")
        begun = stated.problem(chosen, frequency).initial_state or state_at(problem)
    found: Shot
    try:
        if is_reducible(problem):
            state = None if begun is None else coordinates(begun)
            found = orbits.find_orbit(problem, periods, state)
        else:
            found = general_search.find_orbit(replace(problem, initial_state=begun), periods)
    except NoOrbit as error:
        raise NoOrbit(f"no orbit of period {periods} at nu = {frequency:.6g}: {error}") from None
    return Orbit(pair, chosen, frequency, found)
