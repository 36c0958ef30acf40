"""`make bench`: measure all solvers in one go, print the table, write results and diagram."""

import json
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks import against, machine, start, table, work_precision  # before NumPy
from benchmarks.cases import SWEEP, singles, sweeps
from benchmarks.measure import AIM, SHARE, Accuracy, Contest, measured, sparse
from benchmarks.peers import OURS, OURS_WITH_LESS, PEERS, Solve, Solver

ROUNDS = 7
SLOW_ROUNDS = 3
RESULTS = Path(__file__).parent / "results.json"


@dataclass(frozen=True, slots=True)
class Entry:
    """A solver at one setting, with its errors: a row of the table."""

    name: str
    solver: Solver
    solve: Solve
    setting: float
    accuracy: Accuracy


def main() -> int:
    """Run everything."""
    with tempfile.TemporaryDirectory(prefix="against-") as folder:
        before = against.table(Path(folder), list(against.ROWS))
    print(before)
    machine.keep_one_core()
    try:
        from benchmarks.reference import SENSITIVE, references
    except ImportError as error:
        print(f"benchmarks: heyoka gives the reference and cannot be imported: {error}")
        return 2

    runs = sweeps()
    one_each = [[problem] for problems in singles().values() for problem in problems]
    _say("reference solutions")
    of_runs = {name: references(problems) for name, problems in runs.items()}
    sensitive = {
        name: [float(nu) for nu, known in zip(SWEEP, found, strict=True) if known.sensitive]
        for name, found in of_runs.items()
    }

    solvers, left_out = _load()
    points, entries = _scan(solvers, runs, of_runs)
    _say("times")
    rows = _rows(entries, runs, one_each)
    _say("start of the command")
    results = {
        "machine": machine.described(),
        "aim": {"error": AIM, "share_of_runs": SHARE},
        "left_out": left_out,
        "sensitive": {"amplification_above": SENSITIVE, "nu": sensitive},
        "table": rows,
        "start_seconds": start.seconds(),
        "work_precision": [asdict(point) for point in points],
    }
    RESULTS.write_text(json.dumps(results, indent=1, ensure_ascii=False) + "\n")
    work_precision.draw(points)
    print(table.render(results), before, against.against_heyoka(results), sep="\n")
    return 0


def _say(text: str) -> None:
    print(f"\x1b[2K{text}", end="\r" if sys.stderr.isatty() else "\n", file=sys.stderr, flush=True)


def _load() -> tuple[list[tuple[Solver, Solve]], dict[str, str]]:
    """Import the available peers; print why the others are left out."""
    loaded, left_out = [], {}
    for solver in (OURS, *PEERS):
        try:
            loaded.append((solver, solver.load()))
        except ImportError as error:
            left_out[solver.name] = str(error)
            _say(f"left out: {solver.name} ({error})\n")
    return loaded, left_out


def _scan(solvers, runs, of_runs) -> tuple[list[work_precision.Point], list[Entry]]:
    """Measure every solver at all its settings; return those points, and the rows to time."""
    points, entries = [], []
    for solver, solve in solvers:
        cases, known = (sparse(runs), sparse(of_runs)) if solver.slow else (runs, of_runs)
        found = {}
        for setting in solver.settings:
            _say(f"{solver.name}: {solver.setting} {setting:g}")
            solve(next(iter(cases.values())), setting)  # compiles and warms up
            found[setting], spent = measured(solve, setting, cases, known)
            points.append(work_precision.Point(solver.name, setting, spent, found[setting].most))
        entries += _entries(solver, solve, found)
        if solver is OURS:
            for less in OURS_WITH_LESS:
                errors, _ = measured(less.load(), entries[0].setting, runs, of_runs)
                entries.append(Entry(less.name, less, less.load(), entries[0].setting, errors))
    return points, entries


def _entries(solver: Solver, solve: Solve, found: dict[float, Accuracy]) -> list[Entry]:
    """Return the settings to list: those asked for, or the coarsest one that reaches the aim."""
    reaching = [setting for setting, errors in found.items() if errors.reaches_aim]
    chosen = solver.tabled or (reaching or list(found)[-1:])[:1]
    return [
        Entry(
            solver.name if len(chosen) == 1 else f"{solver.name}, {setting:g} {solver.setting}",
            solver,
            solve,
            setting,
            found[setting],
        )
        for setting in chosen
    ]


def _rows(entries: list[Entry], runs, one_each) -> list[dict]:
    """Time the entries on the sweeps and on single cases."""
    thinned = sparse(runs)
    times = {}
    for slow, rounds in ((False, ROUNDS), (True, SLOW_ROUNDS)):
        chosen = [entry for entry in entries if entry.solver.slow is slow]
        sweep = {
            e.name: (e.solve, e.setting, list((thinned if slow else runs).values())) for e in chosen
        }
        single = {e.name: (e.solve, e.setting, one_each) for e in chosen if e.solver.single}
        times |= {name: {"sweep": t} for name, t in Contest(sweep).medians(rounds).items()}
        for name, t in Contest(single).medians(rounds).items():
            times[name]["single"] = t
    return [
        {
            "solver": entry.name,
            "setting": entry.setting,
            "seconds_a_case": times[entry.name],
            "error": asdict(entry.accuracy),
        }
        for entry in entries
    ]


if __name__ == "__main__":
    sys.exit(main())
