"""Distribution of the heights of scans, compared with Gaussian surfaces of their spectrum."""

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
        surface.
    """

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
    surfaces = (synthesize_spectrum(n, side, psd, 1.0, seed) for seed in range(39))
    gaussian = np.array([moments(surface) for surface in surfaces])
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
            before = (1 - share) * np.take(heights, left, axis)
            heights = before + share * np.take(heights, left + 1, axis)
    return heights, step


def slope_ratio(heights: np.ndarray) -> float:
    """RMS slope of heights (n, n) along the steepest direction over that across it."""
    slope_x, slope_y = np.gradient(heights)
    x = slope_x.ravel()
    y = slope_y.ravel()
    tensor = np.array([[x @ x, x @ y], [x @ y, y @ y]])
    low, high = np.linalg.eigvalsh(tensor)
    if high <= 0:
        return 1.0
    return float(np.sqrt(high / max(low, 1e-12 * high)))


def moments(heights: np.ndarray) -> tuple[float, float, float]:
    """Skewness, kurtosis, and the highest point in units of the RMS height."""
    z = heights - heights.mean()
    z /= np.sqrt(np.mean(z**2))
    square = z * z  # the power function takes ten times as long
    skewness = float(np.mean(square * z))
    kurtosis = float(np.mean(square * square))
    return skewness, kurtosis, float(z.max())


def not_gaussian(tests: Sequence[HeightTest]) -> str:
    """In words what of the heights no Gaussian surface has; empty where nothing stands out.

    A statistic stands out where the scans together are two standard deviations away, and far enough
    to change a contact.
    """
    if not tests:
        return ""
    total_away = np.sum([test.away for test in tests], axis=0)
    together = total_away / np.sqrt(len(tests))
    skewness = np.mean([test.skewness for test in tests])
    kurtosis = np.mean([test.kurtosis for test in tests])
    highest = np.mean([test.highest for test in tests])
    expected = np.mean([test.expected for test in tests], axis=0)
    # less hardly changes a contact
    skewed = abs(skewness - expected[0]) > 0.3
    peaked = abs(kurtosis - expected[1]) > 0.15 * expected[1]
    high = abs(highest / expected[2] - 1) > 0.15
    words = (
        f"skewness {skewness:.2f} where Gaussian surfaces have {expected[0]:.2f}",
        f"kurtosis {kurtosis:.2f} where they have {expected[1]:.2f}",
        f"highest point {highest:.2f} RMS where they reach {expected[2]:.2f}",
    )
    rows = zip(words, together, (skewed, peaked, high), strict=True)
    return "; ".join(
        f"{word} ({away:+.1f} standard deviations)"
        for word, away, far in rows
        if far and abs(away) > 2.0
    )


def height_quantiles(heights: np.ndarray) -> np.ndarray:
    """Heights of a scan over its RMS at each normal variable of `Z`; tails carried on straight."""
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
        nearest = -1 if side > 0 else 0
        edge = Z[near][nearest]
        start = table[near][nearest]
        table[outside] = start + slope * (Z[outside] - edge)
    return np.maximum.accumulate(table)


def common_heights(quantiles: Sequence[np.ndarray]) -> tuple[float, ...]:
    """The height map of a surface from those of its scans, (len(Z),) each; mean 0, variance 1."""
    table = np.mean(quantiles, axis=0)
    density = np.exp(-(Z**2) / 2)
    density /= density.sum()
    table = table - np.sum(density * table)
    table /= np.sqrt(np.sum(density * table**2))
    return tuple(float(value) for value in np.round(table, 6))
