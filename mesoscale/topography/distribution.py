"""Surfaces whose heights are not normally distributed, with the spectrum they had before.

The heights of ground, worn or grainy surfaces are skewed. Mapping a Gaussian surface to another distribution of
heights changes its spectrum, and restoring the spectrum changes the distribution; doing both in turn converges to a
surface with both (Perez-Rafols and Almqvist, doi:10.1016/j.triboint.2018.10.020).
"""

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from mesoscale.errors import InputError

Array = NDArray[np.float64]
ROUNDS = 12  # each costs a sort and two transforms; more change the spectrum by less than a realisation differs
MAX_RESIDUAL = 1e-6


def with_moments(heights: Array, skewness: float, kurtosis: float) -> Array:
    """A surface with the waves of a Gaussian one, but skewed and of another kurtosis.

    Parameters
    ----------
    heights : (n, n) periodic Gaussian surface of mean zero, nm.
    skewness, kurtosis : third and fourth standardised moments; 0 and 3 for a normal distribution.

    Returns
    -------
    (n, n) heights of the same RMS, of the wanted moments to within the grid's resolution of their tails; the modulus
    of each wave is nearly that of `heights`.

    Raises
    ------
    InputError : no cubic of a normal variable has these moments.
    """
    rms = float(np.sqrt(np.mean(heights**2)))
    values = rms * _sorted_values(heights.size, skewness, kurtosis)
    modulus = np.abs(np.asarray(fft.rfft2(heights)))
    surface = _with_values(heights, values)
    for _ in range(ROUNDS):
        waves = np.asarray(fft.rfft2(surface))
        waves *= modulus / np.maximum(np.abs(waves), np.finfo(float).tiny)
        surface = _with_values(np.asarray(fft.irfft2(waves, s=heights.shape)), values)
    return surface


def _with_values(heights: Array, values: Array) -> Array:
    """The lowest site gets the lowest value, and so on."""
    result = np.empty(heights.size)
    result[np.argsort(heights, axis=None)] = values
    return result.reshape(heights.shape)


def _sorted_values(count: int, skewness: float, kurtosis: float) -> Array:
    """Ascending values of mean 0 and standard deviation 1 with the wanted moments."""
    from scipy.special import ndtri

    a, b, c = _cubic(skewness, kurtosis)
    normal = ndtri((np.arange(count) + 0.5) / count)
    values = np.sort(a * normal + b * (normal**2 - 1) + c * normal**3)
    values -= values.mean()
    return values / values.std()


def _cubic(skewness: float, kurtosis: float) -> tuple[float, float, float]:
    """a, b, c of a z + b (z^2 - 1) + c z^3 with unit variance and the wanted moments (doi:10.1007/BF02293811)."""
    from scipy.optimize import root

    def miss(at: Array) -> list[float]:
        a, b, c = at
        return [
            a**2 + 6 * a * c + 2 * b**2 + 15 * c**2 - 1,
            2 * b * (a**2 + 24 * a * c + 105 * c**2 + 2) - skewness,
            24 * (a * c + b**2 * (1 + a**2 + 28 * a * c) + c**2 * (12 + 48 * a * c + 141 * b**2 + 225 * c**2))
            - (kurtosis - 3),
        ]

    found = root(miss, [1.0, skewness / 6, 0.0], tol=1e-12)
    if np.max(np.abs(miss(found.x))) > MAX_RESIDUAL:
        raise InputError(
            f"contact.surface: no surface with skewness {skewness:g} and kurtosis {kurtosis:g}; "
            f"accepted is a kurtosis above about {1.64 * skewness**2 + 1.8:.1f} at this skewness"
        )
    return float(found.x[0]), float(found.x[1]), float(found.x[2])
