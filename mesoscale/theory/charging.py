"""Charge in the dielectric of a switch: what it does to the voltage, how it gets in, how it leaves.

Charge at the surface of a dielectric of thickness t and relative permittivity eps_r shifts the
voltage V that the electrode feels to V - V_s where it is even, and adds U^2 to (V - V_s)^2 where it
is not. Fields in V/m, densities in C/m^2, lengths in nm, energies in eV, temperatures in K, times
in s.

Sources: field emission with image force, R. G. Forbes and J. H. B. Deane, Proc. R. Soc. A 463
(2007) 2907, doi 10.1098/rspa.2007.0030; emission from traps, J. Frenkel, Phys. Rev. 54 (1938) 647,
doi 10.1103/PhysRev.54.647. The shift in time and the field of waves of charge are derived
in docs/charging.md.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.constants import Boltzmann, elementary_charge

from mesoscale.units import NM, VACUUM_PERMITTIVITY

Real = float | NDArray[np.float64]

FIRST_EMISSION = 1.541434e-6
"""First constant of field emission, A eV V^-2."""
SECOND_EMISSION = 6.830890e9
"""Second constant of field emission, V m^-1 eV^-3/2."""
IMAGE_FORCE = 1.439964e-9
"""e^3 / (4 pi eps0) in eV^2 per V/m: the field that pulls a barrier of 1 eV down to nothing."""

PATCH_WAVES = (1e-2, 1e3)
"""Least and largest wave number of patches, times their radius."""


def charge_shift(density: Real, thickness: Real, permittivity: Real) -> Real:
    """Shift (V) by even charge at the surface: density t / (eps0 eps_r)."""
    return density * thickness * NM / (VACUUM_PERMITTIVITY * permittivity)


def felt_charge_wave(
    amplitude: Real, wave_number: Real, gap: Real, thickness: Real, permittivity: Real
) -> Real:
    """U (V) that a sinusoid of charge makes an electrode feel across a gap; at 0 gap its most.

    Parameters
    ----------
    amplitude : of the density, C/m^2.
    wave_number : 2 pi over the period, 1/nm.
    """
    across_gap = wave_number * gap
    across_dielectric = wave_number * thickness
    # 1 / cosh without the overflow of a fine wave far away
    fades = 2.0 * np.exp(-across_gap) / (1.0 + np.exp(-2.0 * across_gap))
    screened = 1.0 + permittivity * np.tanh(across_gap) / np.tanh(across_dielectric)
    field = amplitude / np.sqrt(2.0) * fades / (VACUUM_PERMITTIVITY * screened)
    return (gap + thickness / permittivity) * NM * field


def waves_of_patches(radius: float, density: float) -> tuple[NDArray[np.float64], ...]:
    """Wave numbers (1/nm) and amplitudes (C/m^2) of round patches at random places.

    With J0 and J1 of Bessel, the waves up to k hold the share 1 - J0(kR)^2 - J1(kR)^2 of the
    variance: the spectrum of a disc of radius R, integrated.

    Parameters
    ----------
    density : root mean square departure of the density from its mean, C/m^2.
    """
    from scipy.special import j0, j1

    edges = np.concatenate([[0.0], np.geomspace(*PATCH_WAVES, 600)])
    held = np.append(1.0 - j0(edges) ** 2 - j1(edges) ** 2, 1.0)
    middle = np.append(0.5 * (edges[1:] + edges[:-1]), edges[-1])
    shares = np.maximum(np.diff(held), 0.0)
    return middle / radius, density * np.sqrt(2.0 * shares)


def emission_current(field: Real, barrier: Real) -> Real:
    """Current density (A/m^2) of field emission by Murphy and Good at 0 K, with the image force.

    Holds below the field at which the image force takes the barrier away.
    """
    lowered = IMAGE_FORCE * field / barrier**2
    shape = 1.0 - lowered + lowered * np.log(lowered) / 6.0
    slope = 1.0 + lowered * (1.0 - 0.5 * np.log(lowered)) / 9.0
    exponent = shape * SECOND_EMISSION * barrier**1.5 / field
    return FIRST_EMISSION * field**2 / (barrier * slope**2) * np.exp(-exponent)


def emission_shift(
    voltage: Real, gap: Real, time: Real, thickness: Real, permittivity: Real, barrier: Real
) -> Real:
    """Shift (V) after a time in which charge went through a gap by field emission.

    Charge that has arrived lowers the field, so the shift grows linearly and then with the
    logarithm of time. This is the exact solution for the elementary law, without image force.
    """
    vacuum = (gap + thickness / permittivity) * NM
    first = FIRST_EMISSION / barrier
    second = SECOND_EMISSION * barrier**1.5
    lowering = thickness / (VACUUM_PERMITTIVITY * (permittivity * gap + thickness))
    start = second * vacuum / voltage  # B' / E0
    # ln(e^x + y) without the overflow of e^x
    field = second / np.logaddexp(start, np.log(first * second * lowering * time))
    return voltage - field * vacuum


def frenkel_lowering(field: Real, permittivity: Real) -> Real:
    """How far (eV) a field lowers the barrier of a trap; the permittivity is that of light."""
    return np.sqrt(elementary_charge * field / (np.pi * VACUUM_PERMITTIVITY * permittivity))


def frenkel_ratio(
    field: Real, reference_field: Real, permittivity: Real, temperature: Real
) -> Real:
    """Current by emission from traps, over that at another field."""
    thermal = Boltzmann * temperature / elementary_charge
    lowering = frenkel_lowering(field, permittivity)
    reference = frenkel_lowering(reference_field, permittivity)
    return field / reference_field * np.exp((lowering - reference) / thermal)


def frenkel_volts_per_decade(
    voltage: Real, thickness: Real, permittivity: Real, temperature: Real
) -> Real:
    """Volts by which a current by emission from traps grows ten times."""
    thermal = Boltzmann * temperature / elementary_charge
    lowering = frenkel_lowering(voltage / (thickness * NM), permittivity)
    growth = (1.0 + 0.5 * lowering / thermal) / voltage  # of the logarithm, by the voltage
    return np.log(10.0) / growth


def thermal_barrier(temperatures: NDArray[np.float64], times: NDArray[np.float64]) -> float:
    """Barrier (eV) of a relaxation whose times were measured at several temperatures."""
    inverse = 1.0 / (Boltzmann * np.asarray(temperatures, float) / elementary_charge)
    return float(np.polyfit(inverse, np.log(times), 1)[0])


def thermal_ratio(barrier: Real, temperature: Real, reference_temperature: Real) -> Real:
    """Time over a barrier at a temperature, over that at another."""
    inverse = 1.0 / temperature - 1.0 / reference_temperature
    return np.exp(barrier * elementary_charge / Boltzmann * inverse)
