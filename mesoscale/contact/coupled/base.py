"""The elastic half-space below the sites of a map, which repeats or stands alone.

Displacements by all pressures are one transform there and back. A map alone is transformed on
twice its sides, where its copies do not reach it (Hockney; doi:10.1016/S0043-1648(99)00113-1)."""

import math
from abc import ABC, abstractmethod

import numpy as np
from scipy import fft

from mesoscale.contact.coupled import free, half_space
from mesoscale.settings.contact import Body

Array = np.ndarray


class Base(ABC):
    """A half-space below nx x ny square sites.

    Attributes
    ----------
    shape : sites (nx, ny).
    spacing : of the sites, nm.
    e_star : effective modulus, GPa.
    compliance : of the waves of the transformed grid, nm/GPa.
    table : displacement of a site by the unit pressure on another, nm/GPa.
    transforms : how many there were, there and back.
    """

    repeats: bool

    def __init__(self, shape: tuple[int, int], spacing: float, e_star: float):
        self.shape = shape
        self.spacing = spacing
        self.e_star = e_star
        self.transforms = 0
        self.compliance, self.table = self._influences()
        self.single_compliance = self.compliance.astype(np.float32)
        self.room = np.empty(self.compliance.size, np.complex64)
        self.rows = np.arange(shape[0])

    @abstractmethod
    def _influences(self) -> tuple[Array, Array]:
        """`compliance` and `table`."""

    @abstractmethod
    def coarser(self, shape: tuple[int, int]) -> "Base":
        """The same half-space below so many sites, about every second one a side."""

    @abstractmethod
    def long_waves(self, shape: tuple[int, int]) -> Array:
        """Compliance (nm/GPa) of the waves of the map that a grid of few sites holds."""

    @property
    def site_area(self) -> float:
        """Of a site, nm^2."""
        return self.spacing**2

    @property
    def spring(self) -> float:
        """Displacement of a site by its own pressure, nm/GPa."""
        return float(self.table[0, 0])

    @property
    def stencil(self) -> Array:
        """Pressures (GPa) on nine sites that move the middle one alone by 1 nm, shape (9,)."""
        return half_space.stiffness_between_neighbours(self.table)

    def displacement(self, pressure: Array) -> Array:
        """Displacement (nm) of all sites by their pressures (GPa), shape (nx, ny), in the
        precision of the pressures.
        """
        self.transforms += 1
        single = pressure.dtype == np.float32
        compliance = self.single_compliance if single else self.compliance
        room = self.room if single else np.empty(compliance.size, np.complex128)
        columns = len(compliance)
        if columns > self.shape[1]:
            pressure = np.pad(pressure, ((0, 0), (0, columns - self.shape[1])))
        moved = half_space.convolve(pressure, self.rows, compliance, room, self.rows)
        return np.ascontiguousarray(moved[:, : self.shape[1]])


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

    def _influences(self) -> tuple[Array, Array]:
        pixels = self.shape[0]
        scale = self.length / self.e_star
        number = half_space.wave_numbers(pixels)
        number[0, 0] = np.inf
        softness = half_space.softness(pixels, self.length, self.bodies)
        compliance = (scale / math.pi) * softness / number
        return compliance, scale * half_space.influence(pixels, self.length, self.bodies)

    def coarser(self, shape: tuple[int, int]) -> "Repeated":
        """The same side with fewer sites."""
        return Repeated(shape, self.length / shape[0], self.e_star, self.bodies)

    def long_waves(self, shape: tuple[int, int]) -> Array:
        """Those of the grid itself."""
        rows = np.fft.fftfreq(shape[0], 1.0 / shape[0]).astype(int)
        return self.compliance[rows, : shape[1] // 2 + 1]


class Alone(Base):
    """Below a map that stands alone; displacements vanish far away."""

    repeats = False

    def _influences(self) -> tuple[Array, Array]:
        side: int = fft.next_fast_len(max(self.shape), real=True)  # pyright: ignore[reportAssignmentType]
        pixels = 2 * side
        table = (pixels * self.spacing / self.e_star) * free.free_influence(pixels)
        distance = np.minimum(np.arange(pixels), pixels - np.arange(pixels))
        compliance = np.real(np.asarray(fft.rfft2(table[np.ix_(distance, distance)])))
        return compliance, table

    def coarser(self, shape: tuple[int, int]) -> "Alone":
        """Every second site."""
        return Alone(shape, 2.0 * self.spacing, self.e_star)

    def long_waves(self, shape: tuple[int, int]) -> Array:
        """As if the map were repeated, which no wave much shorter than the map feels."""
        sides = np.array(self.shape) * self.spacing
        x = np.fft.fftfreq(shape[0], sides[0] / shape[0])[:, None]
        y = np.fft.rfftfreq(shape[1], sides[1] / shape[1])
        number = np.hypot(x, y)
        number[0, 0] = np.inf
        return 1.0 / (math.pi * self.e_star * number)
