"""Where the value of a parameter comes from."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from gearmesh.errors import InputError
from gearmesh.study.reading.schema import nearest, shown

PRINTED, DERIVED, ASSUMED = "printed", "derived", "assumed"
STATED, DEFAULT, SETTING = "stated", "default", "setting"

GIVEN_KINDS = (PRINTED, DERIVED, ASSUMED, STATED)
"""Kinds that a configuration may give: printed in the paper, derived from printed numbers,
assumed where the paper is silent, or stated by a study of one's own."""

_KEYS = ("value", "kind", "reason")


@dataclass(frozen=True, slots=True)
class Statement:
    """A value as stated, with its kind and its reason.

    Attributes
    ----------
    value : object
        As text, number or list, with its unit.
    kind : str
        Where it comes from.
    reason : str
        Why it is so, or where it is printed; may be empty.
    """

    value: Any
    kind: str = STATED
    reason: str = ""


def read_statement(name: str, data: object) -> Statement:
    """Read a bare value, or a mapping with ``value``, ``kind`` and ``reason``.

    Raises
    ------
    InputError
        One line that begins with `name`.
    """
    if not isinstance(data, Mapping):
        return Statement(data)
    for key in data:
        if key not in _KEYS:
            hint = nearest(str(key), _KEYS) or f"; allowed are {', '.join(_KEYS)}"
            raise InputError(f"{name}.{key:.60}: unknown key{hint}")
    if data.get("value") is None:
        raise InputError(f"{name}.value: missing; a mapping states value, kind and reason")
    kind, reason = data.get("kind", STATED), data.get("reason", "")
    if kind not in GIVEN_KINDS:
        allowed = ", ".join(GIVEN_KINDS)
        raise InputError(f"{name}.kind: found {shown(kind)}; allowed are {allowed}")
    if not isinstance(reason, str) or "\n" in reason.strip():
        raise InputError(f"{name}.reason: found {shown(reason)}; allowed is one line")
    if not reason.strip() and kind != STATED:
        raise InputError(f"{name}.reason: missing; kind {kind} needs one line with the reason")
    return Statement(data["value"], kind, reason.strip())
