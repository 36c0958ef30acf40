"""Nonlinear damping in the mesh of a spur gear pair.

>>> import gearmesh as gm
>>> ds = gm.simulate(gm.paper(), "c-lubricant", nu=0.66)

The names below are the public ones. Each is imported when it is first used, so that commands
which need no solver do not load one.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gearmesh.errors import InputError as InputError
    from gearmesh.interface.runs import simulate as simulate
    from gearmesh.interface.runs import sweep as sweep
    from gearmesh.interface.statements import paper as paper
    from gearmesh.study.loading import load_study as load
    from gearmesh.study.pair import Pair as Pair

__version__ = "0.2.0"

_PUBLIC = {
    "InputError": ("gearmesh.errors", "InputError"),
    "Pair": ("gearmesh.study.pair", "Pair"),
    "load": ("gearmesh.study.loading", "load_study"),
    "paper": ("gearmesh.interface.statements", "paper"),
    "simulate": ("gearmesh.interface.runs", "simulate"),
    "sweep": ("gearmesh.interface.runs", "sweep"),
}

__all__ = ["InputError", "Pair", "load", "paper", "simulate", "sweep"]


def __getattr__(name: str) -> object:
    if name not in _PUBLIC:
        raise AttributeError(f"module 'gearmesh' has no attribute {name!r}")
    module, attribute = _PUBLIC[name]
    value = getattr(import_module(module), attribute)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_PUBLIC})
