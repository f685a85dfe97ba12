"""What time does to a switch that is held: metal that relaxes, water that condenses, bonds that
grow.

Each is a closed function of time, so that nothing is stepped. Temperatures in K, times in s,
lengths in nm, moduli in GPa, energies per area in mJ/m^2.

Sources: relaxation of gold, IMECE2004-61385; diffusion along boundaries of grains, Coble, J. Appl.
Phys. 34 (1963) 1679, with the constants of Frost and Ashby, Deformation-Mechanism Maps (1982);
relaxation of aluminium, El-Deiry et al., Mater. Res. Soc. Symp. Proc. 795 (2003) U10.10; films of
water, Badmann, Stockhausen and Setzer, J. Colloid Interface Sci. 82 (1981) 534; menisci,
Szoszkiewicz and Riedo, Phys. Rev. Lett. 95 (2005) 135502; bonds, Phys. Rev. Lett. 124 (2020)
026801, and McClimon et al., Tribol. Lett. 72 (2024), doi 10.1007/s11249-024-01904-x.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.constants import Boltzmann, elementary_charge
from scipy.constants import R as GAS_CONSTANT

from mesoscale.theory.charging import thermal_barrier, thermal_ratio
from mesoscale.units import GPA, NM

Array = NDArray[np.float64]

GOLD_K = np.array([295.0, 312.0, 323.0])
GOLD_S = np.array([250.0, 67.0, 40.0])
"""Temperatures and relaxation times of a gold film of 200 nm (IMECE2004-61385)."""
COBLE = 14.0 * np.pi
"""Frost and Ashby's 42 pi of shear, in tension; Coble's own is 150 / pi, 8 % more."""
NICKEL_BOUNDARY_M3_S = 3.5e-15
NICKEL_BOUNDARY_J_MOL = 1.15e5
NICKEL_ATOM_M3 = 1.09e-29
"""Width of a boundary times its diffusion, barrier of it, and volume of an atom: Frost and Ashby
(1982), from memory."""
ALUMINIUM_STRAINS = (0.0017, 0.0043)
"""Strains at which films of aluminium did not relax, and at which some did (El-Deiry et al.)."""
FILM_NM = (0.385, 0.189)
"""Badmann's constants, of silicates; 3.85 and 1.89 angstrom."""
MENISCUS_S, MENISCUS_K = 4.2e-3, 299.0
"""Time in which menisci form at 40 % humidity, and the temperature at which it was measured."""
MENISCUS_EV = 7.8e-20 / elementary_charge
LARGEST_EXPONENT = 690.0
"""Of a time in s, so that none of a cold switch overflows."""
BOND_S = 0.1
"""Ageing of silica is linear in time below it, and logarithmic above (PRL 124, 026801)."""
BOND_HUMIDITIES = (0.01, 0.10, 0.40, 0.60)
"""Ageing of silica begins above the first, is pronounced from the second to the third, and gone at
the fourth. The first three are published (McClimon et al.), the fourth is assumed."""


def gold_relaxation_s(temperature: ArrayLike) -> Array:
    """Relaxation time of gold at temperatures.

    It is that of the straight line of the logarithm over 1 / T through the three measured ones,
    which scatter by 11 % about it.
    """
    barrier = thermal_barrier(GOLD_K, GOLD_S)
    at_295_K = np.exp(np.mean(np.log(GOLD_S / thermal_ratio(barrier, GOLD_K, GOLD_K[0]))))
    return _over_barrier(float(at_295_K), barrier, temperature, float(GOLD_K[0]))


def coble_relaxation_s(temperature: ArrayLike, grain: ArrayLike, modulus: float) -> Array:
    """Time in which stress at a held strain falls e times, by Coble creep of nickel.

    The rate of strain is 14 pi D sigma V / (k T d^3), with D the width of a boundary times its
    diffusion. It is linear in the stress sigma, so that this time is k T d^3 / (14 pi D V E).

    Parameters
    ----------
    grain : size of the grains, nm.
    modulus : Young's modulus, GPa.
    """
    kelvin = np.asarray(temperature, float)
    log_diffusion = np.log(NICKEL_BOUNDARY_M3_S) - NICKEL_BOUNDARY_J_MOL / (GAS_CONSTANT * kelvin)
    geometry = Boltzmann * kelvin * (np.asarray(grain, float) * NM) ** 3
    log_time = np.log(geometry / (COBLE * NICKEL_ATOM_M3 * modulus * GPA)) - log_diffusion
    return np.exp(np.minimum(log_time, LARGEST_EXPONENT))


