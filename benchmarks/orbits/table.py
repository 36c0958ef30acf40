"""The results as tables for the terminal."""

OURS = "gearmesh"
"""`follow` with its special points, and `basins`."""

BRANCHES = {
    "branch": "c-material, as follow chooses",
    "study": "c-material, grid of the study",
    "atlas": "c-material, grid of the atlas",
}
"""Titles of the tables of a branch."""


def render(results: dict) -> str:
    """Return all tables."""
    lines = []
    for key, title in BRANCHES.items():
        lines += _header(title, "orbit", "states", "multipliers")
        for name, row in results[key].items():
            apart = (
                "–" if name == OURS else _short(row[what]) for what in ("error", "multipliers")
            )
            lines.append(_row(name, row, results[key], row["orbits"], *apart))
    lines += _header("basins of b-both at 0.75", "start", "differ")
    for name, row in results["basin"].items():
        differ = "–" if name == OURS else row["differ"]
        lines.append(_row(name, row, results["basin"], row["starts"], differ))
    lines += ["", "states, multipliers: largest distance from ours. Special points are ours alone."]
    return "\n".join(lines)


def _header(title: str, unit: str, *columns: str) -> list[str]:
    named = "".join(f"{column:>13}" for column in columns)
    return ["", f"{title:46}{f'ms/{unit}':>10}{'times ours':>12}{f'{unit}s':>9}{named}"]


def _row(name: str, row: dict, rows: dict, count: int, *columns: object) -> str:
    ratio = row["seconds"] / rows[OURS]["seconds"]
    shown = "".join(f"{column:>13}" for column in columns)
    return f"{name:46}{row['seconds'] * 1e3:10.3f}{ratio:12.2f}{count:9}{shown}"


def _short(distance: float | None) -> str:
    return "–" if distance is None else f"{distance:.0e}"
