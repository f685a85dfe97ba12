"""The spectrum of equation 9: a plateau up to q0, a power law up to q1, nothing beyond."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

Convention = Literal["profile", "areal"]
OFFSET = {"profile": 1.0, "areal": 2.0}  # slope = 2 H + offset of the two-dimensional spectrum


def hurst_from_slope(slope: float, convention: Convention) -> float:
    """H from the fall of the two-dimensional spectrum, C ~ q^-slope."""
    return (slope - OFFSET[convention]) / 2


def slope_from_hurst(hurst: float, convention: Convention) -> float:
    """Inverse of `hurst_from_slope`."""
    return 2 * hurst + OFFSET[convention]


@dataclass(frozen=True)
class RoughSpectrum:
    """C(q) = plateau for q <= q0, plateau (q/q0)^-slope for q0 < q <= q1 (paper, equation 9).

    Attributes
    ----------
    plateau : C0, nm^4.
    q0, q1 : roll-off and end of the power law, 1/nm.
    slope : fall of the two-dimensional spectrum.
    """

    plateau: float
    q0: float
    slope: float
    q1: float

    @classmethod
    def from_rms(cls, rms_nm: float, q0: float, slope: float, q1: float) -> "RoughSpectrum":
        """The spectrum of a given RMS height."""
        return cls(rms_nm**2 / mean_square(1.0, q0, slope, q1), q0, slope, q1)

    def psd(self, q: np.ndarray) -> np.ndarray:
        """C(q) in nm^4 at wave vectors q (any shape) in 1/nm."""
        fall = np.maximum(q / self.q0, 1.0) ** -self.slope
        return np.where(q <= self.q1, self.plateau * fall, 0.0)

    @property
    def rms_nm(self) -> float:
        """RMS height from the integral of 2 pi q C(q) from zero to q1."""
        return float(np.sqrt(mean_square(self.plateau, self.q0, self.slope, self.q1)))

    @property
    def rms_slope(self) -> float:
        """RMS gradient of the heights; above about 1 a single-valued height map is hard to believe."""
        gradient = self.q0**4 / 4 + self.q0**self.slope * _power_integral(3 - self.slope, self.q0, self.q1)
        return float(np.sqrt(2 * np.pi * self.plateau * gradient))


def mean_square(plateau: float, q0: float, slope: float, q1: float) -> float:
    """Mean square height of equation 9, nm^2: plateau part plus power law."""
    return 2 * np.pi * plateau * (q0**2 / 2 + q0**slope * _power_integral(1 - slope, q0, q1))


def _power_integral(exponent: float, low: float, high: float) -> float:
    """Integral of q^exponent from low to high."""
    if high <= low:
        return 0.0
    power = exponent + 1
    if abs(power) < 1e-9:
        return float(np.log(high / low))
    return float((high**power - low**power) / power)
