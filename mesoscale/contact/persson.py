"""Persson's theory of the contact of a randomly rough surface with an elastic or plastic half-space.

Seen with all roughness up to a wave vector q, the pressure under a nominal pressure p spreads with the variance

    V(q) = (E*/2)^2 times the mean square gradient of the roughness up to q

as heat does that starts at p. What comes to pressure 0 loses contact, what comes to the hardness H yields: both ends
absorb. So P(s, q), the share of area per pressure s, obeys dP/dV = 1/2 d^2 P/ds^2 with P = 0 at s = 0 and s = H
(Persson 2001, doi 10.1063/1.1388626; with a hardness Persson 2006, doi 10.1016/j.surfrep.2006.04.001, and Almqvist and
Persson, arXiv 2507.14054).

Units nm, nN, GPa. A spectrum is a function psd(q) in nm^4 of wave vectors in 1/nm, normalised as in
`mesoscale.topography.roughness_spectrum`: the integral of 2 pi q psd(q) is the mean square height.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import integrate, interpolate, special

from mesoscale.errors import InputError

Array = NDArray[np.float64]
Spectrum = Callable[[Array], Array]

SMALL_LOAD_SLOPE = math.sqrt(8.0 / math.pi)
"""Elastic area at small load: share of area = this times p / (E* h'), h' the RMS gradient (1.6; computed: 2 to 2.6)."""
GAMMA = 0.45  # share of the elastic energy of full contact in partial contact: Yang and Persson (2008)
WAVES_PER_DECADE = 400  # of integrals over q; the trapezoidal rule in ln q is then exact to 1e-5
NEVER = 6.0  # standard deviations that a pressure does not reach: 2e-9
POINTS = 400  # of the pressure axis, denser at both ends


def rms_gradient(psd: Spectrum, q_low: float, q_high: float) -> float:
    """RMS gradient h' of a surface's waves from q_low to q_high (1/nm): h'^2 = integral of 2 pi q^3 psd(q)."""
    q = _waves(q_low, q_high)
    return float(np.sqrt(np.trapezoid(2.0 * np.pi * q**4 * psd(q), np.log(q))))


def elastic_area(pressure: ArrayLike, e_star: float, gradient: float) -> Array:
    """Share of area in elastic contact: erf(sqrt(2) p / (E* h')).

    Parameters
    ----------
    pressure : any shape, GPa
        Nominal pressure p.
    e_star : GPa
    gradient : RMS gradient h' of the surface.

    Returns
    -------
    share : shape of `pressure`, 0 to 1

    Source: Persson (2001), doi 10.1063/1.1388626; small loads: `SMALL_LOAD_SLOPE`.
    """
    return special.erf(math.sqrt(2.0) * _pressures(pressure) / (e_star * gradient))


def plastic_area(pressure: ArrayLike, e_star: float, gradient: float, hardness: float) -> tuple[Array, Array]:
    """Shares of area in elastic and in plastic contact for one hardness H, both of the shape of `pressure`.

    Their sum is the contact. Much roughness makes all of it plastic, p/H; from p = H on everything is.

    Parameters
    ----------
    pressure : any shape, GPa
    e_star, hardness : GPa
    gradient : RMS gradient h' of the surface.

    Source: the equation of this module, solved by images while the spread is below H (Xu, Li and Mulvihill,
    arXiv 2208.02665, sum these) and by sines above (Persson 2006, doi 10.1016/j.surfrep.2006.04.001).
    """
    p = np.minimum(_pressures(pressure), hardness)
    spread = 0.5 * e_star * gradient
    if spread < hardness:
        width = math.sqrt(2.0) * spread
        m = np.arange(1, math.ceil(6.0 * width / hardness) + 2)  # erf(6) is 1
        images = special.erf((m * hardness + p[..., None]) / width) - special.erf((m * hardness - p[..., None]) / width)
        return special.erf(p / width) + (images * (-1.0) ** m).sum(axis=-1), images[..., ::2].sum(axis=-1)
    n = np.arange(1, 12)  # exp(-(11 pi)^2 / 2) is 0
    waves = np.sin(np.pi * n * (p / hardness)[..., None]) * np.exp(-0.5 * (np.pi * n * spread / hardness) ** 2) / n
    plastic = p / hardness + 2.0 / np.pi * (waves * (-1.0) ** n).sum(axis=-1)
    return 4.0 / np.pi * waves[..., ::2].sum(axis=-1), plastic


@dataclass(frozen=True)
class PlasticContact:
    """Contact by `contact_with_hardness`; shares of area, arrays of the shape of the nominal pressure.

    Attributes
    ----------
    elastic : share in elastic contact.
    plastic : share at the hardness of the finest waves.
    kept : share in contact if contact that has yielded kept its area and the hardness at which it did.
    """

    elastic: Array
    plastic: Array
    kept: Array

    @property
    def area(self) -> Array:
        """Share of area in contact."""
        return self.elastic + self.plastic


def contact_with_hardness(
    pressure: ArrayLike, e_star: float, psd: Spectrum, q_low: float, q_high: float, hardness: Callable[[Array], Array]
) -> PlasticContact:
    """Elastic and plastic contact with a hardness H(q) that rises towards finer scales.

    The end of the pressure axis at which contact yields moves with q. All yielded contact A_pl carries the hardness of
    the scale that is seen; the load is kept if part of it comes back below the hardness: P(H, q) = A_pl dH/dV * 2.
    A flattened top without finer roughness would rather keep its area: `PlasticContact.kept`. Between the two lies
    what a hardness by size leaves open.

    The shares are the chances of a pressure to end elastic or plastic. They obey the backward equation, which is
    solved once for all pressures, from q_high down to q_low.

    Parameters
    ----------
    pressure : any shape, GPa
        From H(q_low) on, everything has yielded.
    e_star : GPa
    psd : spectrum, nm^4 of 1/nm
    q_low, q_high : 1/nm
        Longest and shortest wave; q_low of a periodic cell of side L is 2 pi / L.
    hardness : GPa of 1/nm
        H(q), for instance `hardness_at`.

    Raises
    ------
    InputError : a hardness that is not positive, or falls with q: the load could not be kept.

    Source: Persson (2006), doi 10.1016/j.surfrep.2006.04.001, section on size-dependent hardness.
    """
    strengths = hardness(_waves(q_low, q_high))
    if not (np.all(strengths > 0.0) and np.all(np.diff(strengths) >= 0.0)):
        raise InputError("hardness: accepted are values > 0 GPa that do not fall with the wave vector")
    spread = 0.5 * e_star * rms_gradient(psd, q_low, q_high)
    if np.max(_pressures(pressure)) + NEVER * spread < strengths[0]:
        touching = special.erf(_pressures(pressure) / (math.sqrt(2.0) * spread))
        return PlasticContact(touching, np.zeros_like(touching), touching)
    # places on the axis, stress over hardness; as dense at its ends as the layers there are thin
    x = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, POINTS + 1)))
    left, right = np.diff(x)[:-1], np.diff(x)[1:]
    second = np.array([2.0 / (left * (left + right)), -2.0 / (left * right), 2.0 / (right * (left + right))])
    first = np.array(
        [-right / (left * (left + right)), (right - left) / (left * right), left / (right * (left + right))]
    )

    def change(y: float, u: Array, stays: bool) -> Array:
        """du/dy at q = q_high exp(-y) on the moving axis; all places but pressure 0, where u is 0."""
        q = q_high * np.exp(-y) * np.array([1.0, np.exp(-1e-4), np.exp(1e-4)])
        spreading = 0.5 * np.pi * e_star**2 * q[0] ** 4 * psd(q[:1])[0]  # dV/dy
        strength = hardness(q)
        growth = float(np.log(strength[1] / strength[2]) / 2e-4)  # d ln H/dy
        full = np.concatenate(([0.0], u))
        bend = second[0] * full[:-2] + second[1] * full[1:-1] + second[2] * full[2:]
        tilt = first[0] * full[:-2] + first[1] * full[1:-1] + first[2] * full[2:]
        end = 0.0 if stays else growth * (u[-1] - u[-2]) / right[-1]
        return np.append(0.5 * spreading / strength[0] ** 2 * bend + growth * x[1:-1] * tilt, end)

    def chance(inside: float, at_hardness: float, stays: bool) -> Array:
        """Share that ends in what counts as ``inside`` below the hardness, ``at_hardness`` on it."""
        start = np.full(POINTS, inside)
        start[-1] = at_hardness
        solved = integrate.solve_ivp(
            change,
            (0.0, math.log(q_high / q_low)),
            start,
            method="LSODA",
            args=(stays,),
            lband=1,
            uband=1,
            rtol=1e-7,
            atol=1e-10,
        )
        if not solved.success:
            raise RuntimeError(f"Persson's equation: {solved.message}")
        ends = np.concatenate(([0.0], solved.y[:, -1]))
        return interpolate.PchipInterpolator(x, ends)(np.minimum(_pressures(pressure) / strengths[0], 1.0))

    return PlasticContact(chance(1.0, 0.0, False), chance(0.0, 1.0, False), chance(1.0, 1.0, True))


