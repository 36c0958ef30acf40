"""Nonlinear damping in the mesh of a spur gear pair.

>>> import gearmesh as gm
>>> ds = gm.simulate(gm.paper(), "c-lubricant", nu=0.66)

The names below are the public ones. Each is imported when it is first used, so that commands
which need no solver do not load one.
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gearmesh.errors import InputError, NoOrbit
    from gearmesh.interface.attractors import attractors, basins
    from gearmesh.interface.branches import (
        Branch,
        SpecialCurve,
        SpecialPoint,
        follow,
        follow_special,
    )
    from gearmesh.interface.geometry import Geometry, geometry
    from gearmesh.interface.inspection import read_pitch_chart
    from gearmesh.interface.lyapunov import lyapunov_spectrum
    from gearmesh.interface.orbits import Orbit, find_orbit
    from gearmesh.interface.runs import simulate, sweep
    from gearmesh.interface.spectra import campbell, spectrum
    from gearmesh.interface.statements import paper
    from gearmesh.study.loading import load
    from gearmesh.study.pair import Pair

__version__ = "0.2.0"

__all__ = [
    "Branch",
    "Geometry",
    "InputError",
    "NoOrbit",
    "Orbit",
    "Pair",
    "SpecialCurve",
    "SpecialPoint",
    "attractors",
    "basins",
    "campbell",
    "find_orbit",
    "follow",
    "follow_special",
    "geometry",
    "load",
    "lyapunov_spectrum",
    "paper",
    "read_pitch_chart",
    "simulate",
    "spectrum",
    "sweep",
]

_MODULES = {
    "gearmesh.errors": ("InputError", "NoOrbit"),
    "gearmesh.interface.attractors": ("attractors", "basins"),
    "gearmesh.interface.branches": (
        *("Branch", "SpecialCurve", "SpecialPoint"),
        *("follow", "follow_special"),
    ),
    "gearmesh.interface.inspection": ("read_pitch_chart",),
    "gearmesh.interface.geometry": ("Geometry", "geometry"),
    "gearmesh.interface.lyapunov": ("lyapunov_spectrum",),
    "gearmesh.interface.orbits": ("Orbit", "find_orbit"),
    "gearmesh.interface.runs": ("simulate", "sweep"),
    "gearmesh.interface.spectra": ("campbell", "spectrum"),
    "gearmesh.interface.statements": ("paper",),
    "gearmesh.study.loading": ("load",),
    "gearmesh.study.pair": ("Pair",),
}


def __getattr__(name: str) -> object:
    for module, names in _MODULES.items():
        if name in names:
            # Code that a job uses names its modules itself, and is found by them.
            loaded = importlib.import_module(module)  # noqa: TID251
            value = globals()[name] = getattr(loaded, name)
            return value
    raise AttributeError(f"module 'gearmesh' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
