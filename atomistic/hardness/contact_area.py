"""Contact area: one definition, used for every run, calibrated on bodies of known section (studies/area.py).

Atoms nearer to the counterface than a depth (or beyond it) touch.  The space between touching atoms counts as contact
where a disc of the closing radius does not fit; enclosed holes do too.  The rim lies one rim radius outside the
outermost touching atoms.
"""

import numpy as np
from scipy.ndimage import binary_fill_holes, distance_transform_edt
from scipy.spatial import KDTree

from atomistic.errors import InputError
from atomistic.potentials import AreaCalibration, Potential
from atomistic.settings import AreaSettings


def contact_area(
    touching_A: np.ndarray, cell_A: tuple[float, float], settings: AreaSettings, centre_A: tuple[float, float]
) -> float:
    """Area of the contact, Å².

    Parameters
    ----------
    touching_A : positions in the plane, shape (atoms, 2).
    cell_A : periodic lengths in x and y.
    centre_A : middle of the contact; the grid is rolled so that the contact does not wrap around, where holes
        would stay open.
    """
    return float(np.sum(contact_map(touching_A, cell_A, settings, centre_A)) * _spacing(cell_A, settings).prod())


def contact_map(
    touching_A: np.ndarray, cell_A: tuple[float, float], settings: AreaSettings, centre_A: tuple[float, float]
) -> np.ndarray:
    """Share of each cell in contact; the middle of the array is `centre_A`.

    Discs of `closing_A` about the touching atoms, holes filled, cut back to `rim_A`; cells that the rim crosses count
    in part, so that the area does not jump with the grid.
    """
    spacing, cell = _spacing(cell_A, settings), np.asarray(cell_A, dtype=float)
    shape = np.round(cell / spacing).astype(int)
    if len(touching_A) == 0:
        return np.zeros(shape)
    shifted = np.mod(touching_A - np.asarray(centre_A) + cell / 2, cell)
    # a place that rounding puts on the far edge of the cell lies outside it for the tree
    tree = KDTree(np.where(shifted < cell, shifted, 0.0), boxsize=cell)
    part = tuple(_reach(shifted[:, k], settings.closing_A, spacing[k], shape[k]) for k in range(2))
    middles = np.stack(np.meshgrid(*(np.arange(n) + 0.5 for n in shape), indexing="ij"), axis=-1)[part] * spacing
    distance, _ = tree.query(middles, distance_upper_bound=2 * settings.closing_A)
    marked = np.asarray(binary_fill_holes(distance <= settings.closing_A), dtype=bool)
    if marked.all():
        return np.ones(shape)
    wide = np.pad(marked, margin := int(np.ceil(settings.closing_A / spacing.min())) + 1, mode="wrap")
    outside = np.asarray(distance_transform_edt(wide, sampling=spacing))[margin:-margin, margin:-margin]
    area = np.zeros(shape)
    area[part] = np.clip((outside - (settings.closing_A - settings.rim_A)) / spacing.mean(), 0, 1)
    return area


def _reach(places_A: np.ndarray, reach_A: float, spacing_A: float, cells: int) -> slice:
    """Cells within reach of the places and one more on either side, since a small contact need not cost a whole map.

    All cells where the reach crosses the edge.
    """
    first = int(np.floor((places_A.min() - reach_A) / spacing_A)) - 1
    last = int(np.ceil((places_A.max() + reach_A) / spacing_A)) + 1
    return slice(first, last) if first >= 0 and last <= cells else slice(0, cells)


def _spacing(cell_A: tuple[float, float], settings: AreaSettings) -> np.ndarray:
    cell = np.asarray(cell_A, dtype=float)
    return cell / np.maximum(1, np.round(cell / settings.grid_A))


def require_calibration(
    potential: Potential, settings: AreaSettings, counter_potential: Potential | None = None
) -> AreaCalibration:
    """The calibration of the area definition in use with a potential.

    Parameters
    ----------
    counter_potential : of a counterface of other atoms.

    Raises
    ------
    InputError : the potential's file has none, or that of another definition.
    """
    calibration = potential.contact_area
    if calibration is None:
        raise InputError(
            f"potential {potential.name}: no calibration of the contact area; run target hardness_area and write "
            "its largest error as `contact_area` into the potential's file (see config/potentials/pmmcs.yaml)"
        )
    if counter_potential is not None and counter_potential.name != potential.name:
        against = calibration.counterfaces.get(counter_potential.name)
        if against is None:
            raise InputError(
                f"potential {potential.name}: no calibration of the contact area against {counter_potential.name}; run "
                "target hardness_area with this counterface and write `contact_area.counterfaces` into the "
                "potential's file (see config/potentials/pmmcs.yaml)"
            )
        calibration = calibration.model_copy(update=against.model_dump())
    for key in ("depth_A", "touch_A", "closing_A", "rim_A"):
        if getattr(settings, key) != getattr(calibration, key):
            raise InputError(
                f"hardness.area.{key} = {getattr(settings, key):g}: potential {potential.name} is calibrated with "
                f"{getattr(calibration, key):g} A; keep that, or run target hardness_area and change its file"
            )
    return calibration
