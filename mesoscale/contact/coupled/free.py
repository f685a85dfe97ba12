"""The coupled contact of a map that stands alone on an elastic half-space, with nothing beside it.

The map lies in a corner of a periodic cell of at least twice its side, whose other sites are too
low to touch. The half-space is free: its influences are those of Love for pressed squares (Johnson,
Contact Mechanics, 1985, eq. 3.25), exact up to the side of the map, so that neighbouring cells do
not count (Hockney; doi:10.1016/S0043-1648(99)00113-1). The displacement vanishes far away: the
separation is that of the flat from the undeformed mean plane.
"""

import math
from functools import cached_property

import numpy as np
from scipy import fft

from mesoscale.contact.coupled import grid
from mesoscale.contact.coupled.engine import CoupledContact
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings


class FreeContact(CoupledContact):
    """A map (nx, ny) of square sites, contact at the lowest, on a free half-space."""

    def __init__(self, surface: np.ndarray, inputs: ContactInputs, settings: ContactSettings):
        spacing = settings.length_nm / settings.pixels
        side: int = fft.next_fast_len(max(surface.shape), real=True)  # pyright: ignore[reportAssignmentType]
        pixels = 2 * side
        padded = np.full((pixels, pixels), float(surface.max()) + 10.0 * pixels * spacing)
        padded[: surface.shape[0], : surface.shape[1]] = surface
        super().__init__(
            padded,
            inputs,
            settings.model_copy(update={"pixels": pixels, "length_nm": pixels * spacing}),
        )
        self.map_shape = surface.shape
        self.rms = float(surface.std())
        self.table = free_influence(pixels)
        self.stiffness = 1.0 / (self.scale * float(self.table[0, 0]))
        self.rise = 0.0  # pressures only lower a free surface

    @property
    def capacity(self) -> float:
        """Largest force (nN) to which the contact is followed: without a hardness any."""
        area = math.prod(self.map_shape) * self.site_area
        return self.BEARING_SHARE * self.hardness.pressure(area) * area if self.flows else math.inf

    def fields(self) -> tuple[np.ndarray, np.ndarray]:
        """Pressure (GPa) and gap (nm; 0 in contact) of the map at the current separation, shapes
        (nx, ny).
        """
        rows, columns = self.map_shape
        pressure, gap = (field[:rows, :columns] for field in super().fields())
        return pressure, gap

    @cached_property
    def whole(self) -> grid.Grid:
        """The half-space of all sites."""
        whole = super().whole
        whole.table = self.table
        distance = np.minimum(np.arange(self.n), self.n - np.arange(self.n))
        whole.compliance = self.scale * np.real(
            np.asarray(fft.rfft2(self.table[np.ix_(distance, distance)]))
        )
        whole.single_compliance = whole.compliance.astype(np.float32)
        return whole


def free_influence(pixels: int) -> np.ndarray:
    """Displacement (in L / E*) at sites 0 .. pixels/2 in x and y from a unit pressure on one site
    (in E*).

    Shape (pixels // 2 + 1, pixels // 2 + 1), as `half_space.influence` of a periodic cell.
    """
    edge = np.arange(pixels // 2 + 2) - 0.5
    x = edge[:, None]
    y = edge[None, :]
    corners = x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))
    return np.ascontiguousarray(np.diff(np.diff(corners, axis=0), axis=1)) / (math.pi * pixels)
