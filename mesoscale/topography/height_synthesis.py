"""Random surfaces with a measured spectrum and measured heights: tall grains, deep pits.

A Gaussian surface g is carried to other heights point by point, z = F(g) (a translation process,
Grigoriu 1998, doi:10.1061/(ASCE)0733-9399(1998)124:2(121)). Unlike heights dealt out by rank, which
give every surface the very same summit, the highest point is then as random as that of g, and grows
with the area. F changes the correlation: with the Hermite coefficients c_n of F, a correlation r of
g becomes R = sum c_n^2 r^n / sum c_n^2. So g is drawn with the correlation whose R is the wanted
one.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from mesoscale.errors import InputError
from mesoscale.topography.synthesis import filtered_noise, squared_waves

Array = NDArray[np.float64]
Z = np.round(np.arange(-50, 61) / 10, 1)  # normal variable at which a height map states heights


def synthesize_heights(
    pixels: int,
    length_nm: float,
    psd: Callable[[Array], Array],
    heights: tuple[float, ...],
    rms: float,
    seed: int,
    q1: float | None = None,
) -> Array:
    """Periodic surface of an isotropic spectrum C(q), nm^4, with a height distribution.

    Parameters
    ----------
    heights : height in units of the RMS at each normal variable of `Z`, not falling; peaks are
        positive.

    The rest is as in `synthesis.synthesize_spectrum`; the same seed gives the same noise.

    Returns
    -------
    (pixels, pixels) heights in nm of mean zero and exactly the RMS height `rms`.

    Raises
    ------
    InputError : as `synthesize_spectrum`, or heights that are no distribution.
    """
    table = np.asarray(heights, dtype=float)
    rises = np.isfinite(table).all() and not np.any(np.diff(table) < 0)
    if table.shape != Z.shape or not rises or table[0] == table[-1]:
        raise InputError(
            f"heights: accepted are {len(Z)} values that do not fall, in units of the RMS height"
        )
    squared, step = squared_waves(pixels, length_nm, q1)
    power = np.concatenate([[0.0], psd(step * np.sqrt(squared))])
    if not np.isfinite(power).all() or not power.any():
        raise InputError(
            "the spectrum has no power on this surface; accepted are spectra between its waves"
        )
    amplitude = np.sqrt(_gaussian_power(pixels, power, tuple(map(float, heights))))
    gaussian = filtered_noise(pixels, amplitude, 1.0, seed)
    surface = np.interp(gaussian, Z, table)
    outside = gaussian > Z[-1]
    if outside.any():
        # beyond the table the heights rise as its last two do
        rise = table[-1] - table[-2]
        surface[outside] = table[-1] + (gaussian[outside] - Z[-1]) * rise / (Z[-1] - Z[-2])
    surface -= surface.mean()
    return surface * (rms / np.sqrt(np.mean(surface**2)))


def _gaussian_power(pixels: int, target: Array, heights: tuple[float, ...]) -> Array:
    """Spectrum by squared wave number of the Gaussian that F carries to `target`."""
    number_x = np.fft.fftfreq(pixels, 1 / pixels)[:, None]
    number_y = np.arange(pixels // 2 + 1)[None, :]
    squared_number = np.rint(number_x**2 + number_y**2).astype(np.int64)
    inside = squared_number < len(target)
    grid = np.zeros(squared_number.shape)
    grid[inside] = target[squared_number[inside]]
    correlation = np.asarray(fft.irfft2(grid, s=(pixels, pixels)))
    correlation /= correlation[0, 0]
    r, carried = _carried_correlation(heights)
    power = np.real(np.asarray(fft.rfft2(np.interp(correlation, carried, r))))
    # the mean over the waves of one length: the noise is filtered by it
    total = np.bincount(squared_number[inside], power[inside], len(target))
    count = np.bincount(squared_number[inside], minlength=len(target))
    mean = np.maximum(total / np.maximum(count, 1), 0.0)
    mean[0] = 0.0
    return np.where(target > 0, mean, 0.0)


@lru_cache(maxsize=8)
def _carried_correlation(heights: tuple[float, ...]) -> tuple[Array, Array]:
    """Correlations r of g in rising order and what F makes of them."""
    x, weight = np.polynomial.hermite_e.hermegauss(160)
    weight = weight / weight.sum()
    values = np.interp(x, Z, np.asarray(heights))
    # normalised Hermite polynomials by recursion
    previous = np.zeros_like(x)
    current = np.ones_like(x)
    squares = []
    terms = 24
    for n in range(terms):
        following = (x * current - np.sqrt(n) * previous) / np.sqrt(n + 1)
        previous = current
        current = following
        squares.append(float(np.sum(weight * values * current)) ** 2)
    share = np.array(squares) / np.sum(squares)
    r = np.linspace(-1, 1, 2001)
    powers = r[None, :] ** np.arange(1, terms + 1)[:, None]
    carried = np.sum(share[:, None] * powers, axis=0)
    return r, np.maximum.accumulate(carried)
