"""The lowest resonance of an open beam, small and in a vacuum."""

import numpy as np
from scipy.linalg import eigh

from mesoscale.settings import DeviceSettings
from mesoscale.switch.beam import Beam, assembled
from mesoscale.units import UM


def lowest_kHz(beam: Beam, settings: DeviceSettings) -> float:
    """Lowest frequency of a beam about its rest, by its elements with consistent masses.

    Its stiffness is that of `mesoscale.switch.beam` without voltage: bending, axial force, and the
    stretching of a shape that is not flat.
    """
    mechanics = beam.mechanics
    freedoms = slice(2, 2 + mechanics.unknowns)
    bends = assembled(mechanics.bending_N_m)[freedoms, freedoms]
    all_pulls = assembled(mechanics.pulled)
    pulls = all_pulls[freedoms, freedoms]
    mass_kg_m2 = 1e3 * settings.density_g_cm3 * settings.thickness_um * UM
    mass = mass_kg_m2 * assembled(mechanics.products_m2.sum(axis=3))[freedoms, freedoms]
    gradient = (all_pulls @ mechanics.rest.ravel())[freedoms]
    stretched = mechanics.stretching_N_m * np.outer(gradient, gradient)
    stiffness = bends + beam.tension_N * pulls + stretched
    lowest = eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, 0])[0]
    return float(np.sqrt(max(lowest, 0.0))) / (2e3 * np.pi)
