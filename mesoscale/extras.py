"""Packages of the optional extras: where one is absent, one line says what to install."""

from collections.abc import Iterator
from contextlib import contextmanager


class MissingExtra(ImportError):
    """A package of an optional extra is not installed; the message says how to get it."""


@contextmanager
def needs(extra: str) -> Iterator[None]:
    """Imports inside belong to an extra of the distribution `asperity-contact`.

    Raises
    ------
    MissingExtra
    """
    try:
        yield
    except ModuleNotFoundError as error:
        raise MissingExtra(
            f"{error.name} is not installed; it belongs to an extra: pip install"
            f" 'asperity-contact[{extra}]'"
        ) from None
