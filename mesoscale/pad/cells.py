"""The cells of a pad: their surfaces, the separations they are brought to, and their forces there.

A cell of a periodic surface has no waves longer than its side, and `random_surface` gives every
realisation the same RMS height. Pieces of a large film differ in both: their mean planes scatter by
the waves that are longer than a cell, and their RMS heights by the few long waves that a cell
holds. The highest pieces carry most of the load: without these differences a pad has some 15 % too
little pressure (docs/pad.md).

Places of a film differ, too: each cell is a place of its own, with an RMS height from the film's
distribution. Rough places are few and carry most of the load, so more of the cells are rough ones,
and each of those counts for less."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft2

from mesoscale.contact.displacement import Closing, Displacement, close_by_separation
from mesoscale.contact.menisci import reach_nm
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.contact.surface import random_surface, shortest_wave, surface_spectrum
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs, FilmInputs
from mesoscale.pad.numerics import PAD
from mesoscale.settings import ContactSettings
from mesoscale.settings.pad import PILOTS

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Cell:
    """One cell of a pad.

    Attributes
    ----------
    seed : of its surface.
    rough : ln RMS of its place, in standard deviations from the median place.
    plane : its mean plane, in standard deviations from that of the film.
    weight : its share of the pad.
    """

    seed: int
    rough: float
    plane: float
    weight: float


def sample_cells(
    inputs: ContactInputs, count: int, first_seed: int = PAD.first_seed, pad_cells: float = np.inf
) -> list[Cell]:
    """Cells that stand for a pad; their weights sum to 1.

    Places are divided into classes of equal load, one cell each, which counts for all places of its
    class (stratified sampling, Cochran, Sampling Techniques, 1977, ch. 5). So do mean planes where
    all places are alike.

    Parameters
    ----------
    pad_cells : cells that the pad has. Places rougher than one in so many are left out: few pads
        have one."""
    from scipy.special import ndtr, ndtri

    rng = np.random.default_rng(np.random.SeedSequence([first_seed, 0x9A11]))
    within, plane = rng.random(count), ndtri((rng.permutation(count) + rng.random(count)) / count)
    if not isinstance(inputs, FilmInputs):
        return [
            Cell(first_seed + k, 0.0, value, 1.0 / count)
            for k, value in enumerate(np.sort(plane).tolist())
        ]
    shift, roughest = (
        PAD.load_power * inputs.rms_scatter,
        ndtri(1.0 - 1.0 / max(pad_cells, 2.0 * count)),
    )
    ends = shift + ndtri(np.linspace(0.0, ndtr(roughest - shift), count + 1))
    # by the share of rougher places: near 1 digits are lost
    beyond = ndtr(-ends)
    weight = beyond[:-1] - beyond[1:]
    rough = -ndtri(beyond[1:] + within * weight)
    numbers = zip(rough.tolist(), plane.tolist(), (weight / weight.sum()).tolist(), strict=True)
    return [Cell(first_seed + k, *of) for k, of in enumerate(numbers)]


def half_of(count: int, other: bool = False) -> NDArray[np.bool_]:
    """Which of so many cells, in the order of `sample_cells`, make one of two like halves: the
    first, fourth, fifth.
    """
    return ((np.arange(count) + 1) // 2 % 2 == 0) != other


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


class FilmPieces:
    """Surfaces of cells that are pieces of a film with the inputs' RMS height.

    Attributes
    ----------
    power : variance of each wave of the film (nm^2), shape (pixels, pixels // 2 + 1); in [0, 0]
        that of waves longer
        than a cell.
    """

    def __init__(self, inputs: ContactInputs, contact: ContactSettings):
        self.inputs, self.contact = inputs, contact
        step = 2.0 * np.pi / contact.length_nm
        waves = step * contact.pixels * np.fft.fftfreq(contact.pixels)
        q = np.hypot(waves[:, None], waves[None, : contact.pixels // 2 + 1])
        inside = q <= shortest_wave(contact) * (1.0 + 1e-9)
        # the spectrum is flat below the longest wave of a cell
        power = np.where(inside, surface_spectrum(inputs, contact)(np.maximum(q, step)), 0.0)
        # the half plane stands for the whole: all columns but the first (and the last of an even
        # grid) count twice
        twice = np.full(q.shape[1], 2.0)
        twice[0] = 1.0
        if contact.pixels % 2 == 0:
            twice[-1] = 1.0
        self.known = inside & (power > 0)
        self.known[0, 0] = False
        if not self.known.any():
            raise InputError(
                f"contact.pixels = {contact.pixels}, contact.length_nm = {contact.length_nm:g}: the"
                f" spectrum has no wave from {step:.3g} to {shortest_wave(contact):.3g} 1/nm, which"
                " is all that a cell has; give one that reaches there, or another grid"
            )
        self.power = power * (inputs.rms**2 / float((power * twice).sum()))

    @property
    def plane_deviation_nm(self) -> float:
        """Standard deviation of the mean planes of cells (nm)."""
        return float(np.sqrt(self.power[0, 0]))

    def surface(self, cell: Cell) -> Array:
        """Heights (pixels, pixels) in nm of one cell, from the mean plane of the film; contact is
        at its minima.
        """
        heights = random_surface(self.inputs, self.contact, cell.seed)
        # the realisation was scaled to its own RMS; its short waves, of which there are many, tell
        # by how much
        realised = np.abs(np.asarray(rfft2(heights))) ** 2 / heights.size**2
        ratio = float(np.mean(realised[self.known] / self.power[self.known]))
        return heights / np.sqrt(ratio) + self.plane_deviation_nm * cell.plane


def place_ratio(inputs: ContactInputs, cell: Cell) -> float:
    """RMS height of the cell's place over that of the median place."""
    return float(np.exp(inputs.rms_scatter * cell.rough)) if isinstance(inputs, FilmInputs) else 1.0


def surface_of(inputs: ContactInputs, contact: ContactSettings, cell: Cell) -> Array:
    """Heights (pixels, pixels) in nm of a cell with the RMS height of its place, from the mean
    plane of the film.
    """
    return place_ratio(inputs, cell) * _surface(inputs, contact, cell)


@lru_cache(maxsize=16)  # the plan of a point's pad looks at the surfaces that are closed next
def _surface(inputs: ContactInputs, contact: ContactSettings, cell: Cell) -> Array:
    return _pieces(inputs, contact).surface(cell)


@lru_cache(maxsize=1)
def _pieces(inputs: ContactInputs, contact: ContactSettings) -> FilmPieces:
    return FilmPieces(inputs, contact)


class SideBySide:
    """Cells under one plane that are brought to one separation after another, all of them together.

    Attributes
    ----------
    cells : the surfaces as they are closed.
    share : weight of each over the area of a cell (1/nm^2), shape (n,).
    first_contact_nm : separation from the film's mean plane at which each first touches (nm), shape
        (n,)."""

    def __init__(
        self, inputs: ContactInputs, contact: ContactSettings, cells: Sequence[Cell]
    ) -> None:
        surfaces = [surface_of(inputs, contact, cell) for cell in cells]
        self.first_contact_nm = np.array([-float(heights.min()) for heights in surfaces])
        self._planes = [float(heights.mean()) for heights in surfaces]
        self.share = np.array([cell.weight for cell in cells]) / contact.length_nm**2
        self.cells = [Closing(inputs, contact, heights) for heights in surfaces]

    @property
    def net_GPa(self) -> Array:
        """Their mean net pressure at all separations so far, shape (n,)."""
        return np.tensordot(
            self.share, np.array([cell.closing.sum(axis=0) for cell in self.cells]), 1
        )

    def close_to(self, separation_nm: float, attraction: bool = True) -> float:
        """Bring all to a separation from the film's mean plane; their mean repulsion (GPa)."""
        forces = [
            cell.close_to(separation_nm + plane, attraction)
            for cell, plane in zip(self.cells, self._planes, strict=True)
        ]
        return float(self.share @ np.array(forces))


def plan_grid(
    inputs: ContactInputs,
    contact: ContactSettings,
    cells: Sequence[Cell],
    wanted_GPa: Callable[[Array], Array],
    pressed_GPa: Callable[[Array, Array], float] | None = None,
    step_nm: float | None = None,
    depths: int = PAD.depths,
) -> PadGrid:
    """Separations for a pad, from some of its cells that are closed until they carry all that is
    asked for.

    Parameters
    ----------
    wanted_GPa : mean repulsion that they carry at least, as a function of separation (nm).
    pressed_GPa : largest net pressure of a switch on a pad, from the closing curve of the pad:
        separations (nm), from
        near to far, and net pressures. The pilots are closed until they carry that, and
        `PAD.margin` more.
    step_nm : of separation in and near contact, at most; None: `PAD.step_rms`.

    Raises
    ------
    InputError : the pilot cells never reach the pressure, or their asperities merge before.
    """
    step_nm = step_nm or PAD.step_nm(inputs.rms)
    every = -(-len(cells) // PILOTS)
    pilot_cells = _some_of(cells, every)
    others = [cell for k, cell in enumerate(cells) if k % every]
    touching = [-float(surface_of(inputs, contact, cell).min()) for cell in others]
    while True:
        pilots = SideBySide(inputs, contact, pilot_cells)
        way, load = _close_pilots(pilots, wanted_GPa, pressed_GPa, step_nm * PAD.pilot_step)
        lowest = float(way[-1])
        if (
            pilots.first_contact_nm.max() - lowest
            > (PAD.fewest_pilot_steps - 0.5) * PAD.pilot_step * step_nm
        ):
            break
        step_nm /= PAD.fewest_pilot_steps
    touching = np.append(pilots.first_contact_nm, touching)
    top, typical = float(touching.max()) + step_nm, float(np.median(touching))
    near = lowest + step_nm * np.arange(np.ceil((top - lowest) / step_nm) + 1)
    if isinstance(inputs, FilmInputs):
        # rougher places touch farther out, and their lengths grow in proportion
        close = near[near < max(typical, lowest + step_nm)]
        ratio = top / close[-1]
        growth = np.geomspace(
            close[-1], top, int(np.ceil(np.log(ratio) * close[-1] / (PAD.grown * step_nm))) + 1
        )
        near = np.concatenate([close, growth[1:]])
    if reach := reach_nm(contact.air):  # liquid bridges the highest sites before they touch
        near = np.append(
            near, float(near[-1]) + reach * np.arange(1, PAD.bridged + 1) / PAD.bridged
        )
    separation = np.concatenate([near, far_nm(float(near[-1]))])[::-1]
    levels = np.geomspace(PAD.light * load[-1], load[-1], depths)
    opened = np.searchsorted(-separation, -np.interp(levels, load, way)).clip(
        max=separation.size - 1
    )
    return PadGrid(separation, np.unique(opened))


def _some_of(cells: Sequence[Cell], every: int) -> list[Cell]:
    """Every so many of the cells, as a pad of its own."""
    kept = cells[::every]
    whole = sum(cell.weight for cell in kept)
    return [replace(cell, weight=cell.weight / whole) for cell in kept]


def far_nm(top_nm: float) -> Array:
    """Separations, rising, from that of no contact to where a pad attracts as two flats."""
    return np.geomspace(top_nm, max(PAD.far_nm, 2.0 * top_nm), PAD.far_points)[1:]


def _close_pilots(
    pilots: SideBySide,
    wanted_GPa: Callable[[Array], Array],
    pressed_GPa: Callable[[Array, Array], float] | None,
    step_nm: float,
) -> tuple[Array, Array]:
    """Separations on the way to where the pilots carry what is asked for, and the largest repulsion
    up to each.
    """
    start_nm = float(pilots.first_contact_nm.max())
    way, load, wanted = [], [], 0.0
    for step in range(PAD.most_pilot_steps):
        way.append(start_nm - step_nm * step)
        repulsion, largest = (
            pilots.close_to(way[-1], attraction=pressed_GPa is not None),
            load[-1] if load else 0.0,
        )
        load.append(max(repulsion, largest))
        wanted = float(wanted_GPa(np.array(way[-1:]))[0])
        if largest > PAD.merged * wanted and repulsion < (1.0 - PAD.merged) * largest:
            raise InputError(
                f"contact.mechanics: cells carry {largest * 1e3:.3g} MPa, but {repulsion * 1e3:.3g}"
                f" MPa closed to {way[-1]:.2g} nm, as asperities merge that count one by one; take"
                " mechanics: coupled"
            )
        if load[-1] >= wanted:
            if pressed_GPa is None:
                return np.array(way), np.array(load)
            net = pilots.net_GPa[::-1]
            wanted = PAD.margin * pressed_GPa(np.array(way[::-1]), net)
            if net[0] >= wanted:
                return np.array(way), np.array(load)
    raise InputError(
        f"device: {len(pilots.cells)} cells closed by {start_nm - way[-1]:g} nm carry"
        f" {load[-1] * 1e3:.3g} of the {wanted * 1e3:.3g} MPa that the switch presses with; lower"
        " hold_voltage_V"
    )


def close_cells(
    inputs: ContactInputs,
    contact: ContactSettings,
    grid: PadGrid,
    cells: Sequence[Cell],
    progress: Callable[[float, str], None] | None = None,
    numerics: Numerics = NUMERICS,
) -> Iterator[Displacement]:
    """Forces of each cell at the separations of the pad, while closing and while opening from each
    depth.
    """
    for done, cell in enumerate(cells):
        yield _close(inputs, contact, grid, cell, numerics)
        if progress:
            progress((done + 1) / len(cells), f"{done + 1} of {len(cells)} cells")


def _close(
    inputs: ContactInputs, contact: ContactSettings, grid: PadGrid, cell: Cell, numerics: Numerics
) -> Displacement:
    """One cell at the separations of the pad; a rough one in longer steps, between which its forces
    are straight.
    """
    heights = surface_of(inputs, contact, cell)
    plane = float(heights.mean())  # the separation is that from the mean plane of the film
    ratio = place_ratio(inputs, cell)
    kept = _own_steps(
        grid, min(PAD.place_step_rms * ratio**2 * inputs.rms, PAD.longest_place_step_nm)
    )
    known = grid.separation_nm[kept]
    depths = np.flatnonzero(np.isin(kept, grid.depths))
    closed = close_by_separation(inputs, contact, heights, known + plane, depths, numerics)
    opening = np.array([_between(grid.separation_nm, known, branch) for branch in closed.opening])
    for branch, depth in zip(opening, grid.depths, strict=True):
        branch[:, depth + 1 :] = np.nan
    closing = _between(grid.separation_nm, known, closed.closing)
    return Displacement(closed.first_contact_nm - plane, closing, opening, closed.settled)


def _own_steps(grid: PadGrid, step_nm: float) -> NDArray[np.int_]:
    """Positions in a grid that are so far apart at least, with its ends and depths."""
    kept = [0]
    for place in range(1, grid.separation_nm.size):
        if (
            place in grid.depths
            or grid.separation_nm[kept[-1]] - grid.separation_nm[place] >= (1.0 - 1e-9) * step_nm
        ):
            kept.append(place)
    return np.array(kept)


def _between(wanted: Array, known: Array, forces: Array) -> Array:
    """Forces (2, n) at falling separations, at other ones."""
    return np.array([np.interp(-wanted, -known, row) for row in forces])
