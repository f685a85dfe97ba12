"""Contact area: one definition for every run, calibrated on known sections (`hardness.area`).

Atoms nearer to the counterface than a depth (or beyond it) touch.  The space between touching atoms
counts as contact where a disc of the closing radius does not fit; enclosed holes do too.  The rim
lies one rim radius outside the outermost touching atoms.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_fill_holes, distance_transform_edt
from scipy.spatial import KDTree

from asperity.guards.errors import InputError
from atomistic.potentials import Potential


@dataclass(frozen=True)
class Area:
    """Definition of the contact area, fixed by known sections before any hardness; in Å.

    Attributes
    ----------
    depth_A : atoms nearer than this to the counterface, or beyond it, touch.
    closing_A : the space between touching atoms is contact where a disc of this radius does not
        fit.
    rim_A : the rim of the contact lies this far outside the outermost touching atoms.
    """

    depth_A: float = 0.5
    closing_A: float = 4.0
    rim_A: float = 1.7
    grid_A: float = 0.5


def contact_area(
    touching_A: np.ndarray, cell_A: tuple[float, float], area: Area, centre_A: tuple[float, float]
) -> float:
    """Area of the contact, Å².

    Parameters
    ----------
    touching_A : positions in the plane, shape (atoms, 2).
    cell_A : periodic lengths in x and y.
    centre_A : middle of the contact; the grid is rolled so that the contact does not wrap around,
        where holes would stay open.
    """
    share = np.sum(contact_map(touching_A, cell_A, area, centre_A))
    return float(share * _spacing(cell_A, area).prod())


def contact_map(
    touching_A: np.ndarray, cell_A: tuple[float, float], area: Area, centre_A: tuple[float, float]
) -> np.ndarray:
    """Share of each cell in contact; the middle of the array is `centre_A`.

    Discs of `closing_A` about the touching atoms, holes filled, cut back to `rim_A`; cells that the
    rim crosses count in part, so that the area does not jump with the grid.
    """
    spacing = _spacing(cell_A, area)
    cell = np.asarray(cell_A, dtype=float)
    shape = np.round(cell / spacing).astype(int)
    if len(touching_A) == 0:
        return np.zeros(shape)
    shifted = np.mod(touching_A - np.asarray(centre_A) + cell / 2, cell)
    # a place that rounding puts on the far edge of the cell lies outside it for the tree
    tree = KDTree(np.where(shifted < cell, shifted, 0.0), boxsize=cell)
    windows = [_reach(shifted[:, k], area.closing_A, spacing[k], shape[k]) for k in range(2)]
    window = tuple(windows)
    numbers = np.meshgrid(*(np.arange(count) + 0.5 for count in shape), indexing="ij")
    middles = np.stack(numbers, axis=-1)[window] * spacing
    distance, _ = tree.query(middles, distance_upper_bound=2 * area.closing_A)
    marked = np.asarray(binary_fill_holes(distance <= area.closing_A), dtype=bool)
    if marked.all():
        return np.ones(shape)
    margin = int(np.ceil(area.closing_A / spacing.min())) + 1
    wide = np.pad(marked, margin, mode="wrap")
    outside = np.asarray(distance_transform_edt(wide, sampling=spacing))[
        margin:-margin, margin:-margin
    ]
    shares = np.zeros(shape)
    inner = area.closing_A - area.rim_A
    shares[window] = np.clip((outside - inner) / spacing.mean(), 0, 1)
    return shares


def shares_in_contact(
    places_A: np.ndarray,
    shares: np.ndarray,
    cell_A: tuple[float, float],
    centre_A: tuple[float, float],
) -> np.ndarray:
    """Share of the contact map's cell at each place, shape (places,).

    Parameters
    ----------
    places_A : positions in the plane, shape (places, 2).
    shares : of `contact_map`, with the same cell and centre.
    """
    cell = np.asarray(cell_A, dtype=float)
    inside = np.mod(places_A - np.asarray(centre_A) + cell / 2, cell) / cell
    numbers = (inside * shares.shape).astype(int)
    column, row = np.minimum(numbers, np.array(shares.shape) - 1).T
    return shares[column, row]


def _reach(places_A: np.ndarray, reach_A: float, spacing_A: float, cells: int) -> slice:
    """Cells within reach of the places and one more on either side: small contacts cost less.

    All cells where the reach crosses the edge.
    """
    first = int(np.floor((places_A.min() - reach_A) / spacing_A)) - 1
    last = int(np.ceil((places_A.max() + reach_A) / spacing_A)) + 1
    if first < 0 or last > cells:
        return slice(0, cells)
    return slice(first, last)


def _spacing(cell_A: tuple[float, float], area: Area) -> np.ndarray:
    cell = np.asarray(cell_A, dtype=float)
    return cell / np.maximum(1, np.round(cell / area.grid_A))


def calibrated(potential: Potential) -> float:
    """Largest error of the area with a potential's glass, as a fraction.

    Raises
    ------
    InputError : the potential's file has no calibration.
    """
    if potential.contact_area is None:
        raise InputError(
            f"potential {potential.name}: no calibration of the contact area; measure it (python -m"
            " evidence hardness.area) and write its largest error as `contact_area` into the"
            " potential's file (see config/potentials/pmmcs.yaml)"
        )
    return potential.contact_area.error
