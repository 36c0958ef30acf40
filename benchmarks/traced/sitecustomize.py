"""Python imports this module when it starts, and each process lists its processor time."""

import atexit
import json
import os
import sys


def _leave(parent: int, file: str) -> None:
    times = os.times()
    line = json.dumps([os.getpid(), parent, sys.orig_argv[1:], times.user + times.system])
    with open(file, "a", encoding="utf-8") as opened:
        opened.write(line + "\n")


if "PROCESSES" in os.environ:
    atexit.register(_leave, os.getppid(), os.environ["PROCESSES"])
