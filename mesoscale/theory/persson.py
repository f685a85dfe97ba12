"""Persson's theory of the elastic contact of a rough surface, without adhesion.

The theory takes the surface as Gaussian and of small slopes. It knows the surface by its RMS
gradient alone: the square root of the mean of (grad h)^2 over the area. It is exact at full
contact. At light loads computed contacts have 15 to 40 % more area, by grid and spectrum.

Sources: B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840, doi 10.1063/1.1388626; W. Manners and J.
A. Greenwood, Wear 261 (2006) 600, doi 10.1016/j.wear.2006.01.004.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import special

Real = float | NDArray[np.float64]


def persson_area_share(mean_pressure: Real, rms_gradient: Real, e_star: Real) -> Real:
    """Share of the area in contact: erf(sqrt(2) p / (E* h')).

    Parameters
    ----------
    mean_pressure : GPa
        Force over nominal area.
    rms_gradient : 1
        Of both surfaces together.
    e_star : GPa
    """
    return special.erf(np.sqrt(2.0) * mean_pressure / (e_star * rms_gradient))


def persson_pressure_density(
    pressure: Real, mean_pressure: Real, rms_gradient: Real, e_star: Real
) -> Real:
    """Probability density (1/GPa) of a local pressure above zero; its integral is the area share.

    P(s) = [exp(-(s - p)^2 / (2 V)) - exp(-(s + p)^2 / (2 V))] / sqrt(2 pi V), V = (E* h' / 2)^2.

    Parameters
    ----------
    pressure : GPa, above 0
    mean_pressure : GPa
    rms_gradient : 1
    e_star : GPa
    """
    deviation = 0.5 * e_star * rms_gradient  # of the pressures at full contact
    direct = np.exp(-0.5 * ((pressure - mean_pressure) / deviation) ** 2)
    mirrored = np.exp(-0.5 * ((pressure + mean_pressure) / deviation) ** 2)
    return (direct - mirrored) / (np.sqrt(2.0 * np.pi) * deviation)
