"""A sinusoidal surface pressed onto a flat half-space, in one direction and in two.

The separation of a periodic contact is that of the mean planes: the mean over the cell of the gap
between the deformed surface and the flat. The uniform compression of the half-space below is left
out of it. Crests touch here; the engines touch at minima, so that their heights are minus the ones
stated. Units nm, nN, GPa. Every function takes numbers or arrays, which broadcast.
"""

import numpy as np
from numpy.typing import NDArray

Real = float | NDArray[np.float64]


def wave_full_pressure(amplitude: Real, wavelength: Real, e_star: Real) -> Real:
    """Mean pressure, GPa, from which a wave h(x) = amplitude cos(2 pi x / wavelength) touches
    everywhere.

    p* = pi E* amplitude / wavelength; amplitude and wavelength in nm, E* in GPa.

    Source: Johnson (1985), sec. 13.2, doi 10.1017/CBO9781139171731.
    """
    return np.pi * e_star * amplitude / wavelength


def wave_mean_pressure(area_share: Real, amplitude: Real, wavelength: Real, e_star: Real) -> Real:
    """Mean pressure, GPa, at which a share of a wave's area touches: p = p* sin^2(pi share / 2).

    Parameters
    ----------
    area_share : 0 to 1
        Width of the contact strip, 2 a, over the wavelength.
    amplitude, wavelength : nm
        Of the wave h(x) = amplitude cos(2 pi x / wavelength), which does not depend on y.
    e_star : GPa

    Source: Westergaard (1939), doi 10.1115/1.4008919; Johnson (1985), sec. 13.2.
    """
    return wave_full_pressure(amplitude, wavelength, e_star) * np.sin(0.5 * np.pi * area_share) ** 2


def wave_area_share(mean_pressure: Real, amplitude: Real, wavelength: Real, e_star: Real) -> Real:
    """Share of a wave's area that touches under a mean pressure (GPa): inverse of
    `wave_mean_pressure`, at most 1.
    """
    return 2.0 / np.pi * np.arcsin(np.sqrt(_load(mean_pressure, amplitude, wavelength, e_star)))


def wave_pressure(
    x: Real, mean_pressure: Real, amplitude: Real, wavelength: Real, e_star: Real
) -> Real:
    """Pressure, GPa, at a place x (nm) of a wave with its crests at x = 0, +-wavelength, ...

    p(x) = 2 p* cos(pi x / wavelength) sqrt(sin^2(pi a / wavelength) - sin^2(pi x / wavelength)) in
    contact, -a <= x <= a, and 0 outside. Above full contact the surplus is uniform.

    Parameters
    ----------
    x : nm
    mean_pressure : GPa
    amplitude, wavelength : nm
    e_star : GPa

    Source: Westergaard (1939), doi 10.1115/1.4008919; Johnson (1985), sec. 13.2.
    """
    full = wave_full_pressure(amplitude, wavelength, e_star)
    edge = _load(mean_pressure, amplitude, wavelength, e_star)
    phase = np.pi * x / wavelength
    wave = 2.0 * full * np.abs(np.cos(phase)) * np.sqrt(np.maximum(edge - np.sin(phase) ** 2, 0.0))
    return wave + np.maximum(mean_pressure - full, 0.0)


def wave_gap(x: Real, mean_pressure: Real, amplitude: Real, wavelength: Real, e_star: Real) -> Real:
    """Gap, nm, between a wave and the flat at a place x (nm); crests at x = 0, +-wavelength, ...; 0
    in contact.

    With S = abs(sin(pi x / wavelength)) and s^2 = p/p*: gap = 2 amplitude [S sqrt(S^2 - s^2) - s^2
    arccosh(S/s)]. A strip that carries dp more lowers the flat like a punch: outside it the gap
    falls by 2 wavelength / (pi E*) arccosh(S/s) dp (potential of a charged arc); the sum over all
    dp is the line above.

    Parameters
    ----------
    x : nm
    mean_pressure : GPa
    amplitude, wavelength : nm
    e_star : GPa

    Source: integral of the pressures of Westergaard (1939), doi 10.1115/1.4008919.
    """
    edge = _load(mean_pressure, amplitude, wavelength, e_star)
    place = np.abs(np.sin(np.pi * x / wavelength))
    outside = np.maximum(place**2 - edge, 0.0)
    # edge arccosh(place / sqrt(edge)), whose limit without a load is 0
    ratio = np.maximum(place, np.sqrt(edge)) / np.sqrt(np.maximum(edge, np.finfo(float).tiny))
    return 2.0 * amplitude * (place * np.sqrt(outside) - edge * np.arccosh(np.maximum(ratio, 1.0)))


