"""Read what callers give: variants, mesh frequencies, initial conditions."""

import operator
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager
from importlib.resources import as_file, files
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.errors import InputError
from gearmesh.model.variants import Variant, variant
from gearmesh.study.loading import load_study
from gearmesh.study.pair import Pair
from gearmesh.study.parameters import MOST_SWEPT_SAMPLES
from gearmesh.study.reading import units
from gearmesh.study.reading.schema import shown
from gearmesh.study.speeds import read_nu_or_speed

Start = tuple[object, object]
"""Initial condition: y and dy/dτ_s, each with its unit, or a number of static deflections."""


def paper_file() -> AbstractContextManager[Path]:
    """Return the file of the paper's study, which the package carries, as a context."""
    return as_file(files("gearmesh.reproduction") / "paper.yaml")


def paper() -> Pair:
    """Return the gear pair of the paper.

    Returns
    -------
    Pair
        Its printed, derived and assumed parameters; `Pair.parameters` lists them with reasons.
    """
    with paper_file() as path:
        return load_study(path).pair


def check_pair(pair: object) -> None:
    """Raise InputError if an argument is no gear pair."""
    if not isinstance(pair, Pair):
        raise InputError(f"pair: found {shown(pair)}; allowed is a Pair, such as gearmesh.paper()")


def check_direction(direction: object) -> None:
    """Raise InputError if runs cannot go on from run to run in a direction."""
    if direction is not None and not (isinstance(direction, str) and direction in ("up", "down")):
        raise InputError(f"direction: found {shown(direction)}; allowed are 'up', 'down' and None")


def read_variant(value: str | Variant) -> Variant:
    """Return a variant by its name, as ``"c-lubricant"`` or ``"c-material-5x"``."""
    if isinstance(value, Variant):
        return value
    if not isinstance(value, str):
        raise InputError(
            f"variant: found {shown(value)}; allowed is one name, such as 'c-lubricant' "
            "(gearmesh variants lists all)"
        )
    return variant(value)


def read_variants(values: str | Variant | Iterable[str | Variant]) -> list[Variant]:
    """Return one variant or several."""
    if isinstance(values, str | Variant) or not isinstance(values, Iterable):
        values = [values]
    found = [read_variant(value) for value in values]
    if not found:
        raise InputError("variants: none given; allowed is one name or several")
    if len(set(found)) < len(found):
        raise InputError("variants: a variant occurs twice; allowed is each once")
    return found


def read_frequency(nu: float | str, pair: Pair) -> float:
    """Return a mesh frequency ν_s, also of a speed; raises InputError if the value is neither."""
    value = bare(nu)
    if not isinstance(value, str | Real):
        raise InputError(
            f"nu: found {shown(nu)}; allowed is one frequency ν_s, or a speed as '3000 rpm'"
        )
    try:
        return read_nu_or_speed(value, pair)
    except ValueError as error:
        raise InputError(f"nu: found {shown(value)}; {error}") from None


def read_frequencies(
    nu: float | str | Sequence[float | str] | np.ndarray, pair: Pair
) -> list[float]:
    """Return one mesh frequency or several, without repetition."""
    found = [read_frequency(value, pair) for value in several(nu)]
    if not found:
        raise InputError("nu: none given; allowed is one frequency or several")
    if len(set(found)) < len(found):
        raise InputError("nu: a frequency occurs twice; allowed is each once")
    return found


def several(values: object) -> list[Any]:
    """Return one value or several as a list."""
    return np.atleast_1d(np.asarray(values, object)).tolist()


def bare(value: Any) -> Any:
    """Return a number of NumPy or xarray as one of Python, and anything else as it is."""
    return value.item() if getattr(value, "shape", None) == () else value


def read_whole(name: str, value: Any, low: int, high: int) -> int:
    """Return a whole number; raises InputError if it is none from `low` to `high`."""
    try:
        number = None if isinstance(value, bool) else operator.index(bare(value))
    except TypeError:
        number = None
    if number is None or not low <= number <= high:
        raise InputError(
            f"{name}: found {shown(value)}; allowed is a whole number from {low} to {high}"
        )
    return number


def check_samples(pairs: Sequence[Pair], runs: int) -> None:
    """Raise InputError if `runs` runs of each pair keep more samples than memory should hold."""
    samples = runs * sum(pair.kept_samples for pair in pairs)
    if samples > MOST_SWEPT_SAMPLES:
        raise InputError(
            f"nu: found {runs * len(pairs)} runs, which keep {samples} samples; allowed are at "
            f"most {MOST_SWEPT_SAMPLES}; take fewer runs, revolutions or samples_per_period"
        )


def with_settings(
    pair: Pair, start: Start | None = None, *, allowed: str = "(y, dy/dtau_s)", **settings: object
) -> Pair:
    """Return a pair with the settings that are given, and with an initial condition.

    `allowed` says, for the message, what the caller takes as `start`.
    """
    check_pair(pair)
    changes = {name: value for name, value in settings.items() if value is not None}
    if start is not None:
        if not isinstance(start, tuple | list) or len(start) != 2:
            raise InputError(f"start: found {shown(start)}; allowed is {allowed}")
        displacement, velocity = (_length(value) for value in start)
        changes |= {"initial_displacement": displacement, "initial_velocity": velocity}
        changes |= {"initial_coordinates": [], "initial_rates": []}
    return pair.replace(**changes) if changes else pair


def read_lengths(pair: Pair, name: str, values: object) -> np.ndarray:
    """Return one length or several in static deflections.

    Each has its unit, or is a number of static deflections.
    """
    found = [_read_length(pair, name, value) for value in several(values)]
    if not found:
        raise InputError(f"{name}: none given; allowed is one length or several")
    return np.array(found)


def _read_length(pair: Pair, name: str, value: object) -> float:
    value, y_st = bare(value), pair.static_deflection
    try:
        if isinstance(value, str):
            return units.parse(units.scaled(value, "y_st", y_st, "mm"), "mm") / y_st
        return units.parse(value, "1")
    except ValueError as error:
        raise InputError(f"{name}: found {shown(value)}; {error}") from None


def _length(value: object) -> object:
    """Return a bare number as a number of static deflections."""
    if isinstance(value, int | float | np.number) and not isinstance(value, bool):
        return f"{float(value)!r} y_st"
    return value
