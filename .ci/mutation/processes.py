"""Work in forked processes, a few at a time, each with its limits."""

import os
import resource
import shutil
import signal
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

MEMORY = 16 * 2**30
"""Address space of a process, in bytes."""

FAULT = 70
"""Exit status of a process whose work ended with an exception."""


@dataclass(frozen=True)
class Task:
    """What a process does.

    Attributes
    ----------
    name : object
        What the caller knows it by.
    work : callable
        Does it, given a folder that does not exist yet; returns text, None for nothing.
    limit : int
        Seconds of processor time.
    """

    name: Any
    work: Callable[[Path], str | None]
    limit: int


def race(tasks: Iterable[Task], jobs: int) -> Iterator[tuple[Any, str | None]]:
    """Run tasks; yield name and text of each that ends. One that its limits end has a text too."""
    running: dict[int, tuple[Any, Path]] = {}
    waiting = iter(tasks)
    count = 0
    with tempfile.TemporaryDirectory() as temporary:
        try:
            while True:
                while len(running) < jobs and (task := next(waiting, None)):
                    count += 1
                    place = Path(temporary) / str(count)
                    running[_fork(task, place)] = task.name, place
                if not running:
                    return
                pid, status = os.wait()
                name, place = running.pop(pid)
                said = place.with_suffix(".txt")
                text = said.read_text() if said.exists() else None
                if os.waitstatus_to_exitcode(status) == FAULT:
                    raise RuntimeError(f"{name}: {text}")
                yield name, "time or memory" if text is None and status else text
                shutil.rmtree(place, ignore_errors=True)
        finally:
            for pid in running:
                os.killpg(pid, signal.SIGKILL)


def _fork(task: Task, place: Path) -> int:
    sys.stdout.flush()
    child = os.fork()
    if child:
        return child
    status = FAULT
    try:
        os.setpgid(0, 0)
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        resource.setrlimit(resource.RLIMIT_CPU, (task.limit, task.limit))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        text = task.work(place)
        status = 0
    except BaseException as error:
        text = f"{type(error).__name__}: {error}"
    if text is not None:
        place.with_suffix(".txt").write_text(text)
    os._exit(status)
