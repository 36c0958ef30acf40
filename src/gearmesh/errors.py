"""The one kind of error that a user is meant to see."""


class InputError(ValueError):
    """Bad input, told in one line: which key or file, what was found, what is allowed."""
