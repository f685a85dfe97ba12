"""The contact of Greenwood and Williamson: summits that do not know of each other.

All summits have one radius and Gaussian heights; each carries as Hertz's sphere. Summits of a
random surface follow from three moments of its spectrum.

Sources: J. A. Greenwood and J. B. P. Williamson, Proc. R. Soc. Lond. A 295 (1966) 300, doi
10.1098/rspa.1966.0242; P. R. Nayak, J. Lubr. Technol. 93 (1971) 398, doi 10.1115/1.3451608; J. I.
McCool, Wear 107 (1986) 37, doi 10.1016/0043-1648(86)90045-1.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import special


@dataclass(frozen=True)
class Summits:
    """Summits of a rough surface.

    Attributes
    ----------
    density : number in an area, 1/nm^2.
    radius : of curvature, nm.
    scatter : standard deviation of their heights, nm.
    above_mean : height of their mean above the surface's mean plane, nm.
    """

    density: float
    radius: float
    scatter: float
    above_mean: float


def summits_of(
    mean_square: float, mean_square_slope: float, mean_square_curvature: float
) -> Summits:
    """Summits of an isotropic Gaussian surface (Nayak 1971; McCool 1986).

    Parameters
    ----------
    mean_square : nm^2
        m0, mean square of the heights.
    mean_square_slope : 1
        m2, mean square of the slope along a line, half of that of the gradient.
    mean_square_curvature : 1/nm^2
        m4, mean square of the second derivative along a line.
    """
    bandwidth = mean_square * mean_square_curvature / mean_square_slope**2
    return Summits(
        density=mean_square_curvature / (6.0 * np.pi * np.sqrt(3.0) * mean_square_slope),
        radius=0.375 * np.sqrt(np.pi / mean_square_curvature),
        scatter=float(np.sqrt((1.0 - 0.8968 / bandwidth) * mean_square)),
        above_mean=4.0 * np.sqrt(mean_square / (np.pi * bandwidth)),
    )


def greenwood_williamson_area_share(separation: Any, summits: Summits) -> Any:
    """Share of the area in contact, by the separation (nm) of the flat and the summits' mean."""
    scaled = np.asarray(separation) / summits.scatter
    reach = np.pi * summits.density * summits.radius * summits.scatter
    return reach * _mean_excess(scaled, 1.0)


def greenwood_williamson_pressure(separation: Any, summits: Summits, e_star: float) -> Any:
    """Mean pressure (GPa), by the separation (nm) of the flat and the summits' mean; E* in GPa."""
    scaled = np.asarray(separation) / summits.scatter
    stiffness = 4.0 / 3.0 * e_star * np.sqrt(summits.radius) * summits.density
    return stiffness * summits.scatter**1.5 * _mean_excess(scaled, 1.5)


def _mean_excess(level: np.ndarray, power: float) -> np.ndarray:
    """Mean of max(u - level, 0)^power of a standard normal u.

    It is Gamma(power + 1) exp(-level^2 / 4) D(level) / sqrt(2 pi), where D is the parabolic
    cylinder function of order -power - 1 (DLMF 12.5.1).
    """
    cylinder, _ = special.pbdv(-power - 1.0, level)
    return special.gamma(power + 1.0) * np.exp(-0.25 * level**2) * cylinder / np.sqrt(2.0 * np.pi)
