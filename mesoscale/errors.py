"""The one error type for mistakes of the user's input, and its kind for what was not computed."""


class InputError(ValueError):
    """Bad input: the message is one line naming file, key, value, what is accepted and what to do."""


class NotComputed(InputError):
    """A state outside the computed range; nothing is extrapolated."""
