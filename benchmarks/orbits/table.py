"""The results as a table for the terminal."""

OURS = "gearmesh"
"""`follow` with its special points, and `basins`."""


def render(results: dict) -> str:
    """Return both tables."""
    lines = ["", f"{'a branch of c-material':44}{'ms/orbit':>10}{'times ours':>12}{'orbits':>9}"]
    lines[-1] += f"{'apart':>10}"
    for name, row in results["branch"].items():
        ratio = row["seconds"] / results["branch"][OURS]["seconds"]
        lines.append(
            f"{name:44}{row['seconds'] * 1e3:10.3f}{ratio:12.2f}{row['orbits']:9}"
            + (f"{row['error']:10.0e}" if name != OURS else f"{'–':>10}")
        )
    lines += ["", f"{'basins of b-both at 0.75':44}{'ms/start':>10}{'times ours':>12}{'starts':>9}"]
    lines[-1] += f"{'differ':>10}"
    for name, row in results["basin"].items():
        ratio = row["seconds"] / results["basin"][OURS]["seconds"]
        lines.append(
            f"{name:44}{row['seconds'] * 1e3:10.3f}{ratio:12.2f}{row['starts']:9}"
            + (f"{row['differ']:10}" if name != OURS else f"{'–':>10}")
        )
    return "\n".join(lines)
