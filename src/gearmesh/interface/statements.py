"""Read what callers give: variants, mesh frequencies, initial conditions."""

from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager
from importlib.resources import as_file, files
from pathlib import Path

import numpy as np

from gearmesh.errors import InputError
from gearmesh.model.variants import Variant, variant
from gearmesh.study.loading import load_study
from gearmesh.study.pair import Pair
from gearmesh.study.reading import units
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


def read_variant(value: str | Variant) -> Variant:
    """Return a variant by its name, as ``"c-lubricant"`` or ``"c-material-5x"``."""
    return value if isinstance(value, Variant) else variant(value)


def read_variants(values: str | Variant | Iterable[str | Variant]) -> list[Variant]:
    """Return one variant or several."""
    if isinstance(values, str | Variant):
        values = [values]
    found = [read_variant(value) for value in values]
    if not found:
        raise InputError("variants: none given; allowed is one name or several")
    return found


def read_frequency(nu: float | str, pair: Pair) -> float:
    """Return a mesh frequency ν_s, also of a speed; raises InputError if the value is neither."""
    try:
        return read_nu_or_speed(nu.item() if isinstance(nu, np.generic) else nu, pair)
    except ValueError as error:
        raise InputError(f"nu: found {nu!r}; {error}") from None


def read_frequencies(
    nu: float | str | Sequence[float | str] | np.ndarray, pair: Pair
) -> list[float]:
    """Return one mesh frequency or several, without repetition."""
    values = [nu] if isinstance(nu, str) else np.atleast_1d(np.asarray(nu)).tolist()
    found = [read_frequency(value, pair) for value in values]
    if not found:
        raise InputError("nu: none given; allowed is one frequency or several")
    if len(set(found)) < len(found):
        raise InputError("nu: a frequency occurs twice; allowed is each once")
    return found


def check_whole(name: str, value: object, low: int, high: int) -> None:
    """Raise InputError if a value is not a whole number from `low` to `high`."""
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InputError(f"{name}: found {value!r}; allowed is a whole number from {low} to {high}")


def with_settings(pair: Pair, start: Start | None = None, **settings: object) -> Pair:
    """Return a pair with the settings that are given, and with an initial condition."""
    changes = {name: value for name, value in settings.items() if value is not None}
    if start is not None:
        if not isinstance(start, tuple | list) or len(start) != 2:
            raise InputError(f"start: found {start!r}; allowed is (y, dy/dtau_s), or a dataset")
        displacement, velocity = (_length(value) for value in start)
        changes |= {"initial_displacement": displacement, "initial_velocity": velocity}
        changes |= {"initial_coordinates": [], "initial_rates": []}
    return pair.replace(**changes) if changes else pair


def read_lengths(pair: Pair, name: str, values: object) -> np.ndarray:
    """Return one length or several in static deflections.

    Each has its unit, or is a number of static deflections.
    """
    several = values if isinstance(values, Iterable) and not isinstance(values, str) else [values]
    found = [_read_length(pair, name, value) for value in several]
    if not found:
        raise InputError(f"{name}: none given; allowed is one length or several")
    return np.array(found)


def _read_length(pair: Pair, name: str, value: object) -> float:
    value = value.item() if isinstance(value, np.generic) else value
    y_st = pair.static_deflection
    try:
        if isinstance(value, str):
            return units.parse(units.scaled(value, "y_st", y_st, "mm"), "mm") / y_st
        return units.parse(value, "1")
    except ValueError as error:
        raise InputError(f"{name}: found {value!r}; {error}") from None


def _length(value: object) -> object:
    """Return a bare number as a number of static deflections."""
    if isinstance(value, int | float | np.number) and not isinstance(value, bool):
        return f"{float(value)!r} y_st"
    return value
