"""The surface of a contact, and where the flat has reached it, as files of other programs.

The grid is that of `contact/spots.h5`: every n-th site where the surface has more than 256 a side.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.spots import MOST_PIXELS
from mesoscale.extras import needs
from workflow.report.available import Results


@dataclass(frozen=True)
class ContactMap:
    """Heights towards the flat, and the load at which the flat reaches each pixel.

    Attributes
    ----------
    pixel_nm : side of a pixel.
    towards_flat_nm : shape (m, m), the first index along x.
    reached_nN : repulsive force on the cell; not a number where it is never reached.
    """

    pixel_nm: float
    towards_flat_nm: NDArray[np.float64]
    reached_nN: NDArray[np.float64]

    @property
    def side_nm(self) -> float:
        """Length of the map."""
        return self.pixel_nm * self.towards_flat_nm.shape[0]


def map_of(results: Results) -> ContactMap:
    """The map of a scene with its contact computed."""
    groups, attributes, _ = results.h5("contact/spots.h5")
    contact = json.loads(results.h5("contact/nominal.h5")[1]["contact"])
    spots = groups["spots"]
    heights = spots["towards_flat_nm"]
    sites_a_pixel = max(1, -(-contact["pixels"] // MOST_PIXELS))
    pixel_nm = float(attributes["length_nm"]) / contact["pixels"] * sites_a_pixel
    step = spots["step"]
    reached_nN = np.where(step < 0, np.nan, spots["repulsive_nN"][np.maximum(step, 0)])
    return ContactMap(pixel_nm, heights, reached_nN)


def write_surfaces(folder: Path, contact: ContactMap) -> list[str]:
    """Heights as X3P (ISO 25178-72) and GWY; names the files.

    Raises
    ------
    MissingExtra
    """
    with needs("export"):
        from SurfaceTopography import Topography
    side = (contact.side_nm, contact.side_nm)
    surface = Topography(contact.towards_flat_nm, side, unit="nm", periodic=True)
    surface.to_x3p(str(folder / "surface.x3p"))
    surface.to_gwy(str(folder / "surface.gwy"))
    return ["surface.x3p", "surface.gwy"]


def write_vtk(folder: Path, contact: ContactMap) -> list[str]:
    """Heights and loads as image data of VTK, a cell a pixel; names the file.

    Raises
    ------
    MissingExtra
    """
    with needs("export"):
        from pyevtk.hl import imageToVTK
    fields = {
        "towards_flat_nm": contact.towards_flat_nm,
        "reached_nN": contact.reached_nN,
    }
    cells = {name: np.asfortranarray(values[:, :, None]) for name, values in fields.items()}
    spacing = (contact.pixel_nm, contact.pixel_nm, contact.pixel_nm)
    imageToVTK(str(folder / "surface"), spacing=spacing, cellData=cells)
    return ["surface.vti"]
