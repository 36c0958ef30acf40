"""Short processes search for garbage rarely, and still do what they registered for their end."""

import subprocess
import sys

from gearmesh.pipeline import notebooks

PROGRAM = """
import atexit, gc
atexit.register(lambda: print("registered before"))
from gearmesh.garbage import search_rarely
search_rarely()
print(gc.get_threshold()[0] >= 100_000)
atexit.register(lambda: print("registered after"))
"""


def test_what_is_registered_for_the_end_still_happens():
    finished = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True
    )
    assert finished.stdout.splitlines() == ["True", "registered after", "registered before"]
    assert not finished.stderr


def test_kernels_have_the_setting():
    """IPython runs this text with its settings as `c`; a fault in it would only cost time."""
    program = (
        "from types import SimpleNamespace\nc = SimpleNamespace(IPKernelApp=SimpleNamespace())\n"
    )
    program += notebooks._KERNEL_SETTINGS + "\nimport gc; print(gc.get_threshold()[0])"
    finished = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert int(finished.stdout) >= 100_000
