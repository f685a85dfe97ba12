"""What a stage of atoms tells the driver of all studies: numerical choices to vary, and hard cases.

The driver is `mesoscale.studies.driver`, which this package does not know. The tuples have the fields of its classes.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from asperity.guards.errors import InputError


class Errors(NamedTuple):
    """Errors of one value of a choice, of each quantity, and processor seconds of one computation."""

    error: Sequence[float]
    own_error: Sequence[float]
    cpu_s: float


class Variation(NamedTuple):
    """One numerical choice.

    Attributes
    ----------
    quantities : name and unit of each.
    values : those tried, cheapest first, each with the function that computes the quantities on each sample, shape
        (samples, quantities), or their errors.
    shipped : the value in use.
    reference : what the errors are against, in words.
    best : the quantities there, shape (samples, quantities); None: the values tell their errors.
    samples : what the samples are, in words.
    """

    name: str
    quantities: Sequence[tuple[str, str]]
    values: Sequence[tuple[Any, Callable[[], np.ndarray | Errors]]]
    shipped: Any
    reference: str
    best: Callable[[], np.ndarray] | None = None
    samples: str = ""


Verdict = tuple[bool, str]
"""Whether all held, and the numbers or words behind it."""


class HardCase(NamedTuple):
    """A stiff or extreme case: what is hard about it, what must hold, and the judge that runs it."""

    name: str
    description: str
    checks: str
    judge: Callable[[], Verdict]


def refused(compute: Callable[[], object], because: str, *kinds: type[Exception]) -> Verdict:
    """Whether something is refused in one line that says why.

    Parameters
    ----------
    because : words of the message.
    kinds : errors that count as a refusal beside `InputError`.
    """
    try:
        found = compute()
    except (InputError, *kinds) as error:
        message = str(error)
        return because in message and "\n" not in message, message
    return False, f"not refused: {found}"
