"""The cells of a pad and their surfaces.

A cell of a periodic surface has no waves longer than its side, and `random_surface` gives every
realisation the same RMS height. Pieces of a large film differ in both: their mean planes scatter by
the waves that are longer than a cell, and their RMS heights by the few long waves that a cell
holds. The highest pieces carry most of the load: without these differences a pad has some 15 % too
little pressure (docs/pad.md).

Places of a film differ, too: each cell is a place of its own, with an RMS height from the film's
distribution. Rough places are few and carry most of the load, so more of the cells are rough ones,
and each of those counts for less.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft2

from mesoscale.contact.surface import random_surface, shortest_wave, surface_spectrum
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs, FilmInputs
from mesoscale.settings import ContactSettings

Array = NDArray[np.float64]

FIRST_SEED = 1000
"""Of the surface of a pad's first cell."""
LOAD_POWER = 3.0
"""The load of a place grows about as this power of its RMS height: so places are drawn."""


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
    inputs: ContactInputs, count: int, first_seed: int = FIRST_SEED, pad_cells: float = np.inf
) -> list[Cell]:
    """Cells that stand for a pad; their weights sum to 1.

    Places are divided into classes of equal load, one cell each, which counts for all places of its
    class (stratified sampling, Cochran, Sampling Techniques, 1977, ch. 5). So do mean planes where
    all places are alike.

    Parameters
    ----------
    pad_cells : cells that the pad has. Places rougher than one in so many are left out: few pads
        have one.
    """
    from scipy.special import ndtr, ndtri

    rng = np.random.default_rng(np.random.SeedSequence([first_seed, 0x9A11]))
    within = rng.random(count)
    plane = ndtri((rng.permutation(count) + rng.random(count)) / count)
    if not isinstance(inputs, FilmInputs):
        planes = np.sort(plane).tolist()
        return [
            Cell(first_seed + place, rough=0.0, plane=height, weight=1.0 / count)
            for place, height in enumerate(planes)
        ]
    shift = LOAD_POWER * inputs.rms_scatter
    roughest = ndtri(1.0 - 1.0 / max(pad_cells, 2.0 * count))
    edges = shift + ndtri(np.linspace(0.0, ndtr(roughest - shift), count + 1))
    # by the share of rougher places: near 1 digits are lost
    beyond = ndtr(-edges)
    weight = beyond[:-1] - beyond[1:]
    rough = -ndtri(beyond[1:] + within * weight)
    columns = zip(rough.tolist(), plane.tolist(), (weight / weight.sum()).tolist(), strict=True)
    return [Cell(first_seed + place, *column) for place, column in enumerate(columns)]


def half_of(count: int, other: bool = False) -> NDArray[np.bool_]:
    """Which of so many cells, in the order of `sample_cells`, make one of two like halves: the
    first, fourth, fifth.
    """
    return ((np.arange(count) + 1) // 2 % 2 == 0) != other


class FilmPieces:
    """Surfaces of cells that are pieces of a film with the inputs' RMS height.

    Attributes
    ----------
    power : variance of each wave of the film (nm^2), shape (pixels, pixels // 2 + 1); in [0, 0]
        that of waves longer than a cell.
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


def first_contact_nm(inputs: ContactInputs, contact: ContactSettings, cell: Cell) -> float:
    """Separation from the mean plane of the film at which a cell first touches."""
    return -float(surface_of(inputs, contact, cell).min())


@lru_cache(maxsize=16)  # the plan of a point's pad looks at the surfaces that are closed next
def _surface(inputs: ContactInputs, contact: ContactSettings, cell: Cell) -> Array:
    return _pieces(inputs, contact).surface(cell)


@lru_cache(maxsize=1)
def _pieces(inputs: ContactInputs, contact: ContactSettings) -> FilmPieces:
    return FilmPieces(inputs, contact)
