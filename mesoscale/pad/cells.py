"""The cells of a pad: their surfaces, the separations they are brought to, and their forces there.

A cell of a periodic surface has no waves longer than its side, and `random_surface` gives every realisation the same
RMS height. Pieces of a large film differ in both: their mean planes scatter by the waves that are longer than a cell,
and their RMS heights by the few long waves that a cell holds. The highest pieces carry most of the load: without these
differences a pad has some 15 % too little pressure (docs/pad.md).

Places of a film differ, too: each cell is a place of its own, with an RMS height from the film's distribution.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.displacement import Closing, Displacement, close_by_separation
from mesoscale.contact.surface import random_surface, shortest_wave, surface_spectrum
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs, FilmInputs
from mesoscale.settings import ContactSettings, PadGridSettings

Array = NDArray[np.float64]

FIRST_SEED = 1000
"""Of the surface of a pad's first cell."""
GOLDEN = 0.5 * (5.0**0.5 - 1.0)
STEP_NM = 0.1
"""Step of separation in and near contact: twice as long moves the well of a single cell by 15 % (accuracy.py)."""
GROWN = 2.0
"""Steps where only rough places touch, in units of their RMS height: release is that of half of it to 1e-6 V."""
DEVIATIONS_ABOVE = 6.0
"""First contacts of cells have a Gumbel tail: 1 of 4000 cells touches more than 6 deviations above the mean."""
FAR_NM = 200.0
"""Beyond, the attraction of the pad is that of two flats to 1 %: 1 + 6 (rms / separation)^2."""
FAR_POINTS = 24
LIGHT = 0.1
"""Part of the largest pressure from which the pad is opened at least; a flat electrode presses with 0.4 of it."""
MAX_PILOT_STEPS = 4000
MARGIN = 1.25
"""Over what the switch presses with: the mean of the few pilot cells is off by 15 %."""
PILOT_STEP = 5.0
"""Pilot cells are closed in coarser steps than the pad: where the grid ends need not be known to better than that."""
FEWEST_PILOT_STEPS = 3
"""Where fewer reach the pressure, all steps are finer: a film of long waves is closed by little of its RMS height."""


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
    power : variance of each wave of the film (nm^2), shape (pixels, pixels // 2 + 1); in [0, 0] that of waves longer
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
        # the half plane stands for the whole: all columns but the first (and the last of an even grid) count twice
        twice = np.full(q.shape[1], 2.0)
        twice[0] = 1.0
        if contact.pixels % 2 == 0:
            twice[-1] = 1.0
        other = contact.surface.counterface
        self.known = inside & (power > 0)
        self.known[0, 0] = False
        if not self.known.any():
            raise InputError(
                f"contact.pixels = {contact.pixels}, contact.length_nm = {contact.length_nm:g}: the spectrum has no "
                f"wave from {step:.3g} to {shortest_wave(contact):.3g} 1/nm, which is all that a cell has; "
                "give one that reaches there, or another grid"
            )
        variance = inputs.rms**2 + (other.rms_nm**2 if other else 0.0)
        self.power = power * (variance / float((power * twice).sum()))

    @property
    def plane_deviation_nm(self) -> float:
        """Standard deviation of the mean planes of cells (nm)."""
        return float(np.sqrt(self.power[0, 0]))

    def surface(self, seed: int) -> Array:
        """Heights (pixels, pixels) in nm of one cell, from the mean plane of the film; contact is at its minima."""
        heights = random_surface(self.inputs, self.contact, seed)
        # the realisation was scaled to its own RMS; its short waves, of which there are many, tell by how much
        realised = np.abs(np.fft.rfft2(heights)) ** 2 / heights.size**2
        ratio = float(np.mean(realised[self.known] / self.power[self.known]))
        rng = np.random.default_rng(np.random.SeedSequence([seed, 0x9A11]))
        return heights / np.sqrt(ratio) + self.plane_deviation_nm * rng.normal()


def place_of(inputs: ContactInputs, seed: int) -> ContactInputs:
    """The inputs with the RMS height of one place of the film.

    RMS heights of places are lognormal. Probabilities of successive seeds are multiples of the golden ratio (modulo 1),
    which are spread evenly: 64 cells have a mean of ln RMS with a third of the error of independent places.
    """
    if not isinstance(inputs, FilmInputs):
        return inputs
    from scipy.special import ndtri

    normal = float(ndtri((seed - FIRST_SEED + 0.5) * GOLDEN % 1.0))
    place = {field.name: getattr(inputs, field.name) for field in fields(ContactInputs)}
    return ContactInputs(**{**place, "rms": inputs.rms * float(np.exp(inputs.rms_scatter * normal))})


def _surface(inputs: ContactInputs, contact: ContactSettings, seed: int) -> Array:
    """Heights (pixels, pixels) in nm of the cell of a seed, from the mean plane of the film."""
    return FilmPieces(place_of(inputs, seed), contact).surface(seed)


class SideBySide:
    """Cells under one plane that are brought to one separation after another, all of them together.

    Attributes
    ----------
    cells : the surfaces as they are closed.
    first_contact_nm : separation from the film's mean plane at which each first touches (nm), shape (n,).
    """

    def __init__(self, inputs: ContactInputs, contact: ContactSettings, seeds: Sequence[int]) -> None:
        surfaces = [_surface(inputs, contact, seed) for seed in seeds]
        self.first_contact_nm = np.array([-float(heights.min()) for heights in surfaces])
        self._planes = [float(heights.mean()) for heights in surfaces]
        self._area_nm2 = len(surfaces) * contact.length_nm**2
        self.cells = [Closing(inputs, contact, heights) for heights in surfaces]

    def top_nm(self, step_nm: float) -> float:
        """Separation above which hardly a cell of the film touches; first contacts scatter by a step at least."""
        deviation = float(self.first_contact_nm.std(ddof=1))
        return float(self.first_contact_nm.mean()) + DEVIATIONS_ABOVE * max(deviation, step_nm)

    @property
    def net_GPa(self) -> Array:
        """Their mean net pressure at all separations so far, shape (n,)."""
        return np.sum([cell.closing.sum(axis=0) for cell in self.cells], axis=0) / self._area_nm2

    def close_to(self, separation_nm: float, attraction: bool = True) -> float:
        """Bring all to a separation from the film's mean plane; their mean repulsion (GPa)."""
        return sum(
            cell.close_to(separation_nm + plane, attraction) / self._area_nm2
            for cell, plane in zip(self.cells, self._planes, strict=True)
        )


def grid_of_rows(rows: Sequence[Mapping[str, float]]) -> PadGrid:
    """The grid from the rows of pad/grid.csv."""
    separation = np.array([row["separation_nm"] for row in rows])
    return PadGrid(separation, np.flatnonzero([row["opened_from"] for row in rows]))


def plan_grid(
    inputs: ContactInputs,
    contact: ContactSettings,
    settings: PadGridSettings,
    wanted_GPa: Callable[[Array], Array],
    first_seed: int = FIRST_SEED,
    step_nm: float = STEP_NM,
    pressed_GPa: Callable[[Array, Array], float] | None = None,
) -> PadGrid:
    """Separations for a pad, from a few pilot cells that are closed until they carry all that is asked for.

    Parameters
    ----------
    wanted_GPa : mean repulsion that they carry at least, as a function of separation (nm).
    pressed_GPa : largest net pressure of a switch on a pad, from the closing curve of the pad: separations (nm), from
        near to far, and net pressures. The pilots are closed until they carry that, and `MARGIN` more.
    first_seed : of the pilot cells' surfaces.
    step_nm : of separation in and near contact, at most.

    Raises
    ------
    InputError : the pilot cells never reach the pressure.
    """
    while True:
        pilots = SideBySide(inputs, contact, range(first_seed, first_seed + settings.pilot_cells))
        lowest, light = _close_pilots(pilots, wanted_GPa, pressed_GPa, step_nm * PILOT_STEP)
        if pilots.first_contact_nm.max() - lowest > (FEWEST_PILOT_STEPS - 0.5) * PILOT_STEP * step_nm:
            break
        step_nm /= FEWEST_PILOT_STEPS
    top, typical = pilots.top_nm(step_nm), float(pilots.first_contact_nm.mean())
    near = lowest + step_nm * np.arange(np.ceil((top - lowest) / step_nm) + 1)
    if isinstance(inputs, FilmInputs):
        # rougher places touch farther out, and their lengths grow in proportion
        close = near[near < max(typical, lowest + step_nm)]
        ratio = top / close[-1]
        growth = np.geomspace(close[-1], top, int(np.ceil(np.log(ratio) * close[-1] / (GROWN * step_nm))) + 1)
        near = np.concatenate([close, growth[1:]])
    separation = np.concatenate([near, far_nm(float(near[-1]))])[::-1]
    # a few tall grains may carry the switch where most cells do not touch yet
    shallow = int(np.searchsorted(-separation, -max(typical, light)))
    depths = np.unique(np.linspace(shallow, separation.size - 1, settings.depths).round().astype(int))
    return PadGrid(separation, depths)


def far_nm(top_nm: float) -> Array:
    """Separations, rising, from that of no contact to where a pad attracts as two flats."""
    return np.geomspace(top_nm, max(FAR_NM, 2.0 * top_nm), FAR_POINTS)[1:]


def _close_pilots(
    pilots: SideBySide,
    wanted_GPa: Callable[[Array], Array],
    pressed_GPa: Callable[[Array, Array], float] | None,
    step_nm: float,
) -> tuple[float, float]:
    """Separations at which the pilots carry what is asked for, and LIGHT of what is wanted."""
    start_nm = float(pilots.first_contact_nm.max())
    separation, repelled, wanted, light = start_nm, 0.0, 0.0, None
    for step in range(MAX_PILOT_STEPS):
        separation = start_nm - step_nm * step
        repelled = pilots.close_to(separation, attraction=pressed_GPa is not None)
        wanted = float(wanted_GPa(np.array([separation]))[0])
        if light is None and repelled >= LIGHT * wanted:
            light = separation
        if light is not None and repelled >= wanted:
            if pressed_GPa is None:
                return separation, light
            net = pilots.net_GPa[::-1]
            wanted = MARGIN * pressed_GPa(np.linspace(separation, start_nm, net.size), net)
            if net[0] >= wanted:
                return separation, light
    raise InputError(
        f"device: {len(pilots.cells)} cells closed by {start_nm - separation:g} nm carry {repelled * 1e3:.3g} of the "
        f"{wanted * 1e3:.3g} MPa that the switch presses with; lower hold_voltage_V"
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
    for done, seed in enumerate(seeds):
        yield _close(inputs, contact, _surface(inputs, contact, seed), grid)
        if progress:
            progress((done + 1) / len(seeds), f"{done + 1} of {len(seeds)} cells")
