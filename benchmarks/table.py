"""The results as a table for the terminal."""

from benchmarks.peers import OURS, OURS_WITHOUT_SAMPLES


def render(results: dict) -> str:
    """Return the table, the ratios and what was left out."""
    rows = results["table"]
    times = {row["solver"]: row["seconds_a_case"] for row in rows}
    ours, lean = times[OURS.name], times[OURS_WITHOUT_SAMPLES.name]
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
    peers = [row for row in rows if row["solver"] not in (OURS.name, OURS_WITHOUT_SAMPLES.name)]
    able = [row for row in peers if row["error"]["most"] <= results["aim"]["error"]]
    for kind in ("sweep", "single"):
        rivals = [row for row in able if kind in row["seconds_a_case"]]
        if rivals:
            best = min(rivals, key=lambda row: row["seconds_a_case"][kind])
            spent = best["seconds_a_case"][kind]
            lines.append(
                f"{kind}: {spent / ours[kind]:.1f} times as fast as the fastest peer "
                f"({best['solver']}); without samples {spent / lean[kind]:.1f} times"
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
