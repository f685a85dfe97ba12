"""The spectrum of equation 9: a plateau up to q0, a power law up to q1, nothing beyond."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from mesoscale.errors import InputError

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
        """RMS gradient of the heights; above about 1 a single-valued map is hard to believe."""
        steep_waves = _power_integral(3 - self.slope, self.q0, self.q1)
        gradient = self.q0**4 / 4 + self.q0**self.slope * steep_waves
        return float(np.sqrt(2 * np.pi * self.plateau * gradient))


class SpectrumTable:
    """A spectrum by points, for instance a measured one: straight in log q and log C.

    Below the first point it stays at the first value, above the last it is zero.

    Parameters
    ----------
    q, psd : (m,) wave vectors (1/nm) and C (nm^4), at least two points of positive values in rising
        order of q.
    """

    def __init__(self, q: Sequence[float] | np.ndarray, psd: Sequence[float] | np.ndarray):
        self.q = np.asarray(q, dtype=float)
        self.values = np.asarray(psd, dtype=float)
        one_length = self.q.ndim == 1 and self.q.shape == self.values.shape
        if not one_length or len(self.q) < 2:
            raise InputError(
                "spectrum: accepted are two lists of one length, q (1/nm) and C (nm^4), of two"
                " values or more"
            )
        finite = np.isfinite(self.q).all() and np.isfinite(self.values).all()
        rises = self.q[0] > 0 and not np.any(np.diff(self.q) <= 0)
        if not finite or not rises or np.any(self.values <= 0):
            raise InputError("spectrum: accepted are positive finite values with q in rising order")

    def psd(self, q: np.ndarray) -> np.ndarray:
        """C(q) in nm^4 at wave vectors q (any shape) in 1/nm."""
        known = np.log(np.maximum(q, self.q[0]))
        log_psd = np.interp(known, np.log(self.q), np.log(self.values))
        values = np.exp(log_psd)
        return np.where(q <= self.q[-1], values, 0.0)

    def scaled(self, rms_nm: float, q1: float) -> "SpectrumTable":
        """The same shape with an RMS height, which 2 pi q C(q) has from zero to q1."""
        return SpectrumTable(self.q, self.values * rms_nm**2 / self.mean_square(q1))

    def mean_square(self, q1: float) -> float:
        """Mean square height, nm^2: the integral of 2 pi q C(q) from zero to q1."""
        low = self.q[0]
        high = min(q1, self.q[-1])
        square = np.pi * self.values[0] * min(low, q1) ** 2
        if high > low:
            inside = self.q[self.q < high]
            q = np.unique(np.concatenate([inside, np.geomspace(low, high, 2001)]))
            square += np.trapezoid(2 * np.pi * q * self.psd(q), q)
        return float(square)


def mean_square(plateau: float, q0: float, slope: float, q1: float) -> float:
    """Mean square height of equation 9, nm^2: plateau part plus power law."""
    falling = q0**slope * _power_integral(1 - slope, q0, q1)
    return 2 * np.pi * plateau * (q0**2 / 2 + falling)


def _power_integral(exponent: float, low: float, high: float) -> float:
    """Integral of q^exponent from low to high."""
    if high <= low:
        return 0.0
    power = exponent + 1
    if abs(power) < 1e-9:
        return float(np.log(high / low))
    return float((high**power - low**power) / power)
