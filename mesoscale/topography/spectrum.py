"""Power spectra of scans: equations 7 and 8 of the paper, sections, windows, radial averages.

All spectra are two-dimensional, C(q) in nm^4, normalised so that the sum of C (2 pi / L)^2 over all
wave vectors is the mean square height (Parseval).  Averaging C over directions gives the isotropic
spectrum; its slope is the physical quantity from which either convention of the Hurst exponent
follows.
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy.fft

from mesoscale.topography.measurements.cleaning import Scan

FLOOR = 1e-300  # keeps logarithms of empty spectra finite


@dataclass(frozen=True)
class Spectrum:
    """Isotropic power spectrum of one scan on shells of equal width.

    Attributes
    ----------
    q : (m,) mean wave vector of each shell, 1/nm.
    psd : (m,) mean of C over the shell, nm^4.
    modes : (m,) number of independent complex amplitudes behind each mean (not an integer:
        overlapping sections and windows count for the area they really cover).
    spacing : width of a shell, 1/nm.
    nyquist : largest wave vector that the pixels resolve along both axes, 1/nm.
    sharp : window and shells lift nothing any more (a converted line profile): nothing to correct.
    """

    q: np.ndarray
    psd: np.ndarray
    modes: np.ndarray
    spacing: float
    nyquist: float
    sharp: bool = False


def flat_window(n: int, flat: float) -> np.ndarray:
    """Window of n points, one over the central share `flat`, a half cosine at both ends.

    `flat = 0` is the Hann window.
    """
    distance = (np.arange(n) + 0.5) / n
    distance = np.minimum(distance, 1 - distance)
    edge = (1 - flat) / 2
    if edge <= 0:
        return np.ones(n)
    edge_wave = np.cos(np.pi * np.minimum(distance / edge, 1))
    return np.where(distance >= edge, 1.0, 0.5 * (1 - edge_wave))


def section_starts(pixels: int, section: int, count: int) -> np.ndarray:
    """First pixels of `count` sections spread evenly over one axis, duplicates removed."""
    return np.unique(np.round(np.linspace(0, pixels - section, count)).astype(int))


def section_pixels(pixels: int, fraction: float) -> int:
    """Side of a section: a fast FFT size near `fraction` of the scan (768 of 1024)."""
    pixels_near = max(16, round(pixels * fraction))
    return min(pixels, scipy.fft.next_fast_len(pixels_near, True) or pixels_near)


def hann_spectrum(cleaned: Scan, sections: int = 25, flat: float = 0.0) -> Spectrum:
    """The spectrum of a cleaned scan that the fits use, without what line offsets disturb.

    Sections have the paper's side (section 4.2). With a Hann window they overlap more than its 100
    nearly flat ones: more than 25 add nothing.
    """
    return radial_spectrum(
        cleaned.heights_nm, cleaned.lengths_nm, sections, 0.75, flat, skip_lines=True
    )


def radial_spectrum(
    heights: np.ndarray,
    lengths_nm: tuple[float, float],
    sections: int,
    fraction: float,
    flat: float,
    skip_lines: bool = False,
) -> Spectrum:
    """Isotropic spectrum averaged over overlapping windowed sections (paper, section 4.2).

    Parameters
    ----------
    heights : (nx, ny) in nm, first axis the fast scan direction.
    sections : number of sections, rounded to a square number.
    fraction : side of a section over side of the scan.
    flat : flat share of the window; 0.99 is the paper's, 0 the Hann window, whose side lobes do not
        cover steep spectra.
    skip_lines : leave out the two lowest wave numbers along the fast direction, where offsets
        between scan lines (and their alignment) act.
    """
    nx, ny = heights.shape
    per_side = max(1, round(np.sqrt(sections)))
    mx = section_pixels(nx, fraction)
    my = section_pixels(ny, fraction)
    xs = section_starts(nx, mx, per_side)
    ys = section_starts(ny, my, per_side)
    wx = flat_window(mx, flat)
    wy = flat_window(my, flat)
    window = np.outer(wx, wy).astype(np.float32)
    data = np.ascontiguousarray(heights, dtype=np.float32)  # 7 digits; spectra span fewer
    total = np.zeros((mx, my // 2 + 1))
    for x in xs:
        for y in ys:
            section = data[x : x + mx, y : y + my]
            z = np.asarray(scipy.fft.rfft2((section - section.mean()) * window, overwrite_x=True))
            total += np.real(z) ** 2 + np.imag(z) ** 2
    total /= len(xs) * len(ys)

    size = lengths_nm[0] * mx / nx, lengths_nm[1] * my / ny
    cell = size[0] * size[1] / (mx * my)
    window_power = float(np.mean(wx**2) * np.mean(wy**2))
    power = size[0] * size[1] * window_power
    psd = total * (cell / (2 * np.pi)) ** 2 / power

    kx = np.abs(np.fft.fftfreq(mx, 1 / mx)).astype(int)
    ky = np.arange(my // 2 + 1)
    qx = 2 * np.pi / size[0] * kx
    qy = 2 * np.pi / size[1] * ky
    spacing = max(2 * np.pi / size[0], 2 * np.pi / size[1])
    nyquist = min(np.pi * mx / size[0], np.pi * my / size[1])
    q = np.sqrt(qx[:, None] ** 2 + qy[None, :] ** 2)
    shell = np.rint(q / spacing).astype(np.int64)
    # the half plane holds both of a pair of opposite waves but on its edges
    on_edge = (ky == 0) | ((ky == my // 2) & (my % 2 == 0))
    weight = np.where(on_edge, 0.5, 1.0) * np.ones_like(q)
    if skip_lines:
        weight[kx <= 1] = 0.0
    count = int(nyquist / spacing)
    inside = shell <= count
    index = shell[inside]
    weight = weight[inside]
    modes = np.bincount(index, weight, count + 1)[1:]
    known = modes > 0
    with np.errstate(invalid="ignore", divide="ignore"):
        q_sum = np.bincount(index, weight * q[inside], count + 1)[1:]
        psd_sum = np.bincount(index, weight * psd[inside], count + 1)[1:]
        mean_q = (q_sum / modes)[known]
        mean_psd = (psd_sum / modes)[known]
    area = _covered(nx, xs, wx) / mx * _covered(ny, ys, wy) / my
    mean_psd = np.maximum(mean_psd, FLOOR)
    return Spectrum(mean_q, mean_psd, modes[known] * area, float(spacing), float(nyquist))


def _covered(pixels: int, starts: np.ndarray, window: np.ndarray) -> float:
    """Length, in pixels, of the data that the shifted windows really average over.

    The variance of a spectrum averaged over windowed sections is that of a boxcar of length
    (sum W)^2 / sum W^2, with W the mean of the squared shifted windows.
    """
    weight = np.zeros(pixels)
    for start in starts:
        weight[start : start + len(window)] += window**2
    return float(weight.sum() ** 2 / np.sum(weight**2))


def log_bins(spectrum: Spectrum, per_decade: int = 12) -> Spectrum:
    """The spectrum on bins of equal width in log q; each bin holds at least one shell."""
    grid = np.floor(np.log10(spectrum.q) * per_decade).astype(int)
    _, index = np.unique(grid, return_inverse=True)
    modes = np.bincount(index, spectrum.modes)
    q = np.exp(np.bincount(index, spectrum.modes * np.log(spectrum.q)) / modes)
    psd = np.bincount(index, spectrum.modes * spectrum.psd) / modes
    return replace(spectrum, q=q, psd=psd, modes=modes)
