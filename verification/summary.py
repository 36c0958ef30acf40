"""What was found, for ``verification.json`` and for the terminal."""

from collections.abc import Iterable, Sequence
from typing import Any

from verification.comparison import Comparison


def by_variant(compared: Iterable[Comparison]) -> dict[str, dict[str, Any]]:
    """Return counts, and the greatest difference of each observable, for each variant.

    The end of a sensitive case does not count here: only its first periods are compared, and their
    difference is `early`. A length has one entry for its values in mm and in y_st.
    """
    found: dict[str, dict[str, Any]] = {}
    for case in compared:
        entry = found.setdefault(
            case.variant, {"cases": 0, "sensitive": 0, "early": 0.0, "differences": {}}
        )
        entry["cases"] += 1
        if case.sensitive:
            entry["sensitive"] += 1
            entry["early"] = max(entry["early"], case.early)
            continue
        for name, value in case.differences.items():
            observable = name.removesuffix("_rel")
            greatest = entry["differences"].get(observable, 0.0)
            entry["differences"][observable] = max(greatest, value)
    return found


def sensitive_cases(compared: Iterable[Comparison]) -> list[dict[str, Any]]:
    """Return the cases that heyoka finds sensitive, or whose files say so."""
    return [
        {
            "variant": case.variant,
            "nu": case.nu,
            "amplification": float(f"{case.amplification:.3g}"),
            "comparable_periods": case.comparable,
            "early": case.early,
            "sensitive": case.sensitive,
            "flagged_in_file": case.flagged,
        }
        for case in compared
        if case.sensitive or case.flagged
    ]


def lines(found: dict[str, Any]) -> list[str]:
    """Return a table of the findings, and the faults."""
    table = [f"{'variant':16}{'cases':>6}{'sensitive':>11}  greatest difference"]
    for name, entry in found["variants"].items():
        table.append(f"{name:16}{entry['cases']:6}{entry['sensitive']:11}  {_greatest(entry)}")
    hashes = found["numbers"]
    faults = [*found["files"]]
    for case in found["disagreeing"]:
        faults.append(f"{case['variant']} {case['nu']:g}: {'; '.join(case['faults'])}")
    faults += [f"{name}: differs from the published numbers" for name in hashes["differing"]]
    faults += [f"{name}: published, but missing" for name in hashes["missing"]]
    notes = [f"{name}: not compared with heyoka" for name in found["not_compared"]]
    notes += [f"{name}: not published" for name in hashes["unpublished"]]
    return [*table, *_shortened(notes), *_shortened(faults), _verdict(found)]


def _greatest(entry: dict[str, Any]) -> str:
    differences = entry["differences"]
    if not differences:
        return f"{entry['early']:.1e} before orbits separate"
    name = max(differences, key=lambda observable: differences[observable])
    return f"{differences[name]:.1e} ({name})"


def _shortened(listed: Sequence[str], most: int = 20) -> list[str]:
    more = [f"... and {len(listed) - most} more"] if len(listed) > most else []
    return [*listed[:most], *more]


def _verdict(found: dict[str, Any]) -> str:
    sensitive = sum(entry["sensitive"] for entry in found["variants"].values())
    outcome = "do not agree" if found["disagreeing"] or found["files"] else "agree"
    agreeing = found["numbers"]["agreeing"]
    return (
        f"{found['cases']} cases {outcome} with heyoka to {found['bound']:g}, {sensitive} "
        f"sensitive ones over their first periods; {agreeing} published hashes hold"
    )
