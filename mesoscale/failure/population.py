"""Switches of all that a scene leaves uncertain, each on its pad: does it fail, and how much
attraction does it bear?

The reserve of a switch is the logarithm of the factor on its attraction with which it just fails.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol
from zlib import crc32

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from mesoscale.answer.points import Point, kinds, point_of, values_at
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import DeviceSettings
from mesoscale.switch import switch_of
from mesoscale.switch.reserve import LEAST_TIMES, MOST_TIMES, STEP, Attracted

Array = NDArray[np.float64]


class Pressed(Protocol):
    """A pad that was pressed: its mean curves, and those of two halves of its cells."""

    @property
    def curves(self) -> PadCurves: ...
    @property
    def halves(self) -> tuple[PadCurves, PadCurves]: ...


Press = Callable[[Point, int, int], Pressed]
"""Presses the pad of a point: with so many times the cells of the scene, and surfaces by a number.
"""


@dataclass(frozen=True)
class FailureNumerics:
    """How rare failures are looked for; no scene sets these choices."""

    first: int = 48
    """Switches of the first response beside those of the answer."""

    fewest: int = 32
    """Of these may be solved at least."""

    rounds: int = 8
    """Switches are added so often where a failure is likely."""

    own_rounds: int = 3
    """The last of these are at the scene's own hold voltage and attraction: a curved limit is then
    known where it counts most."""

    batch: int = 16
    """So many at once."""

    runs: int = 64
    """Switches that correct a probability at most."""

    known: float = 0.15
    """Relative error of that correction that is enough; that of the samples is near 0.1."""

    wide: float = 2.0
    """Half of the first switches have this many times the deviations of the inputs: rare events are
    far out."""

    surer_cells: int = 4
    """Times as many cells has a pad whose halves disagree on whether the switch fails."""

    surfaces: int = 4000
    """Numbers of surfaces."""

    least_times: float = LEAST_TIMES
    """Least factor on the attraction that is tried."""

    most_times: float = MOST_TIMES
    """Largest factor on the attraction that is tried."""

    step: float = STEP
    """Difference of their logarithms to which the reserve is known."""

    span: float = 1.5
    """Largest hold voltage of the curve over that of the scene."""

    voltages: int = 5
    """Of the curve."""

    rough: tuple[float, ...] = (0.98, 0.84, 0.5, 0.16, 0.02)
    """Probabilities of the RMS heights among which the least is sought, from the roughest."""

    springs: tuple[float, float] = (0.5, 2.0)
    """Springs among which the least is sought, over that of the scene."""

    stiff_springs: int = 4
    """Of these, from the stiffest to the scene's own, as long as pads cannot be pressed."""

    spring_runs: int = 32
    """Switches that are solved with each spring. They know a probability to some 25 %, and a spring
    to 1 or 2 %."""

    confidence: float = 0.9
    """That no more fail than allowed, by what is common to all devices and not known."""

    near: float = 0.02
    """Difference of logarithms to which attractions and springs are sought."""

    far: float = 8.0
    """Deviations beyond which a probability is 1 in double precision: a number would be endless."""


FAILURE = FailureNumerics()
"""What every scene uses."""


@dataclass(frozen=True)
class Population:
    """All switches that the scene allows, as standard normal numbers z: inputs, D0 and properties
    of the device.

    Attributes
    ----------
    table, settings, cutoffs_nm : as `mesoscale.answer.points` takes them.
    release_V : a switch that is still closed at this voltage has failed.
    press : of the pads.
    solved : probabilities (m, dimension) of switches whose pads were pressed at the hold voltage,
        and these pads.
    """

    table: InputTable
    settings: DeviceSettings
    cutoffs_nm: tuple[float, float]
    release_V: float
    press: Press
    solved: tuple[Array, Sequence[Pressed]]

    @property
    def dimension(self) -> int:
        """Number of standard normal numbers."""
        return len(self.names)

    @property
    def names(self) -> list[str]:
        """What the numbers stand for."""
        return [*self.table.names, "gap_cutoff_nm", *self.settings.varied]

    @property
    def common(self) -> NDArray[np.bool_]:
        """Which of the numbers are one unknown value for all devices."""
        return np.array([kind == "common" for kind in kinds(self.table, self.settings)], bool)

    @property
    def spring(self) -> str:
        """The setting of the device that is its spring."""
        return self.settings.designed[0]

    @property
    def hold_V(self) -> float:
        """Hold voltage of the scene; where it has none, that of the pull-in without contact."""
        return switch_of(self.settings).hold_V

    @cached_property
    def positive(self) -> NDArray[np.bool_]:
        """Which of the numbers stand for what is above zero."""
        ends = np.outer([-FAILURE.far, FAILURE.far], np.ones(self.dimension))
        return values_at(ndtr(ends), self.table, self.settings, self.cutoffs_nm).min(axis=0) > 0.0

    def columns(self, z: Array, hold_V: Array) -> Array:
        """What the response depends on: logarithms of what is positive, as the reserve is a
        logarithm.
        """
        values = values_at(
            ndtr(np.clip(z, -FAILURE.far, FAILURE.far)), self.table, self.settings, self.cutoffs_nm
        )
        logs = np.log(np.maximum(values, np.finfo(float).tiny))
        return np.column_stack([np.where(self.positive, logs, values), hold_V])

    def points(self, z: Array, hold_V: float) -> list[Point]:
        """The switches of numbers (m, dimension)."""
        held = self.settings.model_copy(update={"hold_voltage_V": hold_V})
        rows = values_at(ndtr(z), self.table, self.settings, self.cutoffs_nm)
        return [point_of(row, self.table.names, held) for row in rows]

    def reserves(
        self,
        z: Array,
        hold_V: float,
        pads: Sequence[Pressed] | None = None,
        about: Array | None = None,
    ) -> Array:
        """Reserves of switches, shape (m,), on pads that are pressed where none are given; NaN
        where one cannot be.

        Parameters
        ----------
        about : guesses of them, shape (m,), which spare tries and change no reserve.
        """
        guesses: list[float | None] = [None] * len(z)
        if about is not None:
            guesses = about.tolist()
        reserves = np.full(len(z), np.nan)
        for k, point in enumerate(self.points(z, hold_V)):
            with suppress(InputError):
                pad = self.press(point, 1, surfaces_number(z[k])) if pads is None else pads[k]
                reserves[k] = self._quickly(point, pad.curves).reserve(about=guesses[k])
        return reserves

    def failed(self, z: Array, hold_V: float, times: float) -> NDArray[np.bool_]:
        """Which switches fail, shape (m,); one that cannot be solved has failed."""
        points = self.points(z, hold_V)
        return np.array(
            [
                self._fails(point, surfaces_number(row), times)
                for row, point in zip(z, points, strict=True)
            ]
        )

    def _fails(self, point: Point, surface: int, times: float) -> bool:
        def fails(pad: PadCurves) -> bool:
            return Attracted(point.device, pad, self.release_V).fails(times)

        try:
            pad = self.press(point, 1, surface)
            failed = fails(pad.curves)
            if any(self._quickly(point, half).fails(times) != failed for half in pad.halves):
                surer = self.press(point, FAILURE.surer_cells, surface)
                failed = fails(surer.curves)
        except InputError:
            return True
        return failed

    def _quickly(self, point: Point, pad: PadCurves) -> Attracted:
        """A switch that is only compared with others."""
        return Attracted(point.device, pad, self.release_V, coarse=True, quickly=True)


def surfaces_number(z: Array) -> int:
    """Number of the surfaces of a switch."""
    return crc32(z.tobytes()) % FAILURE.surfaces
