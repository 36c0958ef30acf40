"""Read measured deviations of gear teeth from an inspection chart."""

import csv
import itertools
from os import PathLike
from pathlib import Path

from gearmesh.errors import InputError
from gearmesh.study.reading.schema import shown

_COLUMNS = ("F_p", "f_p")


def read_pitch_chart(path: str | Path, unit: str = "um") -> list[str]:
    """Return the pitch errors of a wheel, as ``pair.replace(pitch_errors=…)`` takes them.

    Parameters
    ----------
    path : str or Path
        CSV file with one line for each tooth, in the order of the teeth. The first line names the
        columns. One of two columns is read (ISO 1328-1). ``F_p`` is the index deviation of each
        tooth. ``f_p`` is the deviation of the single pitch before the tooth; these deviations are
        added up from tooth to tooth. Both are positive if a flank stands out towards its mate.
    unit : str
        Unit of the column.

    Returns
    -------
    list of str
        Deviation of each tooth from its ideal place, with its unit. The first line after the names
        of the columns is tooth 0.

    Raises
    ------
    InputError
        One line: which file and line, what was found, what is allowed.
    """
    if not isinstance(path, str | PathLike):
        raise InputError(f"path: found {shown(path)}; allowed is the name of a file")
    try:
        with Path(path).open(newline="", encoding="utf-8-sig") as file:
            table = csv.DictReader(file, skipinitialspace=True)
            names = table.fieldnames or []
            rows = [(table.line_num, row) for row in table]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a table in UTF-8"
        raise InputError(f"{path}: cannot be read: {reason}") from None
    named = [name for name in _COLUMNS if rows and name in names]
    if len(named) != 1:
        found = ", ".join(names) if rows else "no teeth"
        raise InputError(f"{path}: found {found}; allowed is one column F_p or f_p")
    values = []
    for line, row in rows:
        text = row[named[0]]
        try:
            values.append(float(text))
        except (TypeError, ValueError):
            raise InputError(f"{path}: line {line}: found {text!r}; allowed is a number") from None
    if named == ["f_p"]:
        # The pitches add up to a full turn, so the mean of their deviations must be 0.
        mean = sum(values) / len(values)
        values = list(itertools.accumulate(value - mean for value in values))
    return [f"{value!r} {unit}" for value in values]
