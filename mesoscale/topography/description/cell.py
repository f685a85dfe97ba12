"""The side of the cells for the contact, from what was measured and what the device has room for.

A cell holds the shortest waves that were measured several times, and as much of the film's RMS
height as its grid and the electrode allow: cells without the long waves release too early (`python
-m evidence pad.cell_side`). Waves shorter than the measured ones are an assumption, and its effect
is stated.
"""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings
from mesoscale.topography.description.doubts import Doubt
from mesoscale.topography.description.one_spectrum import OneSpectrum
from mesoscale.topography.description.parameters import Topography
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.roughness_spectrum import mean_square
from mesoscale.topography.synthesis import synthesize_spectrum

FINEST_WAVES = 2.0
"""The shortest measured wave goes at least so often into a cell."""
SUITED_WAVES = 8.0
"""And so often into a cell whose side is chosen."""
HELD = 0.9
"""Share of the RMS height of the film that a cell holds whose side is chosen."""


def suited_cell(spectra: Sequence[TrustedSpectrum], electrode_nm: float = math.inf) -> float:
    """Side (nm) of cells: eight of the shortest measured waves, within the usual and the electrode.

    Parameters
    ----------
    electrode_nm : side of a square of the electrode's area.

    Raises
    ------
    InputError : hardly a measured wave is as short as the electrode.
    """
    finest, seen = _shortest_wave(spectra)
    if electrode_nm < FINEST_WAVES * seen:
        raise InputError(
            f"topography: the shortest wave that {finest} shows is {seen:.3g} nm long, and the"
            f" electrode has a side of {electrode_nm:.3g} nm (device), so that no roughness below"
            " it was measured; measure on a finer scale, or correct the size of the device"
        )
    return min(max(ContactSettings().length_nm, float(f"{SUITED_WAVES * seen:.2g}")), electrode_nm)


def grown_cell(
    side_nm: float, held: Callable[[float], float], shortest_nm: float, pixels: int, room_nm: float
) -> float:
    """The side (nm), doubled until a cell holds `HELD` of the RMS height, if grid and room allow.

    Parameters
    ----------
    side_nm : from `suited_cell`.
    held : share of the mean square height on cells of a side (nm).
    shortest_nm : shortest wave of the surfaces.
    pixels : grid points a side of the cells.
    room_nm : side of a square of the electrode's area.
    """
    # at most four times as long as without the long waves; a grid resolves waves of two sites
    most_nm = min(4.0 * side_nm, pixels * shortest_nm / 2.0, room_nm)
    while held(side_nm) < HELD**2 and 2.0 * side_nm <= most_nm:
        side_nm *= 2.0
    return side_nm


