"""Contact area: one definition, used for every run.

Atoms nearer to the counterface than a depth Δ (or beyond it) touch.  Each marks a disc on a grid in the
plane of contact; holes enclosed by marked cells count as contact.  Δ is the largest systematic error of the
hardness: docs/hardness.md gives its size.
"""

import numpy as np
from scipy.ndimage import binary_fill_holes


def contact_area(
    touching_A: np.ndarray,
    cell_A: tuple[float, float],
    disc_A: float,
    grid_A: float,
    centre_A: tuple[float, float],
) -> float:
    """Projected area of discs around the touching atoms, holes filled, Å².

    Parameters
    ----------
    touching_A : positions in the plane, shape (atoms, 2).
    cell_A : periodic lengths in x and y.
    disc_A : radius of the discs.
    grid_A : grid spacing asked for; rounded so that the cell holds a whole number.
    centre_A : middle of the contact; the grid is rolled so that the contact does not wrap around, where holes
        would stay open.
    """
    return float(np.sum(contact_map(touching_A, cell_A, disc_A, grid_A, centre_A))) * _spacing(cell_A, grid_A).prod()


def contact_map(
    touching_A: np.ndarray,
    cell_A: tuple[float, float],
    disc_A: float,
    grid_A: float,
    centre_A: tuple[float, float],
) -> np.ndarray:
    """Cells in contact, as a boolean array whose middle is `centre_A`."""
    spacing = _spacing(cell_A, grid_A)
    shape = np.round(np.asarray(cell_A) / spacing).astype(int)
    marked = np.zeros(shape, dtype=bool)
    if len(touching_A) == 0:
        return marked
    reach = np.ceil(disc_A / spacing).astype(int)
    offset = np.stack(np.meshgrid(*(np.arange(-r, r + 1) for r in reach), indexing="ij"), axis=-1).reshape(-1, 2)
    shifted = touching_A - np.asarray(centre_A) + np.asarray(cell_A) / 2
    nearest = np.floor(shifted / spacing).astype(int)
    cells = nearest[:, None, :] + offset[None]
    distance = (cells + 0.5) * spacing - shifted[:, None, :]
    hit = cells[np.einsum("ijk,ijk->ij", distance, distance) <= disc_A**2]
    marked[hit[:, 0] % shape[0], hit[:, 1] % shape[1]] = True
    return np.asarray(binary_fill_holes(marked), dtype=bool)


def _spacing(cell_A: tuple[float, float], grid_A: float) -> np.ndarray:
    cell = np.asarray(cell_A, dtype=float)
    return cell / np.maximum(1, np.round(cell / grid_A))
