"""Names of runs in legends and tables, which state the parameters that differ between two runs."""

import json
from collections.abc import Sequence
from typing import Any

import xarray as xr

from gearmesh.study.pair import Pair

_SHOWN = 2  # parameters in a name; a table lists all


def differing(first: xr.Dataset, second: xr.Dataset) -> dict[str, tuple[Any, Any]]:
    """Return variant, frequency and parameters in which two runs differ, with both values."""
    one, other = (
        {"variant": run.attrs["variant"], "nu_s": run.attrs["nu_s"]}
        | json.loads(run.attrs["parameters"])
        for run in (first, second)
    )
    return {name: (one[name], other.get(name)) for name in one if one[name] != other.get(name)}


def suffixes(runs: Sequence[xr.Dataset]) -> list[str]:
    """Return the text that follows the variant and the frequency of each run in a legend.

    It is empty for a single run. Of two runs it names the parameters in which they differ.
    """
    if len(runs) == 1:
        return [""]
    found = differing(*runs)
    names = [name for name in found if name not in ("variant", "nu_s")]
    more = _more(len(names) - _SHOWN)
    return [
        "".join(f", {name} = {_text(name, found[name][i])}" for name in names[:_SHOWN]) + more
        for i in range(2)
    ]


def _more(count: int) -> str:
    if count < 1:
        return ""
    return f", and {count} more {'differs' if count == 1 else 'differ'}"


def _text(name: str, value: Any) -> str:
    unit = Pair.declarations()[name]["unit"]
    number = f"{value:.6g}" if isinstance(value, float) else str(value)
    return number if unit == "1" else f"{number} {unit.replace('*', ' ')}"
