"""A word while a new installation compiles its loops, which takes seconds once."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

from numba.core.event import Event, Listener, install_listener


class Announcer(Listener):
    """Says once that loops are compiled, and then which one it is at."""

    def __init__(self, stream: TextIO):
        self.stream = stream
        self.compiled = 0

    def on_start(self, event: Event) -> None:
        """Count a loop that is not in the cache; on a terminal the line counts with it."""
        self.compiled += 1
        line = "asperity: compiling the contact solver, once on this installation"
        if self.stream.isatty():
            print(f"\r{line}: loop {self.compiled}", end="", file=self.stream, flush=True)
        elif self.compiled == 1:
            print(line, file=self.stream, flush=True)

    def on_end(self, event: Event) -> None:
        """Nothing: the next loop or the end follows."""

    def close(self) -> None:
        """End the line of a terminal."""
        if self.compiled and self.stream.isatty():
            print(file=self.stream)


@contextmanager
def announced() -> Iterator[None]:
    """Announce on standard error what is compiled meanwhile."""
    announcer = Announcer(sys.stderr)
    with install_listener("numba:compile", announcer):
        try:
            yield
        finally:
            announcer.close()
