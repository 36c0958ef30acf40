"""Which orbit explains a claim: a sentence for each, with the exact ν_s beside the measured one."""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from gearmesh.reproduction.mechanisms.answers import Points
from gearmesh.reproduction.mechanisms.tables import Row


def mechanisms(rows: Sequence[Row], thresholds: Mapping[str, Any]) -> dict[str, str]:
    """Return the mechanism of each claim that an orbit explains, by the claim's id.

    A claim is left out if the study lacks a special point or a threshold that its sentence names.

    Parameters
    ----------
    rows : sequence of dict
        `special_points.json`.
    thresholds : mapping
        `thresholds.json`: what five revolutions make of them.
    """
    found = {}
    for claim, sentence in _SENTENCES.items():
        try:
            found[claim] = sentence(_Numbers(rows, thresholds))
        except LookupError:
            continue
    return found


def of_run(special_points: Path, thresholds: Path) -> dict[str, str]:
    """Return the mechanisms of a run from its files."""
    points, found = (
        json.loads(path.read_text(encoding="utf-8")) for path in (special_points, thresholds)
    )
    return mechanisms(points, found)


class _Numbers:
    """Special points and thresholds as text; raises LookupError for one that is missing."""

    def __init__(self, rows: Sequence[Row], thresholds: Mapping[str, Any]) -> None:
        self._points = Points(rows)
        self._thresholds = thresholds

    def low(self, variant: str, kind: str) -> str:
        """Return the lowest ν_s of a kind of special point."""
        return self._text(self._points.first(variant, kind))

    def high(self, variant: str, kind: str) -> str:
        """Return the highest ν_s of a kind of special point."""
        return self._text(self._points.last(variant, kind))

    def five(self, observable: str, variant: str) -> str:
        """Return the ν_s that five revolutions give."""
        found = self._thresholds[observable][variant]
        if isinstance(found, list):
            found = found[0]["nu"]
        return self._text(found if isinstance(found, float) else math.nan, 4)

    @staticmethod
    def _text(value: float, decimals: int = 6) -> str:
        if not math.isfinite(value):
            raise LookupError
        return f"{value:.{decimals}f}"


def _tongue(n: _Numbers) -> str:
    name = "c-lubricant"
    return (
        f"The orbit in contact flips at {n.low(name, 'flip')} and at {n.high(name, 'flip')}; "
        "between them it is unstable"
    )


def _jumps(n: _Numbers) -> str:
    name = "c-lubricant"
    return (
        f"First jump: the orbit in contact flips at {n.low(name, 'flip')}, and the stable orbit of "
        f"period 2 exists below it too; runs of c-lubricant over five revolutions jump "
        f"at {n.five('first_jump', name)}. Second jump: the resonant orbit exists from its fold at "
        f"{n.low(name, 'fold')} on, the orbit in contact up to its fold at {n.high(name, 'fold')}; "
        f"the start leaves the basin of the latter at {n.five('second_jump', name)}"
    )


def _linear_fold(n: _Numbers) -> str:
    name = "b-material"
    return (
        f"The orbit in contact of b-material ends at a fold at {n.high(name, 'fold')}; runs "
        f"over five revolutions jump at {n.five('jumps', name)}, at the edge of a basin before it"
    )


def _no_fold(n: _Numbers) -> str:
    name = "c-material"
    return (
        f"One stable orbit without a fold: that of c-material loses contact at "
        f"{n.low(name, 'grazing_front')} and regains it at {n.high(name, 'grazing_front')}"
    )


def _onset(n: _Numbers) -> str:
    name = "c-lubricant"
    return (
        f"The resonant orbit grazes at {n.high(name, 'grazing_front')} and is not damped beyond; "
        f"it is damped so weakly before that the transient is still visible from "
        f"{n.five('onset_maxima', name)} on"
    )


def _loops(n: _Numbers) -> str:
    name = "c-material"
    return (
        f"A turning point of the orbit meets the switch of C(t) at {n.low(name, 'switching')}; "
        f"five revolutions give {n.five('loop_end', name)}"
    )


def _loops_with_more_damping(n: _Numbers) -> str:
    more = n.five("loop_end", "c-material-5x")
    return f"{_loops(n)}, and {more} with 5k: the point moves down as the damping grows"


def _contact_loss(n: _Numbers) -> str:
    name = "c-lubricant"
    return (
        f"The orbit of period 2 that begins at {n.high(name, 'flip')} and the resonant orbit that "
        f"begins at {n.low(name, 'fold')} both lose contact"
    )


def _neutral(n: _Numbers) -> str:
    name = "c-lubricant"
    return (
        f"Below the fold at {n.high(name, 'fold')} and beyond the grazing at "
        f"{n.high(name, 'grazing_front')} the orbit in contact is neutral, so what remains of the "
        "transient rings on; between them the resonant orbit is stable"
    )


def _decline(n: _Numbers) -> str:
    name = "c-lubricant"
    return (
        f"The runs follow the resonant orbit, which shrinks steadily from its fold at "
        f"{n.low(name, 'fold')} to its grazing at {n.high(name, 'grazing_front')}"
    )


def _rounded(n: _Numbers) -> str:
    folds = ", ".join(
        f"{name} {n.low(name, 'fold')}" for name in ("c-lubricant", "d-lubricant", "h-lubricant")
    )
    return f"The resonant orbit begins at a fold ({folds}) and has its peak beyond it"


_SENTENCES: dict[str, Callable[[_Numbers], str]] = {
    "P8": _tongue,
    "F2.1": _no_fold,
    "F2.3": _jumps,
    "F2.5": _rounded,
    "F2.7": _linear_fold,
    "F3.1": _onset,
    "F3.2": _loops,
    "F3.3": _contact_loss,
    "F3.4": _neutral,
    "F3.4b": _neutral,
    "F3.5": _contact_loss,
    "F3.6": _decline,
    "F4.1": _neutral,
    "F4.3": _neutral,
    "F5.1": _loops,
    "F5.2": _loops,
    "F6.2": _loops_with_more_damping,
}
