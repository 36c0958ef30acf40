"""The results as a table for the terminal."""

from benchmarks.peers import OURS, OURS_WITH_LESS


def render(results: dict) -> str:
    """Return the table, the ratios and what was left out."""
    rows = results["table"]
    times = {row["solver"]: row["seconds_a_case"] for row in rows}
    ours = times[OURS.name]
    lines = [
        "",
        f"{'':36}{'sweep of 64, one core':^22}{'single':>10}  {'error, static deflections':^30}"
        f"{'times ours':^20}",
        f"{'solver':28}{'setting':>8}{'ms/case':>11}{'cases/s':>11}{'ms/case':>10}  "
        f"{'median':>10}{'95 %':>10}{'largest':>10}{'sweep':>10}{'single':>10}",
    ]
    for row in rows:
        spent, error = row["seconds_a_case"], row["error"]
        single = spent.get("single")
        lines.append(
            f"{row['solver']:28}{row['setting']:8g}"
            f"{spent['sweep'] * 1e3:11.3f}{1 / spent['sweep']:11,.0f}"
            + (f"{single * 1e3:10.3f}" if single else f"{'–':>10}")
            + f"  {error['median']:10.1e}{error['most']:10.1e}{error['largest']:10.1e}"
            f"{spent['sweep'] / ours['sweep']:10.2f}"
            + (f"{single / ours['single']:10.2f}" if single else f"{'–':>10}")
        )
    lines += _ratios(rows, times, results["aim"]["error"])
    start = results["start_seconds"]
    lines.append(
        f"gearmesh simulate, a whole process: {start['first']:.1f} s the first time, with "
        f"compilation, {start['later']:.2f} s later"
    )
    for name, reason in results["left_out"].items():
        lines.append(f"left out: {name}: {reason}")
    left_out = results["sensitive"]["nu"]
    lines.append(
        f"not in the errors, as the orbit amplifies a displacement more than "
        f"{results['sensitive']['amplification_above']:g} times:"
    )
    for name, frequencies in left_out.items():
        if frequencies:
            lines.append(f"  {name}: " + ", ".join(f"{nu:.4f}" for nu in frequencies))
    return "\n".join(lines)


def _ratios(rows: list[dict], times: dict, aim: float) -> list[str]:
    """Return lines that compare the time with that of the fastest peer that reaches the aim."""
    all_ours = [solver.name for solver in (OURS, *OURS_WITH_LESS)]
    lines = [
        f"{row['solver']}: only {row['error']['most']:.1e} is reached"
        for row in rows
        if row["solver"] == OURS.name and row["error"]["most"] > aim
    ]
    for kind in ("sweep", "single"):
        rivals = [
            row
            for row in rows
            if row["solver"] not in all_ours
            and kind in row["seconds_a_case"]
            and row["error"]["most"] <= aim
        ]
        if not rivals:
            continue
        best = min(rivals, key=lambda row: row["seconds_a_case"][kind])
        spent = best["seconds_a_case"][kind]
        ratios = ", ".join(f"{name} {spent / times[name][kind]:.1f}" for name in all_ours)
        lines.append(f"{kind}, times as fast as {best['solver']}: {ratios}")
    return lines
