"""Read a study from YAML.

`load_study` follows ``base:``, applies replaced parameters and checks everything. Each mistake
becomes one line. Nothing in a configuration is evaluated.
"""

import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from gearmesh.errors import InputError
from gearmesh.study.alternatives import NAMES, excluded_by
from gearmesh.study.cases import Plan, Study
from gearmesh.study.derived import FOLLOWING
from gearmesh.study.frequencies import read_nu
from gearmesh.study.pair import Pair
from gearmesh.study.reading import yamlfile
from gearmesh.study.reading.provenance import Statement, read_statement
from gearmesh.study.reading.schema import nearest, shown, validate
from gearmesh.study.speeds import as_nu

_MAX_BASES = 8
_NAME = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9._-]{0,63}")
_OWN = ("name", "title", "claims", "mechanisms")
"""Keys that a file does not inherit from its base: they identify the study itself, or ask for what
takes longer than all its cases."""

_OF_FREQUENCIES = ("nu", "strong_damping", "time_courses")
"""Keys whose frequencies may be speeds in rpm."""


def load_study(path: str | Path, overrides: Iterable[str] = ()) -> Study:
    """Read and check a study.

    Parameters
    ----------
    path : str or Path
        YAML file. ``base: FILE`` in it names one, relative to it, whose keys it inherits.
    overrides : iterable of str
        ``NAME=VALUE`` for parameters, as ``"backlash=40 um"``.

    Raises
    ------
    InputError
        With one line: file, key, what was found, what is allowed.
    """
    path = Path(path)
    data, own = _with_bases(path, ())
    name = _name(path, data.pop("name", path.stem))
    _check_keys(path, data)
    try:
        statements = {
            key: read_statement(key, value) for key, value in data.items() if key in NAMES
        }
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    changed: dict[str, str] = {}
    for text in overrides:
        key, value = _override(text)
        if key in changed:
            raise InputError(f"--set {text}: {key}: found twice; allowed is once")
        for other in excluded_by({key: value}) - {*changed}:
            statements.pop(other, None)
        statements[key] = Statement(value, reason="set on the command line")
        changed[key] = f"--set {text}"
    pair = Pair.from_statements(statements, str(path), changed)
    plan = {
        key: as_nu(value, pair, f"{path}: {key}") if key in _OF_FREQUENCIES else value
        for key, value in data.items()
        if key not in NAMES
    }
    return Study(name, path, pair, _read_plan({"title": name, **plan}, own, path))


def _name(path: Path, name: object) -> str:
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise InputError(
            f"{path}: name: found {shown(name)}; allowed are letters, digits, '.', '_' and '-', "
            "64 at most, not '.' first; without a name, that of the file is used"
        )
    return name


def _check_keys(path: Path, data: Mapping[str, object]) -> None:
    """Refuse keys that are neither a parameter nor a key of the plan."""
    known = [*NAMES, *Plan.model_fields, "name", "base"]
    for key in data:
        if key not in known:
            raise InputError(f"{path}: {key:.60}: unknown key{_hint(key, known)}")


def _hint(key: str, known: Iterable[str]) -> str:
    """Suggest the nearest name, also for a key with a section before it."""
    known = list(known)
    last = key.rpartition(".")[2]
    for computed in FOLLOWING:
        if computed.name == last and last not in known:
            return f"; it is computed as {computed.formula}"
    if last in known:
        return f" (did you mean '{last}'?)"
    return nearest(last, known) or "; 'gearmesh parameters' lists all parameters"


def _read_plan(data: dict[str, object], own: Mapping[str, object], path: Path) -> Plan:
    """Read all keys that are not parameters.

    If a file states its own variants or frequencies, the time courses that it inherits for other
    cases are left out.
    """
    courses = data.pop("time_courses", None)
    plan = validate(Plan, data, str(path), {})
    if courses is None:
        return plan
    if isinstance(courses, Mapping):
        stated = own.get("time_courses")
        stated = stated if isinstance(stated, Mapping) else {}
        spans = plan.spans()
        courses = {
            name: nus if name in stated else _within(nus, spans[name])
            for name, nus in courses.items()
            if name in stated or name in spans
        }
    return validate(Plan, {**data, "time_courses": courses}, str(path), {})


