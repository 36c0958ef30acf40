"""YAML read strictly: plain data only, each key once, and one line for each mistake.

Scalars follow YAML 1.2 (``1e-10`` is a number; ``no``, ``1:30`` and dates are texts). Aliases and
tags are refused, so that a file cannot expand in memory or run code.
"""

import re
from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from gearmesh.errors import InputError

_MAX_BYTES = 1_000_000
_MAX_DEPTH = 12


def _slip(problem: str, place: Any) -> yaml.MarkedYAMLError:
    """Return an error at the place of an event or a node."""
    return yaml.MarkedYAMLError(problem=problem, problem_mark=place.start_mark)


class _Loader(yaml.SafeLoader):
    """Safe loader with YAML 1.2 scalars, without aliases and with unique keys."""

    yaml_implicit_resolvers: dict[str, Any] = {}  # noqa: RUF012 - PyYAML's own way; filled below
    depth = 0

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        event = self.peek_event()
        if isinstance(event, yaml.AliasEvent):
            raise _slip("aliases (*) are not supported", event)
        if event.tag is not None:
            raise _slip("tags (!) are not supported", event)
        self.depth += 1
        if self.depth > _MAX_DEPTH:
            raise _slip(f"more than {_MAX_DEPTH} levels", event)
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, str):
                raise _slip("a key is not a text", key_node)
            if key in seen:
                raise _slip(f"key {key!r:.60} occurs twice", key_node)
            seen.add(key)
        return super().construct_mapping(node, deep)


def _scalar(tag: str, pattern: str, first: str) -> None:
    _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{tag}", re.compile(pattern), list(first))


_DIGITS = "0123456789"
_scalar("null", r"(?:~|null|Null|NULL)$", "~nN")
_Loader.add_implicit_resolver("tag:yaml.org,2002:null", re.compile(r"$"), [""])  # nothing at all
_scalar("bool", r"(?:true|True|TRUE|false|False|FALSE)$", "tTfF")
_scalar("decimal", r"[-+]?[0-9]{1,18}$", f"-+{_DIGITS}")
_scalar(
    "real",
    r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?$|[-+]?\.(?:inf|nan)$",
    f"-+.{_DIGITS}",
)
_Loader.add_constructor("tag:yaml.org,2002:decimal", lambda _, node: int(node.value))
_Loader.add_constructor(
    "tag:yaml.org,2002:real", lambda _, node: float(re.sub(r"\.(inf|nan)", r"\1", node.value))
)


def read_mapping(path: Path) -> dict[str, object]:
    """Read a file that holds a mapping; raises InputError with one line if it does not."""
    data = _load(_text(path), str(path))
    if data is None:
        raise InputError(f"{path}: the file is empty; allowed is a mapping of keys to values")
    if not isinstance(data, dict):
        raise InputError(f"{path}: found no keys; allowed is a mapping of keys to values")
    return data


def read_value(text: str, where: str) -> object:
    """Read one value, written as after a key; `where` begins the message about a mistake."""
    return _load(text, where)


def _text(path: Path) -> str:
    try:
        if path.stat().st_size > _MAX_BYTES:
            raise InputError(f"{path}: larger than {_MAX_BYTES} bytes; allowed is a smaller file")
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: byte {error.start} is not UTF-8; save it as UTF-8") from None
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{path}: cannot be read ({reason})") from None


def _load(text: str, where: str) -> object:
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f" line {mark.line + 1}, column {mark.column + 1}:" if mark else ""
        problem = error.problem or error.context
        if problem == "but found another document":
            problem = "found a second document; allowed is one"
        raise InputError(f"{where}:{line} {problem}") from None
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise InputError(f"{where}: not YAML ({error})") from None