def hardness_at(q: Array, h_macro: float, h_prime: float) -> Array:
    """Hardness by scale, GPa: H_macro + H' A^(-1/4) of a contact as wide as half a wave, A = (pi/q)^2.

    Parameters
    ----------
    q : any shape, 1/nm
    h_macro : GPa
    h_prime : GPa nm^0.5

    Source: the size effect is eq. 4 of the contact model; the width is a choice, since Persson's theory only says
    that waves up to q matter (half of it changes H by a factor of sqrt(2) in its second part).
    """
    return h_macro + h_prime * np.sqrt(np.asarray(q) / np.pi)


def mean_separation(pressure: ArrayLike, e_star: float, psd: Spectrum, q_low: float, q_high: float) -> Array:
    """Separation of the mean planes, nm, of an elastic contact: p d(separation) = -d(elastic energy).

    The energy of partial contact is that of full contact, wave by wave, times A [gamma + (1 - gamma) A^2], with A the
    share of area that touches with the waves up to q.

    Parameters
    ----------
    pressure : any shape, GPa, above 0
    e_star : GPa
    psd : spectrum, nm^4 of 1/nm
    q_low, q_high : 1/nm

    Returns
    -------
    separation : shape of `pressure`, nm

    Source: Yang and Persson (2008), doi 10.1088/0953-8984/20/21/215214.
    """
    q = _waves(q_low, q_high)
    steps = np.diff(np.log(q))
    squares = 0.5 * (q[1:] ** 4 * psd(q[1:]) + q[:-1] ** 4 * psd(q[:-1])) * steps
    # w: a contact with the waves up to q touches on erf(w p / E*) of the area
    w = 1.0 / np.sqrt(np.pi * np.cumsum(squares))
    middle = np.sqrt(q[1:] * q[:-1])
    weight = math.sqrt(math.pi) * middle**3 * psd(middle) * w * steps
    loads = w * (_pressures(pressure)[..., None] / e_star)
    return (weight * _energy_integral(loads)).sum(axis=-1)


