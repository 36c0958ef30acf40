"""How a section of the configuration is declared, and how a mistake in one is reported.

A section is a frozen pydantic model that refuses unknown keys. A field declared with `quantity`
takes text with a unit and holds a float in the unit that the field states.
"""

import difflib
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, ClassVar, NamedTuple, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationError, ValidationInfo, field_validator

from gearmesh.errors import InputError
from gearmesh.study.reading import units

_SHOWN = 60  # characters of a wrong value that a message repeats
_EXPECTED = {
    "model_type": "allowed is a mapping of keys to values",
    "dict_type": "allowed is a mapping of keys to values",
    "tuple_type": "allowed is a list",
    "string_type": "allowed is a text",
    "string_too_short": "allowed is a text that is not empty",
    "string_too_long": "allowed are at most {max_length} characters",
    "literal_error": "allowed is {expected}",
    "too_long": "allowed are at most {max_length} values",
    "bool_type": "allowed is true or false",
    "bool_parsing": "allowed is true or false",
    "float_type": "allowed is a number",
    "int_type": "allowed is a whole number",
    "int_from_float": "allowed is a whole number",
}


def quantity(
    unit: str,
    symbol: str,
    description: str,
    low: float,
    high: float,
    *,
    of_wheels: bool = False,
    may_differ: bool = False,
    structured: bool = False,
    **options: Any,
) -> Any:
    """Declare a quantity that is stored in `unit` and lies between `low` and `high`.

    `of_wheels` declares two values, for wheels 3 and 2; one value serves both. `may_differ`
    declares one value, or two where the wheels differ. A `structured` field is a list of sections,
    or a word. `options` are those of ``pydantic.Field``, such as a default.
    """
    extra: dict[str, Any] = {"unit": unit, "symbol": symbol, "low": low, "high": high}
    extra |= {"of_wheels": of_wheels, "may_differ": may_differ, "structured": structured}
    return Field(description=description, json_schema_extra=extra, **options)


class Section(BaseModel):
    """Base of all sections: frozen, no unknown keys, quantities read with their units."""

    model_config: ClassVar[ConfigDict] = ConfigDict(frozen=True, extra="forbid")

    @field_validator("*", mode="before")
    @classmethod
    def _read_quantity(cls, value: object, info: ValidationInfo) -> object:
        field = cls.model_fields[str(info.field_name)]
        declared = field.json_schema_extra
        if not isinstance(declared, dict) or (value is None and not field.is_required()):
            return value
        if declared["structured"]:
            return value  # a list of sections, or a word
        kinds = (field.annotation, *get_args(field.annotation))
        if isinstance(value, list | tuple) and not any(get_origin(kind) is tuple for kind in kinds):
            raise ValueError("allowed is a single value")
        found = read_declared(value, declared)
        if int in kinds and any(number % 1.0 for number in of_wheels(found)):
            several = isinstance(found, tuple)
            raise ValueError(f"allowed {'are whole numbers' if several else 'is a whole number'}")
        return found

    def __str__(self) -> str:
        stated = self.model_dump(exclude_none=True)
        return " ".join(f"{name} {value}" for name, value in stated.items())

    @classmethod
    def declarations(cls) -> dict[str, dict[str, Any]]:
        """Return unit, symbol, range and description of each quantity by its name."""
        extras = {name: info.json_schema_extra for name, info in cls.model_fields.items()}
        return {
            name: {**extra, "description": cls.model_fields[name].description or ""}
            for name, extra in extras.items()
            if isinstance(extra, dict)
        }


def read_declared(value: object, declared: Mapping[str, Any]) -> object:
    """Read a quantity as it is declared: of the wheels, one value serves both."""
    if declared["structured"]:
        return value
    if declared["of_wheels"]:
        return _read_of_wheels(value, declared)
    if declared["may_differ"] and isinstance(value, list | tuple):
        three, two = _read_of_wheels(value, declared)
        return three if three == two else (three, two)
    return read_quantity(value, declared)


def of_wheels(value: Any) -> tuple[Any, Any]:
    """Return the values for wheels 3 and 2; one serves both."""
    return value if isinstance(value, tuple) else (value, value)


def _read_of_wheels(value: object, declared: Mapping[str, Any]) -> Any:
    if not isinstance(value, list | tuple):
        return (read_quantity(value, declared),) * 2
    if len(value) != 2 or any(isinstance(item, list | tuple) for item in value):
        raise ValueError("allowed is one value, or two for wheels 3 and 2")
    return read_quantity(value, declared)


def read_quantity(value: object, declared: Mapping[str, Any]) -> object:
    """Read a quantity, or (nested) lists of them, and check the range.

    Parameters
    ----------
    value : object
        As text or number, or lists of these.
    declared : mapping
        Unit and range, as `quantity` declares them.

    Raises
    ------
    ValueError
        With what is wrong and what is allowed.
    """
    if isinstance(value, list | tuple):
        return tuple(_read_item(item, declared) for item in value)
    unit, low, high = declared["unit"], declared["low"], declared["high"]
    number = units.parse(value, unit)
    if not low <= number <= high:
        raise ValueError(f"out of range; allowed is {_range(low, high, unit)}")
    return number