def _is_left_out(data: Mapping[str, object]) -> bool:
    """Return whether the variant of an inherited stronger damping is none of the variants."""
    strong, variants = data.get("strong_damping"), data.get("variants")
    if not isinstance(strong, Mapping) or not isinstance(variants, list):
        return False
    return strong.get("variant") not in variants


def _within(nus: object, span: tuple[float, float]) -> object:
    """Return the frequencies within a span; anything else unchanged, for validation to refuse."""
    try:
        return [nu for nu in nus if span[0] <= read_nu(nu) <= span[1]]  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        return nus


def _with_bases(
    path: Path, inheriting: tuple[Path, ...]
) -> tuple[dict[str, object], dict[str, object]]:
    """Read a file; return its content merged into that of its bases, and its own content."""
    own = yamlfile.read_mapping(path)
    if path.resolve() in inheriting or len(inheriting) >= _MAX_BASES:
        raise InputError(f"{path}: base: the files inherit in a circle, or more than {_MAX_BASES}")
    base = own.pop("base", None)
    if base is None:
        return dict(own), own
    if not isinstance(base, str):
        raise InputError(f"{path}: base: found {shown(base)}; allowed is the name of a file")
    try:
        inherited, _ = _with_bases(path.parent / base, (*inheriting, path.resolve()))
    except InputError as error:
        raise InputError(f"{path}: base: {error}" if not inheriting else str(error)) from None
    inherited = {key: value for key, value in inherited.items() if key not in _OWN}
    merged = _merge(inherited, own)
    if "variants" in own and "strong_damping" not in own and _is_left_out(merged):
        del merged["strong_damping"]
    return merged, own


def _merge(base: Mapping[str, object], own: Mapping[str, object]) -> dict[str, object]:
    """Merge `own` into `base`.

    Mappings are merged key by key, parameters and everything else are replaced, and an empty value
    removes a key. A torque takes the place of an inherited static deflection, and so on.
    """
    replaced = excluded_by(own)
    merged = {key: value for key, value in base.items() if key not in replaced}
    for key, value in own.items():
        inherited = merged.get(key)
        if value is None:
            merged.pop(key, None)
        elif key in NAMES:
            merged[key] = value
        elif isinstance(value, Mapping) and isinstance(inherited, Mapping):
            merged[key] = _merge(inherited, value)
        else:
            merged[key] = value
    return merged


def _override(text: str) -> tuple[str, object]:
    """Read ``NAME=VALUE`` of a parameter."""
    key, equals, value = text.partition("=")
    key = key.strip()
    if not equals or not key:
        raise InputError(f"--set {text}: allowed is NAME=VALUE, as in backlash='40 um'")
    if key not in NAMES:
        raise InputError(f"--set {text}: {key}: {_why_no_parameter(key)}")
    return key, yamlfile.read_value(value, f"--set {text}")


def _why_no_parameter(key: str) -> str:
    if key.partition(".")[0] in (*Plan.model_fields, "name", "base"):
        return "not a parameter; the file of a study states it"
    return f"no such parameter{_hint(key, NAMES)}"


def load(path: str | Path) -> Study:
    """Read a study from YAML.

    Parameters
    ----------
    path : str or Path
        Its file, such as ``"config/paper.yaml"``.

    Returns
    -------
    Study
        With `pair`, `variants`, `nu`, `cases` and more.

    Raises
    ------
    InputError
        With one line: file, key, what was found, what is allowed.
    """
    if not isinstance(path, str | os.PathLike):
        raise InputError(f"path: found {shown(path)}; allowed is the name of a file")
    study = load_study(path)
    if study.claims is not None and not os.path.isfile(study.claims):
        raise InputError(f"{path}: claims: there is no file {study.claims}")
    return study
