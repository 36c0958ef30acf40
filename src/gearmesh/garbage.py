"""Settings of Python's garbage collector for short processes."""

import atexit
import gc

_NEW_OBJECTS = 100_000


def search_rarely() -> None:
    """Let this process search for garbage rarely, and not when it ends.

    Imports and compilation make many objects that stay. By default Python would search all of them
    again and again, and twice more when the process ends. In a short process these searches take
    up to a third of the time.
    """
    gc.set_threshold(_NEW_OBJECTS)
    atexit.register(gc.freeze)