def relaxed_share(time: ArrayLike, relaxation: ArrayLike, largest: ArrayLike = 1.0) -> Array:
    """Share of its stress that a held strain has lost: largest (1 - exp(-t / relaxation)).

    Raises
    ------
    ValueError : a time below zero.
    """
    with np.errstate(over="ignore"):  # of a time that is endless beside the relaxation
        passed = _times(time) / np.asarray(relaxation, float)
    return np.asarray(-np.asarray(largest, float) * np.expm1(-passed))


def aluminium_share(strain: ArrayLike) -> Array:
    """Part of the relaxation of aluminium that is there at a largest strain: 0 up to 0.17 %, 1 from
    0.43 % on, and in a line between, which is assumed.
    """
    low, high = ALUMINIUM_STRAINS
    return np.clip((np.asarray(strain, float) - low) / (high - low), 0.0, 1.0)


def adsorbed_film(humidity: ArrayLike) -> Array:
    """Thickness (nm) of a film of water on silicates: 0.385 - 0.189 ln(-ln RH), not below 0.

    It grows beyond all bounds at 100 %.

    Raises
    ------
    ValueError : a humidity below 0 or above 1.
    """
    relative = np.asarray(humidity, float)
    if relative.min(initial=0.0) < 0.0 or relative.max(initial=0.0) > 1.0:
        raise ValueError(
            f"a humidity from {relative.min():g} to {relative.max():g}: accepted is 0 to 1"
        )
    constant, slope = FILM_NM
    with np.errstate(divide="ignore"):
        return np.maximum(constant - slope * np.log(-np.log(relative)), 0.0)


def meniscus_time_s(temperature: ArrayLike) -> Array:
    """Time in which menisci form, over a barrier of 7.8e-20 J from 4.2 ms at 299 K."""
    return _over_barrier(MENISCUS_S, MENISCUS_EV, temperature, MENISCUS_K)


def menisci_formed(time: ArrayLike, temperature: ArrayLike) -> Array:
    """Share of its menisci that a contact has after a time.

    Raises
    ------
    ValueError : a time below zero.
    """
    return relaxed_share(time, meniscus_time_s(temperature))


def bonding_share(humidity: ArrayLike) -> Array:
    """How strongly oxides age at a humidity, from 0 to 1: none up to 1 % and above 60 %, all from
    10 to 40 %; between, in lines over the logarithm of humidity, which are assumed.
    """
    relative = np.maximum(np.asarray(humidity, float), 1e-12)
    return np.interp(np.log(relative), np.log(BOND_HUMIDITIES), [0.0, 1.0, 1.0, 0.0])


def bond_energy(time: ArrayLike, humidity: ArrayLike, per_decade: ArrayLike) -> Array:
    """Work (mJ/m^2 of what touches) that bonds between oxides have added to the adhesion.

    It is per_decade log10(1 + t / 0.1 s): linear at first, then logarithmic.

    Parameters
    ----------
    per_decade : growth for each ten times of time where bonds grow most, mJ/m^2.

    Raises
    ------
    ValueError : a time below zero.
    """
    decades = np.log1p(_times(time) / BOND_S) / np.log(10.0)
    return np.asarray(per_decade * decades * bonding_share(humidity))


def _over_barrier(
    reference_s: float, barrier: float, temperature: ArrayLike, reference_K: float
) -> Array:
    """Time over a barrier (eV) at a temperature, by that at another."""
    inverse = 1.0 / np.asarray(temperature, float) - 1.0 / reference_K
    exponent = barrier * elementary_charge / Boltzmann * inverse
    return np.asarray(reference_s * np.exp(np.minimum(exponent, LARGEST_EXPONENT)))


def _times(time: ArrayLike) -> Array:
    times = np.asarray(time, float)
    if times.min(initial=0.0) < 0.0:
        raise ValueError(f"a time of {times.min():g} s: times are not below zero")
    return times
