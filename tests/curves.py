"""Response curves that are drawn by hand, for tests of what is sought on them."""

from collections.abc import Callable, Collection, Iterable
from dataclasses import replace

from gearmesh.dynamics.response_curves import ResponseCurve
from gearmesh.solvers.response import Response


class Drawn(ResponseCurve):
    """A curve without runs.

    Parameters
    ----------
    draw : callable
        ν_s to the fields of its response.
    failed : collection of float
        Mesh frequencies whose runs fail.
    """

    def __init__(
        self, draw: Callable[[float], dict[str, object]], failed: Collection[float] = ()
    ) -> None:
        self.name = "c-lubricant"
        self._draw = draw
        self._failed = failed

    def at(self, nu: Iterable[float]) -> list[Response]:
        """Return the responses at mesh frequencies ν_s, in their order."""
        return [
            Response("step_limit", 1.0)
            if x in self._failed
            else replace(Response("ok", 1.0), **self._draw(float(x)))
            for x in nu
        ]


def heights(function: Callable[[float], float], failed: Collection[float] = ()) -> Drawn:
    """Draw a curve of y_max."""
    return Drawn(lambda nu: {"y_max": float(function(nu))}, failed)
