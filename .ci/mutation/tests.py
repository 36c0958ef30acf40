"""The tests of a target: collected once, run one by one in forked processes."""

import functools
import gc
import inspect
import itertools
import json
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any

from mutation.processes import Task, race

OPTIONS = (
    *("-qq", "-s", "-n", "0", "--disable-warnings", "--assert=plain", "--tb=native"),
    *("-p", "no:cacheprovider", "-o", "timeout=0", "--hypothesis-profile=mutants"),
)
_HOURS = 36000


@dataclass(frozen=True)
class Baseline:
    """A run of the tests without any change.

    Attributes
    ----------
    seconds : dict of str to float
        Test -> processor time.
    lines : dict of str to set of (str, int)
        Test -> file and line that it runs; "" for what runs before all tests.
    """

    seconds: dict[str, float]
    lines: dict[str, set[tuple[str, int]]]

    @classmethod
    def read(cls, text: str) -> "Baseline":
        """Read what `observe` returns."""
        stated = json.loads(text)
        lines = {test: {(file, n) for file, n in at} for test, at in stated["lines"].items()}
        return cls(stated["seconds"], lines)

    def covering(self, file: Path, lines: Iterable[int]) -> list[str]:
        """Return the tests that run one of the lines, the fastest first."""
        wanted = {(str(file), line) for line in lines}
        return sorted((t for t in self.seconds if self.lines[t] & wanted), key=self.seconds.get)

    def runs_early(self, file: Path, lines: Iterable[int]) -> bool:
        """Return whether one of the lines runs before all tests."""
        return bool({(str(file), line) for line in lines} & self.lines[""])

    def all_for(self, file: Path) -> list[str]:
        """Return all tests, those that run code of a file first."""
        runs = {t for t in self.seconds if any(name == str(file) for name, _ in self.lines[t])}
        return sorted(self.seconds, key=lambda test: (test not in runs, self.seconds[test]))

    def limit(self, tests: Iterable[str]) -> int:
        """Return the processor time after which a mutant counts as hanging, in seconds.

        The times of the tests were measured with a trace, which slows them down.
        """
        return 15 + int(2 * sum(self.seconds[test] for test in tests))


class Trace:
    """Notes which lines of the functions of some files run."""

    def __init__(self, files: Iterable[Path]) -> None:
        self._files = {str(file) for file in files}
        self.begin()

    def begin(self) -> None:
        """Forget all lines."""
        self.lines: set[tuple[str, int]] = set()
        self._left: dict[int, set[int]] = {}

    def __call__(self, frame: FrameType, event: str, argument: object) -> Any:
        """Decide whether the lines of a call count; `sys.settrace` asks.

        A function whose lines have all been noted is not traced any more, which takes time.
        """
        code = frame.f_code
        if code.co_filename not in self._files or not code.co_flags & inspect.CO_NEWLOCALS:
            return None
        if id(code) not in self._left:
            lines = {line for _, _, line in code.co_lines() if line}
            self._left[id(code)] = lines - {code.co_firstlineno} or lines
        return self._line if self._left[id(code)] else None

    def _line(self, frame: FrameType, event: str, argument: object) -> Any:
        left = self._left[id(frame.f_code)]
        left.discard(frame.f_lineno)
        self.lines.add((frame.f_code.co_filename, frame.f_lineno))
        return self._line if left else None


class _Collected:
    """A plugin of pytest that hands over the collected tests in place of running them."""

    def __init__(self, use: Callable[[Any], None]) -> None:
        self._use = use

    def pytest_runtestloop(self, session: Any) -> bool:
        if not session.testsfailed:
            self._use(session)
        return True


def collect(places: Sequence[str], use: Callable[[Any], None]) -> int:
    """Collect tests and hand over the session; return the status of pytest."""
    import pytest
    from hypothesis import Phase, settings

    # An example that fails is enough; the smallest one is of no interest.
    phases = (Phase.explicit, Phase.generate)
    settings.register_profile("mutants", deadline=None, derandomize=True, phases=phases)
    return int(pytest.main([*OPTIONS, *places], [_Collected(use)]))


def first_failure(session: Any, tests: Sequence[str], place: Path) -> str | None:
    """Run tests of a session, with temporary files in `place`; return the first that fails."""
    known = {item.nodeid: item for item in session.items}
    items = [known[test] for test in tests]
    for item, following in _begin(session, items, place):
        item.ihook.pytest_runtest_protocol(item=item, nextitem=following)
        if session.testsfailed:
            return item.nodeid
    return None


def observe(session: Any, trace: Trace) -> str:
    """Run each test without any change; return time and lines of each, for `Baseline.read`.

    Raises
    ------
    RuntimeError
        If a test fails.
    """
    early = set(trace.lines)

    def work(place: Path) -> str:
        seconds, lines = {}, {"": sorted(early)}
        remembering = _caches()
        for item, _ in _begin(session, session.items, place):
            # Neither caches nor fixtures of an earlier test may hide what this one runs.
            for one in remembering:
                one.cache_clear()
            trace.begin()
            start = time.process_time()
            item.ihook.pytest_runtest_protocol(item=item, nextitem=None)
            seconds[item.nodeid] = time.process_time() - start
            lines[item.nodeid] = sorted(trace.lines)
            if session.testsfailed:
                raise RuntimeError(f"{item.nodeid} fails without any change")
        return json.dumps({"seconds": seconds, "lines": lines})

    [(_, text)] = race([Task("the tests", work, _HOURS)], 1)
    sys.settrace(None)
    return text or ""


def _caches() -> list[Any]:
    kind = type(functools.cache(len))
    found = [one for one in gc.get_objects() if isinstance(one, kind)]
    return [one for one in found if (one.__module__ or "").startswith("gearmesh")]


def _begin(session: Any, items: Sequence[Any], place: Path) -> Iterable[tuple[Any, Any]]:
    place.mkdir()
    session.config._tmp_path_factory._basetemp = place
    return itertools.zip_longest(items, items[1:])