def wave_separation(mean_pressure: Real, amplitude: Real, wavelength: Real, e_star: Real) -> Real:
    """Separation of the mean planes, nm, of a wave and the flat: amplitude [1 - P + P ln P] with P
    = p/p*.

    It is the amplitude at first touch and 0 at full contact. A strip of half-width a that carries
    dp more moves the flat by 2 wavelength / (pi E*) ln(sin(pi a / wavelength)) dp, the logarithmic
    capacity of an arc; the sum over all dp is the line above.

    Parameters
    ----------
    mean_pressure : GPa
    amplitude, wavelength : nm
    e_star : GPa

    Source: integral of the pressures of Westergaard (1939), doi 10.1115/1.4008919.
    """
    load = _load(mean_pressure, amplitude, wavelength, e_star)
    return amplitude * (1.0 - load + load * np.log(np.maximum(load, np.finfo(float).tiny)))


def _load(mean_pressure: Real, amplitude: Real, wavelength: Real, e_star: Real) -> Real:
    """Mean pressure of a wave over that of full contact, 0 to 1."""
    return np.clip(mean_pressure / wave_full_pressure(amplitude, wavelength, e_star), 0.0, 1.0)


def bisinusoid_full_pressure(amplitude: Real, wavelength: Real, e_star: Real) -> Real:
    """Mean pressure, GPa, from which h = amplitude cos(2 pi x / wavelength) cos(2 pi y /
    wavelength) all touches.

    p* = sqrt(2) pi E* amplitude / wavelength; amplitude and wavelength in nm, E* in GPa. Above it
    the pressure is p + p* cos(2 pi x / wavelength) cos(2 pi y / wavelength).

    Source: Johnson, Greenwood and Higginson (1985), doi 10.1016/0020-7403(85)90029-3.
    """
    return np.sqrt(2.0) * np.pi * e_star * amplitude / wavelength


def bisinusoid_area_at_first_touch(
    mean_pressure: Real, amplitude: Real, wavelength: Real, e_star: Real
) -> Real:
    """Share of area that touches for p << p*: pi (3 p / (8 pi p*))^(2/3), two Hertzian summits per
    wavelength^2.

    Parameters
    ----------
    mean_pressure : GPa
    amplitude, wavelength : nm
        Of h = amplitude cos(2 pi x / wavelength) cos(2 pi y / wavelength).
    e_star : GPa

    Source: Johnson, Greenwood and Higginson (1985), doi 10.1016/0020-7403(85)90029-3.
    """
    load = mean_pressure / bisinusoid_full_pressure(amplitude, wavelength, e_star)
    return np.pi * (3.0 * load / (8.0 * np.pi)) ** (2.0 / 3.0)


def bisinusoid_area_near_full_contact(
    mean_pressure: Real, amplitude: Real, wavelength: Real, e_star: Real
) -> Real:
    """Share of area that touches for p near p*: 1 - 3/(2 pi) (1 - p/p*), two open pennies per
    wavelength^2.

    Parameters
    ----------
    mean_pressure : GPa
    amplitude, wavelength : nm
        Of h = amplitude cos(2 pi x / wavelength) cos(2 pi y / wavelength).
    e_star : GPa

    Source: Johnson, Greenwood and Higginson (1985), doi 10.1016/0020-7403(85)90029-3.
    """
    load = mean_pressure / bisinusoid_full_pressure(amplitude, wavelength, e_star)
    return 1.0 - 1.5 / np.pi * (1.0 - np.minimum(load, 1.0))
