"""The elastic half-space below the sites of a map, which repeats or stands alone.

Displacements by all pressures are one transform there and back. A map alone is transformed on
twice its sides, where its copies do not reach it (Hockney; doi:10.1016/S0043-1648(99)00113-1).
"""

import math
from abc import ABC, abstractmethod
from functools import cached_property
from typing import Any

import numpy as np
from scipy import fft

from mesoscale.contact.coupled import free, half_space
from mesoscale.contact.coupled.devices import is_numpy, namespace
from mesoscale.settings.contact import Body

NEAR = 5  # sites a side of the table of displacements by near sites

Array = np.ndarray


class Base(ABC):
    """A half-space below nx x ny square sites; what its transforms need is made at the first one.

    Attributes
    ----------
    repeats : whether the map does.
    shape : sites (nx, ny).
    spacing : of the sites, nm.
    e_star : effective modulus, GPa.
    transforms : how many there were, there and back.
    brought : the compliance in double and in single precision, once it is on another device.
    """

    repeats: bool

    def __init__(self, shape: tuple[int, int], spacing: float, e_star: float):
        self.shape = shape
        self.spacing = spacing
        self.e_star = e_star
        self.transforms = 0
        self.brought: tuple[Any, Any] | None = None

    @abstractmethod
    def compliance(self) -> Array:
        """Compliance (nm/GPa) of the waves of the transformed grid; made anew, for its memory."""

    @abstractmethod
    def _near(self) -> Array:
        """Make `near`."""

    @abstractmethod
    def coarser(self, shape: tuple[int, int]) -> "Base":
        """The same half-space below so many sites, about half as many a side."""

    @abstractmethod
    def long_waves(self, shape: tuple[int, int]) -> Array:
        """Compliance (nm/GPa) of the waves of the map that a grid of few sites holds."""

    @property
    def site_area(self) -> float:
        """Of a site, nm^2."""
        return self.spacing**2

    @cached_property
    def spring(self) -> float:
        """Displacement of a site by its own pressure, nm/GPa."""
        return float(self.near[0, 0])

    @cached_property
    def near(self) -> Array:
        """Displacement (nm/GPa) of a site by the pressure on another, 0 to 4 sites away, (5, 5)."""
        return self._near()

    @cached_property
    def single_compliance(self) -> Array:
        """`compliance` in single precision."""
        return self.compliance().astype(np.float32)

    @cached_property
    def room(self) -> Array:
        """For spectra in single precision."""
        return np.empty(self.single_compliance.size, np.complex64)

    def displacement(self, pressure: Array) -> Array:
        """Displacement (nm) of all sites by their pressures (GPa), shape (nx, ny), in the
        precision of the pressures, and on their device.
        """
        self.transforms += 1
        if not is_numpy(pressure):
            return self._displacement_there(pressure)
        if pressure.dtype == np.float32:
            compliance = self.single_compliance
            room = self.room
        else:
            compliance = self.compliance()
            room = np.empty(compliance.size, np.complex128)
        columns = len(compliance)
        rows = np.arange(self.shape[0])
        if columns > self.shape[1]:
            pressure = np.pad(pressure, ((0, 0), (0, columns - self.shape[1])))
        moved = half_space.convolve(pressure, rows, compliance, room, rows)
        return np.ascontiguousarray(moved[:, : self.shape[1]])

    def _displacement_there(self, pressure: Any) -> Any:
        """By the transforms of another library."""
        xp = namespace(pressure)
        if self.brought is None:
            double = xp.asarray(self.compliance(), device=pressure.device)
            self.brought = (double, xp.astype(double, xp.float32))
        double, single = self.brought
        compliance = single if pressure.dtype == xp.float32 else double
        sides = (compliance.shape[0], compliance.shape[0])
        spectrum = xp.fft.rfftn(pressure, s=sides, axes=(0, 1))
        spectrum *= compliance
        moved = xp.fft.irfftn(spectrum, s=sides, axes=(0, 1))
        rows, columns = self.shape
        return moved[:rows, :columns]


class Repeated(Base):
    """Below a square map that repeats; the mean of its displacements is 0."""

    repeats = True

    def __init__(
        self,
        shape: tuple[int, int],
        spacing: float,
        e_star: float,
        bodies: tuple[Body, ...] = (),
    ):
        self.bodies = bodies
        super().__init__(shape, spacing, e_star)

    @property
    def length(self) -> float:
        """Side of the map, nm."""
        return self.spacing * self.shape[0]

    def compliance(self) -> Array:
        """Of the waves of the map."""
        return half_space.wave_compliance(self.shape[0], self.length, self.e_star, self.bodies)

    def _near(self) -> Array:
        """From the sum of the waves at these sites."""
        compliance = self.compliance()
        pixels = self.shape[0]
        compliance[:, 1 : (pixels + 1) // 2] *= 2.0  # the other half of the waves
        angle = 2.0 * np.pi / pixels * np.arange(NEAR)
        row_waves = np.cos(angle[:, None] * np.arange(pixels))
        column_waves = np.cos(angle[:, None] * np.arange(pixels // 2 + 1))
        return row_waves @ compliance @ column_waves.T / pixels**2

    def coarser(self, shape: tuple[int, int]) -> "Repeated":
        """The same side with fewer sites."""
        return Repeated(shape, self.length / shape[0], self.e_star, self.bodies)

    def long_waves(self, shape: tuple[int, int]) -> Array:
        """Those of the grid itself."""
        rows = np.fft.fftfreq(shape[0], 1.0 / shape[0]).astype(int)
        return self.single_compliance[rows, : shape[1] // 2 + 1]


class Alone(Base):
    """Below a map that stands alone; displacements vanish far away."""

    repeats = False

    def compliance(self) -> Array:
        """Of the waves of twice the map; its even table has a cosine transform."""
        side: int = fft.next_fast_len(max(self.shape), real=True)  # pyright: ignore[reportAssignmentType]
        pixels = 2 * side
        table = free.free_influence(pixels)
        table *= pixels * self.spacing / self.e_star
        waves = np.asarray(fft.dctn(table, type=1, overwrite_x=True))
        return waves[np.minimum(np.arange(pixels), pixels - np.arange(pixels))]

    def _near(self) -> Array:
        """Love's pressed square; its influence knows no size of a grid."""
        few = 2 * (NEAR - 1)
        return few * self.spacing / self.e_star * free.free_influence(few)

    def coarser(self, shape: tuple[int, int]) -> "Alone":
        """Sites twice as wide."""
        return Alone(shape, 2.0 * self.spacing, self.e_star)

    def long_waves(self, shape: tuple[int, int]) -> Array:
        """As if the map were repeated, which no wave much shorter than the map feels."""
        sides = np.array(self.shape) * self.spacing
        x = np.fft.fftfreq(shape[0], sides[0] / shape[0])[:, None]
        y = np.fft.rfftfreq(shape[1], sides[1] / shape[1])
        number = np.hypot(x, y)
        number[0, 0] = np.inf
        return 1.0 / (math.pi * self.e_star * number)
