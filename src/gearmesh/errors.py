"""The error that users see."""


class InputError(ValueError):
    """Bad input, in one line: which key or file, what was found, what is allowed.

    A text of the input that the message quotes may hold line breaks; they become spaces.
    """

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.split()))


class NoOrbit(RuntimeError):
    """No periodic orbit was found, or a branch of orbits could not be followed; and why."""
