"""The spectrum of one measurement on bands of log q, and what its mean square height adds."""

from dataclasses import dataclass, replace

import numpy as np

from mesoscale.topography.description.likelihood import DISCREPANCY
from mesoscale.topography.description.trusted_range import TrustedSpectrum, with_ends
from mesoscale.topography.profile_conversion import COVER

BANDS_PER_DECADE = 10


def on_bands(item: TrustedSpectrum) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of the bands that a measurement reaches, ln C at their centres, and its variance."""
    inside, corrected, error = with_ends(item)
    nothing = np.empty(0, dtype=int), np.empty(0), np.empty(0)
    if inside.sum() < 3:
        return nothing
    q = item.spectrum.q[inside]
    psd = corrected[inside]
    modes = item.spectrum.modes[inside]
    grid = np.floor(np.log10(q) * BANDS_PER_DECADE).astype(int)
    numbers, index = np.unique(grid, return_inverse=True)
    worth = np.bincount(index, modes)
    centre = np.bincount(index, modes * np.log(q)) / worth
    # the logarithm of a mean of few amplitudes is on average too small: by 1 / 2n for n of them
    level = np.log(np.bincount(index, modes * psd) / worth)
    if not item.spectrum.sharp:
        level = level + np.minimum(0.5 / worth, 0.3)
    if len(numbers) < 2:
        return nothing
    middle = (numbers + 0.5) / BANDS_PER_DECADE * np.log(10)
    # a band that is only half covered is read at its centre along the measurement's own slope
    slope = np.gradient(level, centre)
    # the mean over a band of a power law is above its middle
    width = np.bincount(index, modes * np.log(q) ** 2) / worth - centre**2
    level = level - 0.5 * slope**2 * np.maximum(width, 0.0)
    tip = np.bincount(index, modes * error[inside]) / worth
    return numbers, level + slope * (middle - centre), 1 / worth + DISCREPANCY**2 + tip**2


@dataclass(frozen=True)
class Seen:
    """Waves in the mean square height of a levelled measurement, and those in its bands.

    Surfaces of C ~ q^-1 to q^-4 without a plateau hold, levelled by a plane, the waves from 0.63 to
    0.81 a side on; so do lines (Brownian ones from 0.76 on). A parabola takes waves 1.3 times as
    short with it.

    Attributes
    ----------
    length_nm : side of a map, or length of a line.
    parabola : it was levelled by one.
    line : of a line only the waves along it count, from which those across it are seen as longer
        ones.
    low, high : ends of the waves in its bands, 1/nm.
    in_bands_nm2 : their mean square height as its window sees them.
    """

    length_nm: float
    parabola: bool
    line: bool
    low: float
    high: float
    in_bands_nm2: float = 0.0

    @property
    def first(self) -> float:
        """Wave vector of the longest, 1/nm."""
        waves = 0.94 if self.parabola else 0.72
        return waves * 2 * np.pi / self.length_nm

    @property
    def common(self) -> float:
        """Share of the bands' chance in the mean square: 1 over the variance that a window adds.

        Of a window w it is <w^2>^2 / <w^4>: 18/35 for Hann's, once a side, and `COVER` for the
        tapers of a line.
        """
        return COVER if self.line else (18 / 35) ** 2

    def share(self, q: np.ndarray, first: float | None = None) -> np.ndarray:
        """Part of the isotropic waves at q (m,) in 1/nm, all at least the first."""
        if not self.line:
            return np.ones_like(q)
        nearest = np.minimum((first or self.first) / q, 1.0)
        return 2 / np.pi * np.arccos(nearest)

    def share_in_bands(self, q: np.ndarray) -> np.ndarray:
        """Part of the isotropic waves at q (m,) in 1/nm that is in the bands."""
        beyond_bands = self.share(q, self.high) if self.line else 0.0
        return self.share(q, self.low) - beyond_bands

    def scatter(self, q: np.ndarray, logs: np.ndarray, low: float, high: float) -> np.ndarray:
        """Relative scatter of the mean square of waves from low to high (1/nm), from their number.

        Parameters
        ----------
        logs : (..., m) ln C on q.
        """
        points = np.geomspace(min(low, high), high, 24)
        density = np.exp(at_points(points, q, logs))
        area = points * (2 * np.pi * points)
        wave = (2 * np.pi / self.length_nm) ** 2
        if self.line:
            # of a power law C1 is C q times a number; an integral over ln q
            density = density * points
            area = points * 2.0
            wave = 2 * np.pi / self.length_nm
        area = area * np.log(points[1] / points[0])
        return np.sqrt(2 * wave * (density**2 @ area)) / (density @ area)


def at_points(points: np.ndarray, q: np.ndarray, values: np.ndarray) -> np.ndarray:
    """(..., n) values (..., m) at q, read at points (n,) by straight lines over ln q."""
    bands = np.arange(len(q))
    place = np.interp(np.log(points), np.log(q), bands)
    left = np.clip(place.astype(int), 0, len(q) - 2)
    share = place - left
    return values[..., left] * (1 - share) + values[..., left + 1] * share


def seen_by(item: TrustedSpectrum) -> Seen | None:
    """Waves in the levelled heights of a measurement; None without size or bands."""
    line = item.line is not None
    length_nm = 2 * np.pi / item.spectrum.spacing if line else item.side_nm
    numbers, level, _ = on_bands(item)
    if length_nm == 0 or len(numbers) == 0:
        return None
    width = np.log(10) / BANDS_PER_DECADE
    q = 10 ** ((numbers + 0.5) / BANDS_PER_DECADE)
    low = float(q[0] * np.exp(-width / 2))
    high = float(q[-1] * np.exp(width / 2))
    seen = Seen(length_nm, item.parabola, line, low, high)
    density = 2 * np.pi * q**2 * np.exp(level)
    square = float(np.sum(density * seen.share_in_bands(q)) * width)
    return replace(seen, in_bands_nm2=square)