def _energy_integral(z: Array) -> Array:
    """Integral from z to infinity of [gamma + 3 (1 - gamma) erf^2(t)] exp(-t^2) / t."""
    t = np.linspace(0.0, 6.0, 3001)
    smooth = np.zeros_like(t)
    smooth[1:] = special.erf(t[1:]) ** 2 * np.exp(-(t[1:] ** 2)) / t[1:]
    below = integrate.cumulative_simpson(smooth, x=t, initial=0.0)
    rest = interpolate.CubicSpline(t, below[-1] - below)(np.minimum(z, t[-1]))
    return 0.5 * GAMMA * special.exp1(z**2) + 3.0 * (1.0 - GAMMA) * rest


def _waves(q_low: float, q_high: float) -> Array:
    """Wave vectors from q_low to q_high for integrals in ln q."""
    if not 0.0 < q_low < q_high:
        raise InputError(f"q_low = {q_low}, q_high = {q_high} 1/nm: accepted are 0 < q_low < q_high")
    return np.geomspace(q_low, q_high, max(2, math.ceil(WAVES_PER_DECADE * math.log10(q_high / q_low)) + 1))


def _pressures(pressure: ArrayLike) -> Array:
    values = np.asarray(pressure, float)
    if not np.all(values >= 0.0):
        raise InputError("pressure: accepted are values >= 0 GPa")
    return values
