"""Pairs of measurements that see common waves: do their spectra agree?"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mesoscale.errors import InputError
from mesoscale.topography.description.bands import BANDS_PER_DECADE, on_bands
from mesoscale.topography.description.intervals import REACH
from mesoscale.topography.description.trusted_range import TrustedSpectrum

MOST_MISFIT = 3.0
"""Of reduced chi^2 of a common shape: of 143 pairs of maps of one simulated surface none reaches
1.8.
"""


@dataclass(frozen=True)
class Overlap:
    """Two measurements where both see the surface.

    Attributes
    ----------
    first, second : their names.
    low, high : shared wave vectors, 1/nm.
    ratio : C of the second over that of the first, geometric mean over the shared bands.
    expected : factor within which they should agree, by their own errors alone, at 90 %.
    misfit : reduced chi^2 of one ratio for all shared bands: far above 1 where the spectra differ
        in shape.
    """

    first: str
    second: str
    low: float
    high: float
    ratio: float
    expected: float
    misfit: float

    def one_surface(self, chance: float) -> bool:
        """Can these be places of one surface? A share `chance` of such pairs is denied."""
        from scipy.special import ndtri

        deviations = float(ndtri(1 - chance / 2))
        largest = np.hypot(np.log(self.expected), deviations * np.sqrt(2) * 0.8)
        return bool(abs(np.log(self.ratio)) <= largest and self.misfit <= MOST_MISFIT)

    @property
    def agrees(self) -> bool:
        """Do they agree within their own errors?"""
        return bool(max(self.ratio, 1 / self.ratio) <= self.expected)


def overlaps(spectra: Sequence[TrustedSpectrum]) -> list[Overlap]:
    """Pairs of unlike size or kind that share bands, the largest shared range first."""
    bands = [(item, *on_bands(item)) for item in spectra]
    pairs = []
    for i, (first, numbers, level, variance) in enumerate(bands):
        for second, other, other_level, other_variance in bands[i + 1 :]:
            common, a, b = np.intersect1d(numbers, other, return_indices=True)
            if len(common) == 0:
                continue
            weight = 1 / (variance[a] + other_variance[b])
            apart = other_level[b] - level[a]
            difference = float(np.sum(weight * apart) / weight.sum())
            squares = float(np.sum(weight * (apart - difference) ** 2))
            misfit = squares / max(len(common) - 1, 1)
            # errors of neighbouring bands go together: no more certain than a typical band
            spread = float(np.sqrt(1 / weight.mean()))
            edges = 10 ** (np.array([common[0], common[-1] + 1]) / BANDS_PER_DECADE)
            expected = float(np.exp(REACH * spread))
            ratio = float(np.exp(difference))
            pairs.append(
                Overlap(first.name, second.name, edges[0], edges[1], ratio, expected, misfit)
            )
    return sorted(pairs, key=lambda item: item.low / item.high)


def refuse_different_films(pairs: Sequence[Overlap]) -> None:
    """Refuse measurements that cannot be of one surface.

    Raises
    ------
    InputError : naming the two that differ most.
    """
    worst = max(pairs, key=lambda pair: abs(np.log(pair.ratio)), default=None)
    most = 100.0  # of C: a factor of 10 in RMS height
    if worst is not None and max(worst.ratio, 1 / worst.ratio) > most * worst.expected:
        raise InputError(
            f"topography.scans: {worst.first} and {worst.second} cannot be one surface: between"
            f" {worst.low:.2g} and {worst.high:.2g} /nm their spectra differ by a factor of"
            f" {max(worst.ratio, 1 / worst.ratio):.3g}; accepted is {most:g}; give the files of one"
            " film, or correct a unit or a height scale"
        )