def cell_waves(cell_nm: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Waves (1/nm) of a periodic cell, area (1/nm^2) of each, and where an integral takes over.

    The mean plane counts as one more wave of the longest: the spectrum of the film is flat there.
    """
    # beyond, sum and integral differ by less than a per cent
    step = 2.0 * np.pi / cell_nm
    summed = 16
    numbers = np.arange(-summed, summed + 1)
    squared, count = np.unique(numbers[:, None] ** 2 + numbers**2, return_counts=True)
    inside = squared <= summed**2
    wave_vectors = step * np.sqrt(np.maximum(squared[inside], 1))
    areas = step**2 * count[inside]
    return wave_vectors, areas, summed * step


def mean_square_of_cells(merged: OneSpectrum, psd: np.ndarray, cell_nm: float) -> np.ndarray:
    """Mean square height (nm^2) of cells by spectra (..., m) on the bands of `merged`."""
    waves, areas, end = cell_waves(cell_nm)
    logs = np.log(psd).reshape(-1, len(merged.q))
    known = waves <= merged.q[-1]
    log_q = np.log(merged.q)
    log_waves = np.log(waves[known])
    summed = [np.exp(np.interp(log_waves, log_q, row)) @ areas[known] for row in logs]
    long_waves = np.reshape(summed, psd.shape[:-1])
    return long_waves + merged.moment(0, low=end, psd=psd) + merged.tail(psd)


def share_on_cells(
    topography: Topography, merged: OneSpectrum | None, cell_nm: float
) -> tuple[float, float]:
    """Share of the mean square height (nm^2) of all measured waves on cells, and that mean square.

    Parameters
    ----------
    merged : the measured spectrum, where it is used; None: eq. 9, flat beyond the longest wave of a
        cell.
    """
    if merged is not None:
        measured = merged.moment(0, low=merged.seen, psd=merged.psd)
        total = float(measured + merged.tail(merged.psd))
        return float(mean_square_of_cells(merged, merged.psd, cell_nm)) / total, total
    fitted = topography.likelihood
    if fitted is None:
        return 1.0, 0.0
    all_of_it = mean_square(fitted.plateau, fitted.q0, fitted.slope, topography.cutoff)
    if fitted.q0 >= 2.0 * np.pi / cell_nm:
        return 1.0, all_of_it
    waves, areas, end = cell_waves(cell_nm)
    total = mean_square(1.0, fitted.q0, fitted.slope, topography.cutoff)
    summed = mean_square(1.0, fitted.q0, fitted.slope, end)
    # a coarse film ends before the sum does
    areas = np.where(waves <= topography.cutoff, areas, 0.0)
    long_waves = (waves / fitted.q0) ** -fitted.slope @ areas
    share = (long_waves + max(total - summed, 0.0)) / total
    return float(share), all_of_it


def refuse_coarse_measurements(spectra: Sequence[TrustedSpectrum], cell_nm: float) -> None:
    """Refuse measurements that see next to no wave of a cell, before surfaces are made of guesses.

    Raises
    ------
    InputError : naming the finest measurement, its scale, and what would help.
    """
    finest, seen = _shortest_wave(spectra)
    if cell_nm < FINEST_WAVES * seen:
        raise InputError(
            f"topography: the shortest wave that {finest} shows is {seen:.3g} nm long, so that a"
            f" cell of contact.length_nm = {cell_nm:g} holds next to none that was measured;"
            f" measure on a finer scale, or set contact.length_nm to {SUITED_WAVES * seen:.2g} or"
            " more (leave it out: it is chosen) for the contact of the scales that were measured"
        )


def finer_waves_doubt(
    psd: Callable[[np.ndarray], np.ndarray], spectra: Sequence[TrustedSpectrum], cell_nm: float
) -> list[Doubt]:
    """What waves beyond the measured ones would change, where a cell holds few measured ones.

    Parameters
    ----------
    psd : C (nm^4) at wave vectors (1/nm), carried on for a decade beyond the measurements.
    """
    finest, seen = _shortest_wave(spectra)
    if cell_nm >= 16.0 * seen:  # the contact is mostly one of measured waves
        return []
    step = 2.0 * np.pi / cell_nm
    end = 2.0 * np.pi / seen
    effects = []
    for last in (end, 10.0 * end):
        q = np.geomspace(step, last, 400)
        spectrum = psd(q)
        rms = float(np.sqrt(np.trapezoid(2 * np.pi * q * spectrum, q)))
        slope = float(np.sqrt(np.trapezoid(2 * np.pi * q**3 * spectrum, q)))
        surfaces = (synthesize_spectrum(256, cell_nm, psd, rms, seed, last) for seed in range(8))
        effects.append((slope, float(np.mean([heights.max() for heights in surfaces]))))
    (cut_slope, cut_nm), (slope, contact_nm) = effects
    text = (
        f"cells of {cell_nm:g} nm are computed; the shortest wave that was measured is {seen:.3g}"
        f" nm long ({finest}); if the spectrum went on for a decade, the RMS slope would be"
        f" {slope:.2g} instead of {cut_slope:.2g}, and cells would touch at {contact_nm:.3g}"
        f" instead of {cut_nm:.3g} nm"
    )
    remedy = (
        "the answer is that of the scales measured; measure finer ones, or end the surfaces there"
        " (inputs.q1)"
    )
    return [Doubt("finer_waves", text, remedy, "contact")]


def rms_in_cells(
    heights: np.ndarray, lengths_nm: Sequence[float], cell_nm: float
) -> tuple[float, float] | None:
    """RMS height (nm) of a levelled map or line within cells of a side, without and with noise.

    Noise is at most what neighbouring points differ by. None where a cell has next to no points. A
    measurement smaller than the cell is taken as a whole.
    """
    sides = [
        round(n * cell_nm / length) for n, length in zip(heights.shape, lengths_nm, strict=True)
    ]
    if min(sides) < 4:
        return None
    for axis, side in enumerate(sides):
        count = max(heights.shape[axis] // side, 1)
        points = min(count * side, heights.shape[axis])
        cells = np.split(np.take(heights, range(points), axis), count, axis)
        # cells behind, so that the axes of a cell keep their places
        heights = np.moveaxis(np.stack(cells), 0, -1)
    inside = tuple(range(len(sides)))
    square = float(np.mean(np.var(heights, axis=inside)))
    noise = 0.5 * float(np.mean(np.diff(heights, axis=0) ** 2))
    return float(np.sqrt(max(square - noise, 0.0))), float(np.sqrt(square))


def unlike_measured(
    rms_nm: float, measured: Mapping[str, tuple[np.ndarray, Sequence[float]]], cell_nm: float
) -> list[Doubt]:
    """A doubt that stops, where the RMS height of cells is off the measured one by more than twice.

    Parameters
    ----------
    measured : levelled heights and lengths (nm) of the measurements, by name.
    """
    in_cells = {name: rms_in_cells(*map_nm, cell_nm) for name, map_nm in measured.items()}
    known = [rms_range for rms_range in in_cells.values() if rms_range]
    if not known:
        return []
    low = min(without_noise for without_noise, _ in known)
    high = max(with_noise for _, with_noise in known)
    if 0.5 * low <= rms_nm <= 2.0 * high:
        return []
    text = (
        f"cells of {cell_nm:g} nm would get an RMS height of {rms_nm:.3g} nm; on that length the"
        f" measurements have {low:.3g} to {high:.3g} nm"
    )
    remedy = (
        "measure an area that is larger than a cell, or set contact.length_nm to at most the size"
        " of the largest"
    )
    if any(min(lengths) > cell_nm for _, lengths in measured.values()):
        remedy = (
            "look for steps, particles or pits, which no random surface has, and crop them; if they"
            " belong to it, set topography.on_doubt to warn"
        )
    return [Doubt("rms_unlike_measured", text, remedy, "rms", fatal=True)]


def unseen_doubt(rms: Mapping[str, float], longest: float, cell_nm: float) -> list[Doubt]:
    """A doubt where a cell is longer than all that was measured."""
    if cell_nm <= 1.05 * longest:
        return []
    text = (
        f"cells of {cell_nm:g} nm are computed, and the largest measurement has {longest:.4g} nm;"
        f" longer waves are a guess, which makes the RMS height of a cell {rms['a']:.3g} to"
        f" {rms.get('b', rms['a']):.3g} nm"
    )
    return [Doubt("unseen_waves", text, "measure a larger area", "rms")]


def _shortest_wave(spectra: Sequence[TrustedSpectrum]) -> tuple[str, float]:
    """Name of the finest measurement, and the shortest wave (nm) that it shows."""
    finest = max(spectra, key=lambda item: item.high)
    return finest.name, 2.0 * np.pi / finest.high
