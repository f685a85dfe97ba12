"""Numbers that say where the coupled model holds: adhesion that deforms the contact, share of
plasticity.

Attraction acts on the gap that repulsion alone leaves (the picture of Derjaguin, Muller and
Toporov). This holds where Tabor's parameter is well below 1 and where the surface is not sticky by
the criterion of Pastewka and Robbins (doi:10.1073/pnas.1320846111). Its equation 10, as the
authors' package Adhesion prints it, calls a surface sticky where (h' dr / (kappa l_a)) (h' d / 4
dr)^(2/3) is below about 1, with l_a = w/E*, d = 4 h'/h'' and dr the range. Derived again from its
picture the bound is pi (3/16)^(2/3) = 1.03. h'' is the RMS Laplacian here (the radius of a summit
is 2/h''); with half of it, which that package calls curvature, a surface would need 1.6 times the
adhesion.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy import fft

from mesoscale.contact.coupled import half_space
from mesoscale.contact.menisci import menisci_of
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import RANGE_IN_D0, WORK_FACTOR, Body

KAPPA = 2.0  # area of an elastic contact over force / (E* h'), as Pastewka and Robbins take it


class Roughness(NamedTuple):
    """What the spectrum of a periodic surface says about it.

    Attributes
    ----------
    slope : RMS of the gradient.
    curvature : RMS of the Laplacian, 1/nm.
    flattening : pressure that makes it flat, over E*.
    """

    slope: float
    curvature: float
    flattening: float


def roughness(heights: np.ndarray, length: float, bodies: tuple[Body, ...] = ()) -> Roughness:
    """Slope, curvature and the mean pressure of full contact of heights (N, N) in nm on a side of
    `length` nm.
    """
    pixels = len(heights)
    spectrum = np.asarray(fft.rfft2(heights))
    number = half_space.wave_numbers(pixels)
    power = np.abs(spectrum) ** 2
    power[:, 1 : (pixels + 1) // 2] *= 2.0  # the other half of the modes
    squared = (number * (2.0 * np.pi / length)) ** 2
    slope, curvature = (
        math.sqrt(float((power * factor).sum())) / pixels**2 for factor in (squared, squared**2)
    )
    spectrum *= number * (-np.pi / length) / half_space.softness(pixels, length, bodies)
    pressure = np.asarray(fft.irfft2(spectrum, s=heights.shape, overwrite_x=True))
    return Roughness(slope, curvature, max(-float(pressure.min()), 0.0))


def adhesion_numbers(
    hamaker: float, settings: ContactSettings, e_star: float, surface: Roughness
) -> dict[str, float]:
    """Tabor's parameter and the number of Pastewka and Robbins (above 1: sticky).

    The law of attraction gives the pressure at contact s = A_H / (6 pi D0^3), the work of adhesion
    w, which is A_H / (12 pi D0^2) offset and A_H / (4 pi D0^2) clamped, and the range w / s; the
    radius of a summit is 2 / h''. Liquid has the work gamma (cos theta1 + cos theta2) and the
    range d_c: Tabor's parameter is that of the stronger, rims attract with both.
    """
    law = settings.attraction
    cutoff = settings.gap_cutoff_nm
    menisci = menisci_of(settings.air, hamaker)
    work = hamaker / (WORK_FACTOR[law] * math.pi * cutoff**2)
    reach = RANGE_IN_D0[law] * cutoff
    laws = [(work, reach)]
    if menisci:
        laws = [
            (menisci.dispersion * work, reach),
            (menisci.tension, menisci.reach_nm),
        ]
    if surface.curvature == 0.0:
        return (
            {"tabor": math.inf, "stickiness": math.inf}
            if hamaker or menisci
            else {"tabor": 0.0, "stickiness": 0.0}
        )
    # Attraction w / reach over the rim of the contacts beside the repulsion E* h' / KAPPA in them,
    # where contacts are d = 4 h'/h'' wide and pi A / d is the length of their rims. The rim reaches
    # as far as the gap is below `reach`: at a distance x from Hertz's line contact of the slope h',
    # gap^2 = 16/9 h'^2 x^3 / d.
    tabor, sticky = 0.0, 0.0
    for work, reach in laws:
        tabor = max(
            tabor, (2.0 / surface.curvature * work**2 / (e_star**2 * reach**3)) ** (1.0 / 3.0)
        )
        rough = surface.slope**2 / (surface.curvature * reach)
        needed = surface.slope * reach * e_star / KAPPA * rough ** (2.0 / 3.0)
        sticky += math.pi * (3.0 / 16.0) ** (2.0 / 3.0) * work / needed
    return {"tabor": tabor, "stickiness": sticky}
