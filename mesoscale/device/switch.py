"""A switch as a plate on a spring above a dielectric: its numbers, and the voltage that balances a force.

The plate at mean separation s from the dielectric is in balance when

    F(s) = eps0 A V^2 / (2 (s + t/eps)^2)

with F the force that opens it: that of its spring, k (g - s), and that of the pad. V^2 is then a single-valued function
of s. A state is stable where it falls with s; where it turns are pull-in and release.
"""

from dataclasses import dataclass

import numpy as np

from mesoscale.settings import DeviceSettings

VACUUM_PERMITTIVITY = 8.8541878128e-12  # F/m, CODATA 2018
NM = 1e-9
GPA = 1e9
ELEMENTS = 32


@dataclass(frozen=True)
class Switch:
    """Lumped switch.

    Attributes
    ----------
    spring_N_per_m : stiffness k against a uniform load.
    gap_nm : separation g at rest.
    area_m2 : electrode area A.
    dielectric_nm : thickness t divided by the relative permittivity.
    """

    spring_N_per_m: float
    gap_nm: float
    area_m2: float
    dielectric_nm: float

    def spring_force_N(self, separation_nm: np.ndarray) -> np.ndarray:
        """Force of the spring, which opens the switch."""
        return self.spring_N_per_m * (self.gap_nm - separation_nm) * NM

    def balancing_V2(self, separation_nm: np.ndarray, opening_force_N: np.ndarray) -> np.ndarray:
        """Square of the voltage (V^2) whose attraction balances a force that opens the switch."""
        electric_gap = (separation_nm + self.dielectric_nm) * NM
        factor = 2 * electric_gap**2 / (VACUUM_PERMITTIVITY * self.area_m2)
        return factor * opening_force_N

    def capacitance_F(self, separation_nm: np.ndarray) -> np.ndarray:
        """Parallel-plate capacitance at a mean separation."""
        return VACUUM_PERMITTIVITY * self.area_m2 / ((np.asarray(separation_nm) + self.dielectric_nm) * NM)


def beam_stiffness_N_per_m(settings: DeviceSettings) -> float:
    """Stiffness of the beam at rest against a uniform pull of its electrode, where it comes down farthest.

    For a clamped beam that is pulled all along, 32 E b (t/L)^3 without tension, and with a tension little enough
    8 sigma (1 - nu) b t/L more (G. M. Rebeiz, RF MEMS, Wiley 2003, section 2.2).

    Raises
    ------
    InputError : it touches the dielectric at rest.
    """
    from mesoscale.device.beam import beam_of  # compiles: not where a scene is only planned

    beam = beam_of(settings, ELEMENTS)
    at_rest = np.zeros((beam.elements + 1, 2))
    change, _ = beam.step(at_rest, lambda s: (-beam.wired, np.zeros_like(s)))
    return float((beam.width_m * beam.weights_m * beam.wired).sum() / -change[:, 0].min())


def switch_from_settings(settings: DeviceSettings) -> Switch:
    """The switch that the settings describe, as a plate; a beam has the spring of `beam_stiffness_N_per_m`."""
    return Switch(
        spring_N_per_m=settings.spring_N_per_m or beam_stiffness_N_per_m(settings),
        gap_nm=settings.gap_um * 1e3,
        area_m2=settings.area_um2 * 1e-12,
        dielectric_nm=settings.dielectric_nm / settings.permittivity,
    )
