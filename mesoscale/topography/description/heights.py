"""How the heights of scans are distributed, and whether a Gaussian surface of their spectrum has
such heights.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mesoscale.topography.height_synthesis import Z
from mesoscale.topography.roughness_spectrum import SpectrumTable
from mesoscale.topography.spectrum import radial_spectrum
from mesoscale.topography.synthesis import synthesize_spectrum


@dataclass(frozen=True)
class HeightTest:
    """Statistics of a scan's heights beside Gaussian surfaces of its own spectrum.

    Attributes
    ----------
    skewness, kurtosis, highest : of the scan; highest point above the mean plane in units of the
        RMS height.
    expected, spread : (3,) mean and standard deviation of the same on 39 Gaussian surfaces.
    anisotropy : RMS slope along the steepest direction over that across it; 1 for an isotropic
        surface."""

    name: str
    skewness: float
    kurtosis: float
    highest: float
    expected: np.ndarray
    spread: np.ndarray
    anisotropy: float = 1.0

    @property
    def away(self) -> np.ndarray:
        """(3,) distance from the Gaussian surfaces in their standard deviations."""
        return (
            np.array([self.skewness, self.kurtosis, self.highest]) - self.expected
        ) / self.spread


def compare_heights(name: str, heights: np.ndarray, lengths_nm: tuple[float, float]) -> HeightTest:
    """Set the central square of a scan's levelled heights (nx, ny; nm) beside Gaussian surfaces."""
    heights, pixel_nm = square_pixels(heights, lengths_nm)
    n = min(heights.shape)
    i, j = ((side - n) // 2 for side in heights.shape)
    square = np.asarray(heights[i : i + n, j : j + n], dtype=float)
    side = n * pixel_nm
    spectrum = radial_spectrum(square, (side, side), 9, 0.75, flat=0.0)
    psd = SpectrumTable(spectrum.q, spectrum.psd).psd
    gaussian = np.array(
        [moments(synthesize_spectrum(n, side, psd, 1.0, seed)) for seed in range(39)]
    )
    skewness, kurtosis, highest = moments(square)
    expected = gaussian.mean(axis=0)
    spread = gaussian.std(axis=0, ddof=1)
    return HeightTest(name, skewness, kurtosis, highest, expected, spread, slope_ratio(square))


def square_pixels(heights: np.ndarray, lengths_nm: tuple[float, float]) -> tuple[np.ndarray, float]:
    """Heights (nx, ny) read at the steps of their coarser axis along both, and that step, nm."""
    steps = [length / n for length, n in zip(lengths_nm, heights.shape, strict=True)]
    step = max(steps)
    for axis, fine in enumerate(steps):
        if fine < 0.99 * step:
            count = heights.shape[axis]
            place = np.arange(0.0, count - 1, step / fine)
            left = place.astype(int)
            share = np.expand_dims(place - left, 1 - axis)
            heights = (1 - share) * np.take(heights, left, axis) + share * np.take(
                heights, left + 1, axis
            )
    return heights, step


def slope_ratio(heights: np.ndarray) -> float:
    """RMS slope of heights (n, n) along the steepest direction over that across it, from the tensor
    of slopes.
    """
    x, y = (part.ravel() for part in np.gradient(heights))
    low, high = np.linalg.eigvalsh(np.array([[x @ x, x @ y], [x @ y, y @ y]]))
    return float(np.sqrt(high / max(low, 1e-12 * high))) if high > 0 else 1.0


def moments(heights: np.ndarray) -> tuple[float, float, float]:
    """Skewness, kurtosis, and the highest point in units of the RMS height."""
    z = heights - heights.mean()
    z /= np.sqrt(np.mean(z**2))
    square = z * z  # the power function takes ten times as long
    return float(np.mean(square * z)), float(np.mean(square * square)), float(z.max())


def not_gaussian(tests: Sequence[HeightTest]) -> str:
    """In words what of the heights no Gaussian surface has; empty where nothing stands out.

    A statistic stands out where the scans together are two standard deviations away, and far enough
    to change a contact."""
    if not tests:
        return ""
    together = np.sum([test.away for test in tests], axis=0) / np.sqrt(len(tests))
    skewness, kurtosis, highest = (
        np.mean([getattr(test, key) for test in tests])
        for key in ("skewness", "kurtosis", "highest")
    )
    expected = np.mean([test.expected for test in tests], axis=0)
    far = (  # less hardly changes a contact
        abs(skewness - expected[0]) > 0.3,
        abs(kurtosis - expected[1]) > 0.15 * expected[1],
        abs(highest / expected[2] - 1) > 0.15,
    )
    words = (
        f"skewness {skewness:.2f} where Gaussian surfaces have {expected[0]:.2f}",
        f"kurtosis {kurtosis:.2f} where they have {expected[1]:.2f}",
        f"highest point {highest:.2f} RMS where they reach {expected[2]:.2f}",
    )
    return "; ".join(
        f"{word} ({away:+.1f} standard deviations)"
        for word, away, enough in zip(words, together, far, strict=True)
        if enough and abs(away) > 2.0
    )


def height_quantiles(heights: np.ndarray) -> np.ndarray:
    """Heights of a scan in units of its RMS at each normal variable of `Z`, with the tails carried
    on straight.
    """
    from scipy.special import ndtr, ndtri

    values = np.sort(heights, axis=None)
    values = (values - values.mean()) / values.std()
    count = len(values)
    place = (np.arange(count) + 0.5) / count
    table = np.interp(ndtr(Z), place, values)
    for side in (1, -1):
        end = float(ndtri(1 - 0.5 / count))
        outside = side * Z > end
        near = (side * Z <= end) & (side * Z >= end - 1.0)
        slope = max(np.polyfit(Z[near], table[near], 1)[0], 0.0)
        edge = Z[near][-1] if side > 0 else Z[near][0]
        start = table[near][-1] if side > 0 else table[near][0]
        table[outside] = start + slope * (Z[outside] - edge)
    return np.maximum.accumulate(table)


def common_heights(quantiles: Sequence[np.ndarray]) -> tuple[float, ...]:
    """The height map of a surface from those of its scans (each (len(Z),)), of mean 0 and variance
    1.
    """
    table = np.mean(quantiles, axis=0)
    density = np.exp(-(Z**2) / 2)
    density /= density.sum()
    table = table - np.sum(density * table)
    table /= np.sqrt(np.sum(density * table**2))
    return tuple(float(value) for value in np.round(table, 6))
