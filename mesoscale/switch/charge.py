"""Charge at the surface of the dielectric, as a switch feels it.

An electrode at a voltage V feels (V - V_s)^2 + U^2: V_s is the shift by even charge and contact
potential, U^2 what uneven charge adds, which falls with the gap (docs/charging.md). The electrode
is flat there, at the mean separation.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.constants import elementary_charge

from mesoscale.settings import DeviceSettings
from mesoscale.theory.charging import charge_shift, felt_charge_wave, waves_of_patches

Array = NDArray[np.float64]

PER_CM2 = 1e4 * elementary_charge
"""One charge a square centimetre, in C/m^2."""


def shift_V(settings: DeviceSettings) -> float:
    """V_s, with its sign."""
    if settings.charge_e_cm2 == 0.0:
        return settings.shift_V
    density = settings.charge_e_cm2 * PER_CM2
    by_charge = charge_shift(density, settings.dielectric_nm, settings.permittivity)
    return settings.shift_V + float(by_charge)


def uneven_V2(settings: DeviceSettings, separation_nm: ArrayLike) -> Array:
    """U^2 at separations of any shape; that of touch below 0."""
    gaps = np.maximum(np.asarray(separation_nm, float), 0.0)
    if settings.uneven is None:
        return np.zeros_like(gaps)
    if settings.uneven.felt:
        return np.interp(gaps, *np.array(settings.uneven.felt).T)
    if settings.uneven.patch_nm is None:
        periods_nm, densities = np.array(settings.uneven.waves).T
        wave_numbers = 2.0 * np.pi / periods_nm
        amplitudes = np.sqrt(2.0) * PER_CM2 * densities
    else:
        wave_numbers, amplitudes = waves_of_patches(
            settings.uneven.patch_nm, settings.uneven.e_cm2 * PER_CM2
        )
    felt = felt_charge_wave(
        amplitudes, wave_numbers, gaps[..., None], settings.dielectric_nm, settings.permittivity
    )
    return np.sum(np.square(felt), axis=-1)
