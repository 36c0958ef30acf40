"""Change the code in small ways, one at a time, and count which changes the tests notice.

    python .ci/mutants.py [--every N] [--survivors] [--jobs N] [TARGET ...]

A mutant changes one comparison, operator, constant, condition or returned value. The tests of a
target are collected once, and run once to see which lines each of them runs. Then a process is
forked for each mutant. It puts the changed code into the functions that have it, and runs the tests
of the changed lines, the fastest first, until one fails. If an import runs the changed code, the
process must not have imported the package before. Compiled code is not mutated: two other solvers
check it.

Outcomes are kept in `.mutants/`. As long as neither sources nor tests change, a run that was
stopped goes on where it ended. docs/testing.md says why each survivor is harmless.
"""

import argparse
import functools
import hashlib
import json
import os
import sys
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from mutation import live, tests
from mutation.changes import Change, changed, changes
from mutation.processes import Task, race

TARGETS = {
    "model": (["model/*.py"], ["tests/model"]),
    "measures": (
        ["reproduction/claims/*.py"],
        [
            *("tests/reproduction/test_measures.py", "tests/reproduction/test_ledger.py"),
            *("tests/reproduction/test_printed_numbers.py", "tests/reproduction/test_judgement.py"),
            *("tests/reproduction/test_claims.py", "tests/reproduction/test_time_course_claims.py"),
        ],
    ),
    "layout": (
        ["data/casefile.py", "data/manifest.py", "data/paths.py"],
        [
            *("tests/data/test_layout.py", "tests/data/test_paths.py"),
            *("tests/data/test_casefile.py", "tests/data/test_manifest.py"),
        ],
    ),
    "reruns": (
        ["pipeline/plan.py", "data/provenance.py", "pipeline/inputs.py"],
        ["tests/pipeline", "tests/data/test_code_digest.py", "tests/data/test_sources.py"],
    ),
}
"""Files below src/gearmesh, and the tests that should notice a change in them."""

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src"
OUTCOMES = ROOT / ".mutants"


@dataclass(frozen=True)
class Mutant:
    """A change of a file."""

    file: Path
    source: str
    number: int
    change: Change

    @property
    def key(self) -> tuple[str, str]:
        """The file below the package, and what is changed."""
        return self.file.relative_to(SOURCE / "gearmesh").as_posix(), self.change.what

    def code(self) -> Any:
        """Return the changed module."""
        return compile(changed(self.source, self.number), str(self.file), "exec")


@dataclass(frozen=True)
class Outcome:
    """What became of a mutant: the digest of the code and the tests, and the test that failed."""

    state: str
    file: str
    what: str
    killed_by: str | None

    @property
    def key(self) -> tuple[str, str]:
        """As that of the mutant."""
        return self.file, self.what


