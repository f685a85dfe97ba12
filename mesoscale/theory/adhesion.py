"""Adhesion of an elastic sphere to a flat: Johnson, Kendall and Roberts, and Derjaguin and others.

JKR holds for soft spheres of strong adhesion (Tabor's parameter above some 5), DMT for stiff ones
(below some 0.1). Forces that press are positive. Units nm, nN, GPa; work of adhesion in nN/nm,
which is J/m^2.

Sources: K. L. Johnson, K. Kendall and A. D. Roberts, Proc. R. Soc. Lond. A 324 (1971) 301, doi
10.1098/rspa.1971.0141; B. V. Derjaguin, V. M. Muller and Yu. P. Toporov, J. Colloid Interface Sci.
53 (1975) 314, doi 10.1016/0021-9797(75)90018-1; D. Tabor, J. Colloid Interface Sci. 58 (1977) 2,
doi 10.1016/0021-9797(77)90366-6; K. L. Johnson, Int. J. Solids Struct. 32 (1995) 423, doi
10.1016/0020-7683(94)00111-9.
"""

import numpy as np
from numpy.typing import NDArray

from mesoscale.theory.sphere import hertz_force
from mesoscale.theory.waves import wave_mean_pressure

Real = float | NDArray[np.float64]


def jkr_force(contact_radius: Real, radius: Real, e_star: Real, work_of_adhesion: Real) -> Real:
    """Force (nN) at a contact radius a: 4 E* a^3 / (3 R) - sqrt(8 pi w E* a^3)."""
    hertzian = 4.0 * e_star * contact_radius**3 / (3.0 * radius)
    return hertzian - np.sqrt(8.0 * np.pi * work_of_adhesion * e_star * contact_radius**3)


def jkr_indentation(
    contact_radius: Real, radius: Real, e_star: Real, work_of_adhesion: Real
) -> Real:
    """Approach (nm) at a contact radius a: a^2 / R - sqrt(2 pi w a / E*)."""
    neck = np.sqrt(2.0 * np.pi * work_of_adhesion * contact_radius / e_star)
    return contact_radius**2 / radius - neck


def jkr_pull_off(radius: Real, work_of_adhesion: Real) -> Real:
    """Largest pull (nN) of a JKR sphere: 3/2 pi w R; it does not depend on E*."""
    return 1.5 * np.pi * work_of_adhesion * radius


def dmt_force(indentation: Real, radius: Real, e_star: Real, work_of_adhesion: Real) -> Real:
    """Force (nN) at an approach (nm): Hertz's, less the pull 2 pi w R of the whole sphere."""
    return hertz_force(indentation, radius, e_star) - dmt_pull_off(radius, work_of_adhesion)


def dmt_pull_off(radius: Real, work_of_adhesion: Real) -> Real:
    """Largest pull (nN) of a DMT sphere: 2 pi w R."""
    return 2.0 * np.pi * work_of_adhesion * radius


def tabor_parameter(
    radius: Real, e_star: Real, work_of_adhesion: Real, equilibrium_gap: Real
) -> Real:
    """Neck of a JKR sphere over the range of attraction: [R w^2 / (E*^2 z0^3)]^(1/3)."""
    return np.cbrt(radius * work_of_adhesion**2 / (e_star**2 * equilibrium_gap**3))


def adhesive_wave_pressure(
    area_share: Real, amplitude: Real, wavelength: Real, e_star: Real, work_of_adhesion: Real
) -> Real:
    """Mean pressure (GPa) at which a share of an adhesive wave's area touches (Johnson 1995).

    p = p* sin^2(s) - sqrt(2 w E* tan(s) / wavelength), s = pi share / 2, of h(x) = amplitude cos(2
    pi x / wavelength), p* = pi E* amplitude / wavelength. Its minimum is the pull-off.
    """
    tangent = np.tan(0.5 * np.pi * area_share)
    adhesive = np.sqrt(2.0 * work_of_adhesion * e_star * tangent / wavelength)
    return wave_mean_pressure(area_share, amplitude, wavelength, e_star) - adhesive