def _read_item(item: object, declared: Mapping[str, Any]) -> object:
    try:
        return read_quantity(item, declared)
    except ValueError as error:
        if isinstance(item, list | tuple):
            raise
        raise ValueError(f"item {shown(item)} is wrong: {error}") from None


def _range(low: float, high: float, unit: str) -> str:
    return f"{low:g} to {high:g}" + ("" if unit == "1" else f" {unit}")


Model = TypeVar("Model", bound=BaseModel)


def validate(model: type[Model], data: object, where: str, changed: Mapping[str, str]) -> Model:
    """Build `model` from plain data.

    Parameters
    ----------
    model : type of Section
        What to build.
    data : object
        Nested mappings, as read from a file.
    where : str
        What the data came from, for messages; may be empty.
    changed : mapping of str to str
        Dotted keys whose value came from elsewhere, and from where.

    Raises
    ------
    InputError
        One line with the first mistake, and the number of further ones.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        slips = _slips(model, data, error)
    slip = slips[0]
    origin = _origin(slip.about, where, changed)
    more = f" (and {len(slips) - 1} more)" if len(slips) > 1 else ""
    line = ": ".join(part for part in (origin, slip.key, slip.text) if part) + more
    raise InputError(line) from None


def _origin(key: str, where: str, changed: Mapping[str, str]) -> str:
    """Return where the value of a key, or the values of a section, came from."""
    for name, origin in changed.items():
        if f"{key}.".startswith(f"{name}."):
            return origin
        if not key or name.startswith(f"{key}."):
            return f"{where} with {origin}"
    return where


def nearest(word: str, choices: Iterable[str]) -> str:
    """Return ``" (did you mean …?)"`` with the choice that is most like `word`, or nothing."""
    close = difflib.get_close_matches(word, list(choices), n=1, cutoff=0.6)
    return f" (did you mean '{close[0]}'?)" if close else ""


def shown(value: object) -> str:
    """Write a value that was found, in one short line."""
    if value is None:
        return "nothing"
    if type(value).__module__ not in ("builtins", "numpy"):
        return f"an object of type {type(value).__name__}"
    if isinstance(value, Mapping):
        return "a mapping"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}" if value else "an empty list"
    try:
        text = repr(value)
    except ValueError:  # an integer with thousands of digits
        text = "a huge number"
    return text if len(text) <= _SHOWN else text[:_SHOWN] + "…"


class _Slip(NamedTuple):
    key: str
    text: str
    about: str  # the key or section whose values are at fault


def _slips(model: type[BaseModel], data: object, error: ValidationError) -> list[_Slip]:
    """Return every mistake: unknown keys first, missing ones last."""
    unknown, wrong, missing = [], [], []
    for item in error.errors(include_url=False, include_input=False):
        loc = item["loc"]
        key = ".".join(str(part)[:_SHOWN] for part in loc)
        if item["type"] == "extra_forbidden":
            section = _model_at(model, loc[:-1])
            choices = section.model_fields if section else {}
            hint = nearest(str(loc[-1]), choices) or f"; allowed are {', '.join(choices)}"
            unknown.append(_Slip(key, f"unknown key{hint}", key))
        elif item["type"] == "missing":
            missing.append(_Slip(key, f"missing{_purpose(model, loc)}", key))
        else:
            reason = item["msg"].removeprefix("Value error, ")
            if item["type"] in _EXPECTED:
                reason = _EXPECTED[item["type"]].format_map(item.get("ctx", {}))
            if item["type"] == "value_error" and _model_at(model, loc):
                name, reason = reason.split(": ", 1)  # a check of a section names the key itself
                wrong.append(_Slip(f"{key}.{name}".lstrip("."), reason, key))
            else:
                wrong.append(_Slip(key, f"found {shown(_at(data, loc))}; {reason}", key))
    suggested = " ".join(slip.text for slip in unknown)
    missing = [slip for slip in missing if f"'{slip.key.rpartition('.')[2]}'" not in suggested]
    return unknown + wrong + missing


def _model_at(model: type[BaseModel], loc: Sequence[int | str]) -> type[BaseModel] | None:
    """Return the section at a key, or None if there is a value instead."""
    inside = iter(loc)
    for part in inside:
        info = model.model_fields.get(str(part))
        types = (info.annotation, *get_args(info.annotation)) if info else ()
        inner = [t for t in types if isinstance(t, type) and issubclass(t, BaseModel)]
        holds_many = info is not None and get_origin(info.annotation) in (dict, tuple)
        if not inner or (holds_many and next(inside, None) is None):
            return None
        model = inner[0]
    return model


def _purpose(model: type[BaseModel], loc: Sequence[int | str]) -> str:
    """Return the purpose of a missing key, or of the list with a missing item."""
    section = _model_at(model, loc[:-1])
    info = section.model_fields[str(loc[-1])] if section else model.model_fields[str(loc[0])]
    return f"; expected: {info.description}" if info.description else ""


def _at(data: Any, loc: Sequence[int | str]) -> object:
    for part in loc:
        try:
            data = data[part]
        except (KeyError, IndexError, TypeError):
            return data
    return data
