"""The one error type for mistakes of the user's input."""


class InputError(ValueError):
    """Bad input: the message is one line naming file, key, value, what is accepted and what to
    do.
    """
