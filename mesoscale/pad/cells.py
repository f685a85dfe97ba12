"""The cells of a pad: which separations they are brought to, and their forces there."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.displacement import Closing, Displacement, close_by_separation
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.surfaces import FilmPieces
from mesoscale.settings import ContactSettings, PadSettings

Array = NDArray[np.float64]

DEVIATIONS_ABOVE = 6.0
"""First contacts of cells have a Gumbel tail: 1 of 4000 cells touches more than 6 deviations above the mean."""
FAR_NM = 200.0
"""Beyond, the attraction of the pad is that of two flats to 1 %: 1 + 6 (rms / separation)^2."""
FAR_POINTS = 24
LIGHT = 0.1
"""Part of the largest pressure from which the pad is opened at least; a flat electrode presses with 0.4 of it."""
MAX_PILOT_STEPS = 4000
PILOT_STEP = 5.0
"""Pilot cells are closed in coarser steps than the pad: where the grid ends need not be known to better than that."""


@dataclass(frozen=True)
class PadGrid:
    """Separations that all cells of a pad share.

    Attributes
    ----------
    separation_nm : from far to near, shape (n,).
    depths : positions in `separation_nm` from which the pad is opened, shape (k,).
    """

    separation_nm: Array
    depths: NDArray[np.int_]

    @property
    def depth_nm(self) -> Array:
        """Separations from which the pad is opened, falling, shape (k,)."""
        return self.separation_nm[self.depths]


def grid_of_rows(rows: Sequence[Mapping[str, float]]) -> PadGrid:
    """The grid from the rows of pad/grid.csv."""
    separation = np.array([row["separation_nm"] for row in rows])
    return PadGrid(separation, np.flatnonzero([row["opened_from"] for row in rows]))


def plan_grid(
    inputs: ContactInputs,
    contact: ContactSettings,
    pad: PadSettings,
    wanted_GPa: Callable[[Array], Array],
) -> PadGrid:
    """Separations for a pad, from a few pilot cells that are closed until their mean pressure is the largest asked for.

    Parameters
    ----------
    wanted_GPa : that pressure as a function of separation (nm).

    Raises
    ------
    InputError : the pilot cells never reach the pressure.
    """
    seeds = range(pad.first_seed, pad.first_seed + pad.pilot_cells)
    pieces = FilmPieces(inputs, contact)
    surfaces = [pieces.surface(seed) for seed in seeds]
    first = np.array([-float(heights.min()) for heights in surfaces])
    typical, deviation = float(first.mean()), float(first.std(ddof=1))
    lowest, light = _close_pilots(inputs, contact, surfaces, wanted_GPa, float(first.max()), pad)
    top = typical + DEVIATIONS_ABOVE * max(deviation, pad.step_nm)
    near = lowest + pad.step_nm * np.arange(np.ceil((top - lowest) / pad.step_nm) + 1)
    separation = np.concatenate([near, far_nm(float(near[-1]))])[::-1]
    # a few tall grains may carry the switch where most cells do not touch yet
    shallow = int(np.searchsorted(-separation, -max(typical, light)))
    depths = np.unique(np.linspace(shallow, separation.size - 1, pad.depths).round().astype(int))
    return PadGrid(separation, depths)


def far_nm(top_nm: float) -> Array:
    """Separations, rising, from that of no contact to where a pad attracts as two flats."""
    return np.geomspace(top_nm, max(FAR_NM, 2.0 * top_nm), FAR_POINTS)[1:]


def _close_pilots(
    inputs: ContactInputs,
    contact: ContactSettings,
    surfaces: Sequence[Array],
    wanted_GPa: Callable[[Array], Array],
    start_nm: float,
    pad: PadSettings,
) -> tuple[float, float]:
    """Separations at which the mean repulsion of surfaces closed side by side is the wanted one, and LIGHT of it."""
    planes = [float(heights.mean()) for heights in surfaces]
    pilots = [Closing(inputs, contact, heights) for heights in surfaces]
    area = len(surfaces) * contact.length_nm**2
    separation, repelled, wanted, light = start_nm, 0.0, 0.0, None
    for step in range(MAX_PILOT_STEPS):
        separation = start_nm - pad.step_nm * PILOT_STEP * step
        repelled = sum(
            pilot.close_to(separation + plane, attraction=False) / area
            for pilot, plane in zip(pilots, planes, strict=True)
        )
        wanted = float(wanted_GPa(np.array([separation]))[0])
        if light is None and repelled >= LIGHT * wanted:
            light = separation
        if light is not None and repelled >= wanted:
            return separation, light
    raise InputError(
        f"pad.max_pressure_MPa = {wanted * 1e3:g}: {len(surfaces)} cells closed by "
        f"{start_nm - separation:g} nm carry {repelled * 1e3:.3g} MPa; lower it"
    )


def _close(inputs: ContactInputs, contact: ContactSettings, heights: Array, grid: PadGrid) -> Displacement:
    """One cell closed to separations from the mean plane of the film, in which its heights are given."""
    plane = float(heights.mean())
    closed = close_by_separation(inputs, contact, heights, grid.separation_nm + plane, grid.depths)
    return replace(closed, first_contact_nm=closed.first_contact_nm - plane)


def close_cells(
    inputs: ContactInputs,
    contact: ContactSettings,
    grid: PadGrid,
    seeds: Sequence[int],
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[Displacement]:
    """Forces of each cell at the separations of the pad, while closing and while opening from each depth."""
    pieces = FilmPieces(inputs, contact)
    for done, seed in enumerate(seeds):
        yield _close(inputs, contact, pieces.surface(seed), grid)
        if progress:
            progress((done + 1) / len(seeds), f"{done + 1} of {len(seeds)} cells")