class Target:
    """The mutants of a target, and their outcomes.

    Parameters
    ----------
    name : str
        One of `TARGETS`.
    state : str
        Digest of code and tests.
    options : argparse.Namespace
        The command line.
    """

    def __init__(self, name: str, state: str, options: argparse.Namespace) -> None:
        patterns, self._tests = TARGETS[name]
        self._state, self._jobs = state, options.jobs
        files = sorted(f for p in patterns for f in (SOURCE / "gearmesh").glob(p))
        self._sources = {file: file.read_text("utf-8") for file in files}
        self._outcomes = OUTCOMES / f"{name}.jsonl"
        found = [
            Mutant(file, source, number, change)
            for file, source in self._sources.items()
            for number, change in enumerate(changes(source))
        ]
        self.mutants = found[:: options.every]
        if options.survivors:
            last = {one.key: one.killed_by for one in self._kept()}
            self.mutants = [one for one in self.mutants if last.get(one.key) is None]

    def _kept(self) -> list[Outcome]:
        if not self._outcomes.exists():
            return []
        lines = self._outcomes.read_text("utf-8").splitlines()
        return [Outcome(**json.loads(line)) for line in lines]

    def outcomes(self) -> dict[tuple[str, str], Outcome]:
        """Return what is known about the code and the tests as they are."""
        return {one.key: one for one in self._kept() if one.state == self._state}

    def run(self) -> None:
        """Run the mutants whose outcome is not known."""
        known = self.outcomes()
        waiting = [mutant for mutant in self.mutants if mutant.key not in known]
        if not waiting:
            return
        OUTCOMES.mkdir(exist_ok=True)
        with tempfile.TemporaryDirectory() as temporary:
            handed = Path(temporary) / "handed.json"
            child = os.fork()
            if not child:
                # The tests import the package here, so that the parent stays without it.
                trace = tests.Trace(self._sources)
                sys.settrace(trace)
                use = functools.partial(self._in_place, trace, waiting, handed)
                os._exit(tests.collect(self._tests, use))
            if os.waitpid(child, 0)[1] or not handed.exists():
                raise SystemExit(f"{self._outcomes.stem}: the tests cannot be run, see above")
            observed, numbers = json.loads(handed.read_text())
        baseline = tests.Baseline.read(observed)
        self._keep(race((self._anew(waiting[n], baseline) for n in numbers), self._jobs))

    def _in_place(
        self, trace: tests.Trace, waiting: Sequence[Mutant], handed: Path, session: Any
    ) -> None:
        """Run the mutants of functions; hand over the numbers of the others."""
        observed = tests.observe(session, trace)
        baseline = tests.Baseline.read(observed)
        functions = live.functions(self._sources)
        before = {file: compile(text, str(file), "exec") for file, text in self._sources.items()}
        left = []

        def tasks() -> Iterable[Task]:
            for number, mutant in enumerate(waiting):
                file, lines = mutant.file, mutant.change.lines
                swaps = live.swaps(before[file], mutant.code(), functions)
                if swaps is None or baseline.runs_early(file, lines):
                    left.append(number)
                    continue
                chosen = baseline.covering(file, lines)

                def work(place: Path, swaps: Any = swaps, chosen: Any = chosen) -> str | None:
                    for several, code in swaps:
                        for function in several:
                            function.__code__ = code
                    return tests.first_failure(session, chosen, place)

                yield Task(mutant, work, baseline.limit(chosen))

        self._keep(race(tasks(), self._jobs))
        handed.write_text(json.dumps([observed, left]))

    def _anew(self, mutant: Mutant, baseline: tests.Baseline) -> Task:
        """Return the task of a mutant that the package is imported with."""
        chosen = baseline.all_for(mutant.file)

        def work(place: Path) -> str | None:
            live.ChangedModule(SOURCE, mutant.file, mutant.code()).install()
            failed = ["an import"]

            def use(session: Any) -> None:
                failed[:] = [tests.first_failure(session, chosen, place)]

            tests.collect(self._tests, use)
            return failed[0]

        return Task(mutant, work, baseline.limit(chosen))

    def _keep(self, found: Iterable[tuple[Mutant, str | None]]) -> None:
        with self._outcomes.open("a", encoding="utf-8") as file:
            for mutant, killer in found:
                outcome = Outcome(self._state, *mutant.key, killer)
                file.write(json.dumps(asdict(outcome), ensure_ascii=False) + "\n")
                file.flush()


def main() -> int:
    """Run all mutants of the targets; fails if fewer than nine of ten are killed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("targets", nargs="*", choices=[[], *TARGETS], default=[*TARGETS])
    parser.add_argument("--every", type=int, default=1, help="run each N-th mutant only")
    parser.add_argument("--survivors", action="store_true", help="run those that survived again")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes at a time")
    options = parser.parse_args()
    os.chdir(ROOT)
    sys.path.insert(0, str(SOURCE))
    os.environ["PYTHONPATH"] = str(SOURCE)
    _load_libraries()
    state = _digest()
    count = dead = 0
    for name in options.targets:
        target = Target(name, state, options)
        target.run()
        known = target.outcomes()
        found = [known[mutant.key] for mutant in target.mutants]
        alive = [outcome for outcome in found if outcome.killed_by is None]
        for outcome in alive:
            print(f"survives: {outcome.file}:{outcome.what}")
        print(f"{name}: {len(found) - len(alive)} of {len(found)} killed", flush=True)
        count, dead = count + len(found), dead + len(found) - len(alive)
    print(f"all: {dead} of {count} killed, {dead / max(count, 1):.1%}")
    return int(dead < 0.9 * count)


def _digest() -> str:
    """Return a digest of all code and tests."""
    total = hashlib.sha256()
    for file in sorted(f for folder in ("src", "tests", ".ci") for f in Path(folder).rglob("*.py")):
        total.update(f"{file}\n{file.read_text('utf-8')}".encode())
    return total.hexdigest()[:16]


def _load_libraries() -> None:
    import hypothesis  # noqa: F401
    import netCDF4  # noqa: F401
    import numba  # noqa: F401
    import pint  # noqa: F401
    import pydantic  # noqa: F401
    import pytest  # noqa: F401
    import scipy.integrate
    import scipy.optimize  # noqa: F401
    import xarray  # noqa: F401


if __name__ == "__main__":
    sys.exit(main())
