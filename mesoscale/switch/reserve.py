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

    def reserve(self, step: float = STEP) -> float:
        """Logarithm of the factor on the attraction with which the switch just fails, known to half
        a step.
        """
        low = np.log(LEAST_TIMES)
        high = np.log(MOST_TIMES)
        while high - low > step:
            middle = 0.5 * (low + high)
            try:
                failed = self.fails(float(np.exp(middle)))
            except InputError:
                failed = True
            low, high = (low, middle) if failed else (middle, high)
        return float(0.5 * (low + high))
