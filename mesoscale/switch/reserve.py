"""The reserve of a switch: how much attraction it bears before it fails."""

from collections.abc import Callable

import numpy as np

from mesoscale.errors import InputError, NotComputed
from mesoscale.pad.curves import DOUBLINGS, PadCurves, deepened
from mesoscale.settings import DeviceSettings
from mesoscale.switch import switch_of

LEAST_TIMES = 0.1
MOST_TIMES = 30.0
"""Factors on the attraction between which the reserve is sought."""
STEP = 0.1
"""Difference of their logarithms to which a population's reserves are known."""


class Attracted:
    """A switch whose attraction can be changed.

    Parameters
    ----------
    release_V : a switch that is still closed at this voltage has failed.
    coarse : see `switch_of`.
    quickly : see `closed_on` of a beam.
    """

    def __init__(
        self,
        settings: DeviceSettings,
        pad: PadCurves,
        release_V: float,
        coarse: bool = False,
        quickly: bool = False,
    ) -> None:
        self.settings = settings
        self.pad = pad
        self.release_V = release_V
        self.coarse = coarse
        self.quickly = quickly
        self._doublings = 0
        self._still_closed: Callable[[float, float], bool] | None = None

    def fails(self, times: float) -> bool:
        """Whether the switch fails with `times` its attraction.

        Raises
        ------
        InputError : the pad is pressed beyond what is known of it, or the electrode cannot be
            solved.
        """
        while True:
            try:
                if self._still_closed is None:
                    switch = switch_of(self.settings, self.coarse)
                    self._still_closed = switch.closed_on(self.pad, self.quickly)
                return self._still_closed(self.release_V, times)
            except NotComputed:
                if self._doublings == DOUBLINGS:
                    raise
                self._doublings += 1
                self.pad = deepened(self.pad)
                self._still_closed = None

    def reserve(self, step: float = STEP, about: float | None = None) -> float:
        """Logarithm of the factor on the attraction with which the switch just fails, known to half
        a step.

        Parameters
        ----------
        about : where it is looked for first; a good guess spares half of the tries, a bad one
            changes no reserve.
        """
        low = float(np.log(LEAST_TIMES))
        high = float(np.log(MOST_TIMES))
        steps = 2 ** int(np.ceil(np.log2((high - low) / step)))
        width = (high - low) / steps

        def fails_at(number: int) -> bool:
            try:
                return self.fails(float(np.exp(low + number * width)))
            except InputError:
                return True

        if about is None:
            failing = _first_failing(fails_at, steps, steps // 2, steps // 4)
        else:
            guess = round((np.clip(about, low, high) - low) / width)
            failing = _first_failing(fails_at, steps, min(max(guess, 1), steps - 1), 1)
        return low + (failing - 0.5) * width


def _first_failing(fails_at: Callable[[int], bool], last: int, guess: int, stride: int) -> int:
    """First number that fails, where 0 does not and the last does.

    Strides from a guess double until they enclose it, then halves are tried.
    """
    bearing = 0
    failing = last
    number = guess
    while failing - bearing > 1:
        if fails_at(number):
            failing = number
            number -= stride
        else:
            bearing = number
            number += stride
        stride *= 2
        if not bearing < number < failing:
            number = (bearing + failing) // 2
    return failing
