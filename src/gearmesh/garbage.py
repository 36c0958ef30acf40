"""Python's search for garbage, in processes that end soon."""

import atexit
import gc

_NEW_OBJECTS = 100_000


def search_rarely() -> None:
    """Let this process search for garbage rarely, and not at its end.

    Imports and compilation make objects that stay. Python would search them again and again, and
    twice when the process ends: up to a third of the time of a short one.
    """
    gc.set_threshold(_NEW_OBJECTS)
    atexit.register(gc.freeze)
