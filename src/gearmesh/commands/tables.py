"""``gearmesh variants`` and ``gearmesh parameters``: tables of at most 100 columns."""

import argparse
import textwrap
from collections.abc import Sequence

from gearmesh.study.derived import derived
from gearmesh.study.pair import Pair

WIDTH = 100
"""Columns of a table."""

_EXPLAINED = """
L   linear damping     k1 v                Kv  quadratic damping  k2 |v| v
Ku  cubic damping      k3 v^3              v = dy/dtau_s, the relative velocity in the mesh
k acts in the material while the teeth touch, km in the lubricant while they do not.
'-5x' behind a name multiplies its damping, here by 5: c-material-5x."""


def load_pair(options: argparse.Namespace) -> Pair:
    """Return the pair that ``--config`` and ``--set`` choose; the paper's by default."""
    from gearmesh.interface.statements import paper_file
    from gearmesh.study.loading import load_study

    if options.config is not None:
        return load_study(options.config, options.overrides).pair
    with paper_file() as path:
        return load_study(path, options.overrides).pair


def variants(options: argparse.Namespace) -> int:
    """Print Tab. 1."""
    from gearmesh.model.variants import VARIANTS

    head = ("name", "mark", "k1", "k2", "k3", "k1m", "k2m", "k3m", "damping")
    rows = [
        (
            variant.name,
            variant.marker,
            *("×" if acts else "0" for acts in variant.material_powers),
            *("×" if acts else "0" for acts in variant.lubricant_powers),
            variant.description,
        )
        for variant in VARIANTS.values()
    ]
    print_table([head, *rows])
    print(_EXPLAINED)
    return 0


def parameters(options: argparse.Namespace) -> int:
    """Print every parameter, and what follows from them."""
    pair = load_pair(options)
    table = [("parameter", "symbol", "value", "unit", "kind", "meaning; reason")]
    for row in pair.parameters:
        told = f"{row.description}; {row.reason}" if row.reason else row.description
        table.append((row.name, row.symbol, _text(row.value), row.unit, row.kind, told))
    for quantity in derived(pair):
        value = _text(quantity.value(pair))
        table.append(
            (quantity.name, quantity.symbol, value, quantity.unit, "computed", quantity.formula)
        )
    print_table(table)
    return 0


def geometry(options: argparse.Namespace) -> int:
    """Print contact ratio and stiffness of wheels from a drawing, and their parameters."""
    from gearmesh.interface.geometry import geometry as compute

    found = compute(
        module=options.module,
        teeth=_of_wheels(options.teeth),
        face_width=options.face_width,
        pressure_angle=options.pressure_angle,
        profile_shift=_of_wheels(options.profile_shift),
        centre_distance=options.centre_distance,
    )
    print_table([("quantity", "value", "unit", "formula"), *found.rows()])
    print("\nfor a study:")
    for name, value in found.parameters.items():
        print(f"{name}: {value}")
    return 0


_LISTED = 6
"""A longer list of numbers is shown as its length, least and greatest value."""


def _of_wheels(texts: Sequence[str]) -> object:
    """Return one value, or two for wheels 3 and 2."""
    return texts[0] if len(texts) == 1 else list(texts)


def _text(value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, tuple):
        texts = [_text(item) for item in value]
        if len(texts) > _LISTED and all(isinstance(item, float) for item in value):
            return f"{len(texts)} values from {_text(min(value))} to {_text(max(value))}"
        same = len(set(texts)) == 1
        return ", ".join(texts[:1] if same else texts) or "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.8g}" if isinstance(value, int | float) else str(value)


def print_table(rows: Sequence[Sequence[str]]) -> None:
    """Print rows in columns; the last column is wrapped where the line would be too long."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)][:-1]
    indent = sum(widths) + 2 * len(widths)
    for *cells, last in rows:
        start = "".join(f"{cell.ljust(width)}  " for cell, width in zip(cells, widths, strict=True))
        lines = textwrap.wrap(last, WIDTH - indent) or [""]
        print((start + lines[0]).rstrip())
        for line in lines[1:]:
            print(" " * indent + line)
