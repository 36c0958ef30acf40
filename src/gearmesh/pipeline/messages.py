"""Lines that the pipeline prints."""

import sys

BAD_INPUT = 2
"""Exit status for a mistake in the input."""


def say(line: str) -> None:
    """Print a line of the pipeline's own."""
    print(f"gearmesh: {line}", file=sys.stderr, flush=True)
