"""The one error type for mistakes of the user's input, and its kind for what was not computed."""

from asperity.guards.errors import InputError

__all__ = ["InputError", "NotComputed"]


class NotComputed(InputError):
    """A state outside the computed range; nothing is extrapolated."""
