"""Locks that keep two runs of a study apart.

They are held through open files, so the system releases them when a process ends, however it ends:
no lock is ever left behind. Only one run holds `.run.lock`. Its jobs share `.jobs.lock`; jobs that
outlive a killed run still hold it, and the next run waits for them.
"""

import contextlib
import errno
import fcntl
import os
import shutil
from collections.abc import Iterator
from typing import TextIO

from gearmesh.data.paths import Places
from gearmesh.data.writing import remove_partial
from gearmesh.errors import InputError
from gearmesh.pipeline.messages import say

_REFUSALS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL)
_held: list[TextIO] = []


@contextlib.contextmanager
def job(places: Places) -> Iterator[None]:
    """Hold the lock of the jobs of a run while the context lasts."""
    with _open(places, "jobs") as lock:
        _lock(lock, fcntl.LOCK_SH)
        yield


@contextlib.contextmanager
def alone(places: Places) -> Iterator[bool]:
    """Keep other runs out while the context lasts; yields whether no other run is at work."""
    with _open(places, "run") as lock:
        try:
            _lock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            yield False
            return
        _wait_for_jobs(places)
        yield True


def begin_run(places: Places) -> None:
    """Keep other runs out until this process ends, and remove half-written files of killed runs.

    Raises
    ------
    InputError
        If another run of the study is at work.
    """
    lock = _open(places, "run")
    try:
        _lock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB, warn=True)
    except BlockingIOError:
        lock.close()
        raise InputError(
            f"{places.folder}: another run is at work here; wait for its end, or stop it"
        ) from None
    _held.append(lock)
    _wait_for_jobs(places)
    shutil.rmtree(places.scratch, ignore_errors=True)
    remove_partial(places.folder)
    # Snakemake has planned its jobs by now, and refuses outputs that are older than an input.
    os.utime(places.again, (0, 0))


def end_run(places: Places) -> None:
    """Remove temporary files; the lock is released when the process ends."""
    shutil.rmtree(places.scratch, ignore_errors=True)
    places.again.unlink(missing_ok=True)


def _wait_for_jobs(places: Places) -> None:
    with _open(places, "jobs") as jobs:
        try:
            _lock(jobs, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say("waiting for jobs of an interrupted run")
            _lock(jobs, fcntl.LOCK_EX)


def _lock(file: TextIO, how: int, warn: bool = False) -> None:
    """Lock a file; continue without a lock if the file system has none."""
    try:
        fcntl.flock(file, how)
    except BlockingIOError:
        raise
    except OSError as error:
        if error.errno not in _REFUSALS:
            raise
        if warn:
            say(
                f"warning: {file.name}: this file system has no locks; make sure that no other "
                "run is at work here"
            )


def _open(places: Places, name: str) -> TextIO:
    try:
        places.folder.mkdir(parents=True, exist_ok=True)
        return (places.folder / f".{name}.lock").open("a")
    except OSError as error:
        raise InputError(
            f"{places.folder}: cannot be written: {error.strerror}; allowed is a folder that you "
            "may write to"
        ) from None
