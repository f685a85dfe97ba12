"""Where a held switch touches its pad, and its gaps elsewhere: from the surfaces of the cells."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, rfft2

from mesoscale.answer.switches import Solved
from mesoscale.pad.cells import sample_cells, surface_of
from mesoscale.pad.curves import on_deep_enough
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.switch import switch_of
from mesoscale.switch.charge import shift_V
from mesoscale.switch.shifted import as_felt
from mesoscale.theory.charging import charge_shift, felt_charge_wave

Array = NDArray[np.float64]

GAPS_NM = np.concatenate([[0.0], np.arange(0.25, 60.0, 0.5)])
"""Gaps whose charge is computed; the first touches. Across 60 nm nothing is emitted."""
EDGES_NM = np.array([0.0, 4.0, 8.0, 12.0, 16.0, 22.0, np.inf])
"""Upper ends of the classes of gaps whose charge is uneven beside that of the others."""
SEPARATIONS = 5
"""Of the held electrode, which stand for all but the places about to peel off, equally pulled."""
PEELING = 8
"""Of these places. Without them the shift is 0.1 V of 14 V too large on the pad of `ci`, with them
0.007 V (accuracy/lifetime.csv)."""
PEELING_SHARE = 0.03
"""Of the pull; the separations of these places spread over hundreds of nanometres."""
UNEVEN_CELLS = 4
"""Cells on whose maps the field of uneven charge is solved."""
RISES_NM = np.array([0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 200.0])
"""Ways above the hold at which it is known."""
LEVELS = 8
"""Gaps at which the field of waves is known, between the least and the largest."""
LEAST_GAP_NM = 0.05


@dataclass(frozen=True)
class HeldGaps:
    """The gaps of a held switch.

    Attributes
    ----------
    device : without its even charge.
    separation_nm, weight : mean separations that stand for the electrode, and their shares of the
        pull, shape (n,).
    heights_nm : of the cells, from the mean plane of the film, shape (cells, pixels, pixels).
    cell_weight : shape (cells,).
    side_nm : of a cell.
    """

    device: DeviceSettings
    separation_nm: Array
    weight: Array
    heights_nm: Array
    cell_weight: Array
    side_nm: float

    @cached_property
    def shares(self) -> Array:
        """Share of the pulled area at each of `GAPS_NM`, and beyond; shape (gaps + 1,)."""
        return self.shares_at(GAPS_NM)

    def shares_at(self, classes_nm: Array) -> Array:
        """The same at other gaps, of which the first is 0."""
        shares = np.zeros(classes_nm.size + 1)
        for separation, weight in zip(self.separation_nm, self.weight, strict=True):
            for heights, of_cell in zip(self.heights_nm, self.cell_weight, strict=True):
                shares += weight * of_cell * _shares(separation + heights, classes_nm)
        return shares

    @property
    def touching(self) -> float:
        """Share of the pulled area that touches."""
        return float(self.shares[0])

    @property
    def contact_factor(self) -> float:
        """By how much the mean field in the dielectric is below that of full contact: the factor
        for the quality of contact by which a published law of drift divides its voltage.
        """
        gaps = np.append(GAPS_NM, GAPS_NM[-1])
        electric = self.device.permittivity * gaps + self.device.dielectric_nm
        return 1.0 / float(self.shares @ (self.device.dielectric_nm / electric))

    def mean_V(self, shifts: Array) -> Array:
        """Mean shift of the pulled area by those of `GAPS_NM`, shape (gaps, ...)."""
        return np.tensordot(self.shares[:-1], shifts, 1)

    def class_V(self, shifts: Array) -> Array:
        """Mean shift of each class of gaps, shape (classes, ...)."""
        number = np.searchsorted(EDGES_NM, GAPS_NM)
        means = np.zeros((EDGES_NM.size, *shifts.shape[1:]))
        for place in range(EDGES_NM.size):
            within = number == place
            weights = self.shares[:-1][within] + 1e-12
            means[place] = np.tensordot(weights / weights.sum(), shifts[within], 1)
        return means

    @cached_property
    def middle_nm(self) -> float:
        """The separation that halves the pull."""
        order = np.argsort(self.separation_nm)
        half = np.searchsorted(np.cumsum(self.weight[order]), 0.5)
        return float(self.separation_nm[order[half]])

    @cached_property
    def uneven(self) -> Array:
        """U^2 by the shifts of two classes, at the rises; shape (rises, classes, classes).

        Each place feels the waves of charge by its own gap. The tops stay as flat as the hold made
        them. Means of whole cells differ by waves of two cells.
        """
        count = min(UNEVEN_CELLS, len(self.heights_nm))
        weights = self.cell_weight[:count] / self.cell_weight[:count].sum()
        squares = np.zeros((RISES_NM.size, EDGES_NM.size, EDGES_NM.size))
        for heights, weight in zip(self.heights_nm, weights, strict=False):
            squares += weight * self._of_cell(heights)
        return squares + self._between_cells()

    def _of_cell(self, heights: Array) -> Array:
        device = self.device
        gaps = np.maximum(self.middle_nm + heights, 0.0)
        number = np.searchsorted(EDGES_NM, gaps)
        # of charge that shifts by 1 V
        density = 1.0 / charge_shift(1.0, device.dielectric_nm, device.permittivity)
        waves = np.asarray(rfft2(density * (number == np.arange(EDGES_NM.size)[:, None, None])))
        pixels = heights.shape[0]
        step = 2.0 * np.pi / self.side_nm
        frequencies = step * pixels * np.fft.fftfreq(pixels)
        wave_numbers = np.hypot(frequencies[:, None], frequencies[None, : pixels // 2 + 1])
        wave_numbers[0, 0] = step
        waves[:, 0, 0] = 0.0
        squares = np.empty((RISES_NM.size, EDGES_NM.size, EDGES_NM.size))
        for place, rise in enumerate(RISES_NM):
            local = np.maximum(gaps + rise, LEAST_GAP_NM)
            levels = np.geomspace(local.min(), 1.0001 * local.max(), LEVELS)
            # volts felt across a gap, over that gap: the field
            fields = []
            for level in levels:
                felt = np.sqrt(2.0) * felt_charge_wave(
                    1.0, wave_numbers, level, device.dielectric_nm, device.permittivity
                )
                filtered = waves * (felt / (level + device.dielectric_gap_nm))
                fields.append(irfft2(filtered, s=heights.shape))
            level_number = np.interp(np.log(local), np.log(levels), np.arange(LEVELS))
            below = np.minimum(level_number.astype(int), LEVELS - 2)
            share = level_number - below
            stacked = np.stack(fields)
            rows, columns = np.indices(local.shape)
            near = stacked[below, :, rows, columns]
            far = stacked[below + 1, :, rows, columns]
            field = (near + share[..., None] * (far - near)).reshape(-1, EDGES_NM.size)
            electric = self.middle_nm + rise + device.dielectric_gap_nm
            squares[place] = electric**2 * (field.T @ field) / len(field)
        return squares

    def _between_cells(self) -> Array:
        """The same of the mean charge of whole cells."""
        device = self.device
        number = np.searchsorted(EDGES_NM, np.maximum(self.middle_nm + self.heights_nm, 0.0))
        means = np.array(
            [[(cell == place).mean() for place in range(EDGES_NM.size)] for cell in number]
        )
        apart = means - self.cell_weight @ means
        covariance = (apart * self.cell_weight[:, None]).T @ apart
        felt = np.sqrt(2.0) * felt_charge_wave(
            1.0 / charge_shift(1.0, device.dielectric_nm, device.permittivity),
            np.pi / self.side_nm,
            self.middle_nm + RISES_NM,
            device.dielectric_nm,
            device.permittivity,
        )
        return np.square(felt)[:, None, None] * covariance


def _shares(gaps_nm: Array, classes_nm: Array) -> Array:
    """Share of places at each class and beyond, between two of which a place is divided."""
    size = gaps_nm.size
    touching = gaps_nm <= 0.0
    far = gaps_nm >= classes_nm[-1]
    between = gaps_nm[~touching & ~far]
    class_number = np.maximum(
        np.interp(between, classes_nm[1:], np.arange(1.0, classes_nm.size)), 1.0
    )
    lower = np.minimum(class_number.astype(int), classes_nm.size - 2)
    shares = np.bincount(lower, 1.0 - (class_number - lower), classes_nm.size + 1)
    shares += np.bincount(lower + 1, class_number - lower, classes_nm.size + 1)
    shares[0] += touching.sum()
    shares[-1] += far.sum()
    return shares / size


def held_gaps(
    solved: Solved,
    contact: ContactSettings,
    first_seed: int,
    pull_shares: Array | None = None,
) -> HeldGaps:
    """The gaps of a switch on its pad, held as its scene says, before any charge.

    Parameters
    ----------
    contact : on the grid of the pads.
    first_seed : of the surfaces of its cells.
    pull_shares : of the separations that stand for the electrode, from the least separation on;
        None: `shares_of_pull`.

    Raises
    ------
    InputError : the switch has no answer.
    """
    point = solved.point
    pad = solved.pressed
    device = as_felt(point.device, shift_V(point.device)).uncharged
    (separation_nm, pulls), _ = on_deep_enough(pad.curves, switch_of(device).held_nm)
    inputs, settings = point.contact_of(contact)
    pad_cells = device.pad_um2 * 1e6 / settings.length_nm**2
    drawn = sample_cells(inputs, pad.count, first_seed, pad_cells)
    heights = np.stack([surface_of(inputs, settings, cell) for cell in drawn])
    if pull_shares is None:
        pull_shares = shares_of_pull()
    return HeldGaps(
        device,
        standing_for(separation_nm.ravel(), pulls.ravel(), pull_shares),
        pull_shares,
        heights,
        pad.weight,
        settings.length_nm,
    )


def shares_of_pull(count: int = SEPARATIONS, peeling: int = PEELING) -> Array:
    """Equal shares of the pull, and the last part divided among places about to peel off."""
    if not peeling:
        return np.full(count, 1.0 / count)
    held = np.full(count, (1.0 - PEELING_SHARE) / count)
    return np.concatenate([held, np.full(peeling, PEELING_SHARE / peeling)])


def standing_for(separation_nm: Array, pulls: Array, shares: Array) -> Array:
    """Separations in the middle of parts of the pull, by the shares of these parts."""
    order = np.argsort(separation_nm)
    total = np.cumsum(pulls[order]) / pulls.sum()
    middles = np.cumsum(shares) - 0.5 * shares
    places = np.minimum(np.searchsorted(total, middles), separation_nm.size - 1)
    return separation_nm[order][places]
