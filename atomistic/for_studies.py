"""What a stage of atoms tells the driver of all studies: numerical choices to vary, and hard cases.

The driver is `mesoscale.studies.driver`, which this package does not know. The tuples have the
fields of its classes.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from asperity.guards.errors import InputError


class Deviations(NamedTuple):
    """How far one value of a choice lies from the reference, and what one computation takes.

    Attributes
    ----------
    values : in the units of the quantities, shape (samples, quantities).
    noise : standard error of each quantity's error by what the samples do not tell, shape
        (quantities,).
    cpu_s : processor seconds.
    """

    values: np.ndarray
    noise: np.ndarray
    cpu_s: float


class Variation(NamedTuple):
    """One numerical choice.

    Attributes
    ----------
    quantities : name and unit of each.
    values : those tried, cheapest first, each with the function that tells how far it is off.
    shipped : the value in use.
    reference : what they are compared with, in words.
    samples : what the samples are, in words.
    """

    name: str
    quantities: Sequence[tuple[str, str]]
    values: Sequence[tuple[Any, Callable[[], Deviations]]]
    shipped: Any
    reference: str
    samples: str


Verdict = tuple[bool, str]
"""Whether all held, and the numbers or words behind it."""


class HardCase(NamedTuple):
    """A stiff or extreme case: what is hard, what must hold, and the judge that runs it."""

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
        result = compute()
    except (InputError, *kinds) as error:
        message = str(error)
        return because in message and "\n" not in message, message
    return False, f"not refused: {result}"
