"""A fixed-fixed beam over a dielectric: bending, tension and local loads, by cubic Hermite elements.

The separation s(x) of beam and dielectric is s = rest + u. In balance, for every virtual deflection v,

    int EI u'' v'' + N u' v' dx = int b [p(s) - q(s)] v dx

with p the contact pressure (positive: apart) and q the electrostatic pull. Nodal values are exact for uniform loads.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mesoscale.device.beam_kernels import NM, deflect, newton_step
from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings

Array = NDArray[np.float64]
Load = Callable[[Array], tuple[Array, Array]]
"""Pressure (Pa, positive: apart) and its derivative (Pa/m) at separations (m), all of shape (elements, points)."""

GAUSS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True)
class Beam:
    """A clamped beam and its shape at rest.

    Attributes
    ----------
    length_m, width_m : sides of the electrode.
    bending_N_m2 : EI.
    tension_N : axial force.
    rest_m : separation at rest at the integration points, shape (elements, points).
    at_m : positions of these points along the beam.
    """

    length_m: float
    width_m: float
    bending_N_m2: float
    tension_N: float
    rest_m: Array
    at_m: Array

    @property
    def elements(self) -> int:
        """Number of elements."""
        return len(self.rest_m)

    @property
    def weights_m(self) -> Array:
        """Length that each integration point stands for, shape (points,)."""
        return 0.5 * self.length_m / self.elements * GAUSS[1]

    @cached_property
    def mechanics(self) -> tuple[Array, Array, Array]:
        """Hermite's shapes, stiffness of an element, and weights of the points times the width, as the kernels take."""
        size = self.length_m / self.elements
        stiffness = _stiffness(size, self.bending_N_m2, self.tension_N)
        return _shapes(size), stiffness, self.width_m * self.weights_m

    def deflection_m(self, nodal: Array) -> Array:
        """Deflection at the integration points from nodal values (nodes, 2), shape (elements, points)."""
        return deflect(nodal, self.mechanics[0])

    def step(self, nodal: Array, load: Load, inertia: float = 0.0, other: Array | None = None) -> tuple[Array, Array]:
        """One Newton step towards balance, and the answer to another load on top, both of shape (nodes, 2).

        Parameters
        ----------
        inertia : added stiffness per area (Pa/m) that holds the beam back; 0 for a plain step.
        other : pressure (Pa) at the integration points; None: no other load.
        """
        pressure, slope = load(self.rest_m + self.deflection_m(nodal))
        other = np.zeros_like(pressure) if other is None else other
        return newton_step(nodal, pressure, slope, other, inertia, *self.mechanics)


def beam_of(settings: DeviceSettings, elements: int = 256) -> Beam:
    """The beam that the settings describe, with its bow and tilt at rest.

    Raises
    ------
    InputError : it touches the dielectric at rest.
    """
    if touching := settings.touching_at_rest:
        raise InputError(touching)
    length, width = settings.length_um * 1e-6, settings.width_um * 1e-6
    thickness = settings.thickness_um * 1e-6
    bending = settings.youngs_modulus_GPa * 1e9 * width * thickness**3 / 12.0
    tension = settings.residual_stress_MPa * 1e6 * (1.0 - settings.poisson_ratio) * width * thickness
    middles = (np.arange(elements) + 0.5)[:, None] * length / elements
    at = middles + 0.5 * length / elements * GAUSS[0]
    rest = settings.gap_um * 1e-6 + NM * settings.shape_at_rest_nm(at / length)
    return Beam(length, width, bending, tension, rest, at)


def _shapes(size: float) -> Array:
    """Hermite's shapes on an element of this size at the integration points, shape (4, points)."""
    x = 0.5 * (GAUSS[0] + 1.0)
    shapes = [1 - 3 * x**2 + 2 * x**3, size * (x - 2 * x**2 + x**3), 3 * x**2 - 2 * x**3, size * (x**3 - x**2)]
    return np.stack(shapes)


def _stiffness(size: float, bending: float, tension: float) -> Array:
    """Bending and tension of an element, shape (4, 4)."""
    h = size
    bend = np.array([[12, 6 * h], [6 * h, 4 * h**2]])
    pull = np.array([[36, 3 * h], [3 * h, 4 * h**2]])
    # the other end: forces opposed, slopes alike
    across = np.array([[-12, 6 * h], [-6 * h, 2 * h**2]])
    drawn = np.array([[-36, 3 * h], [-3 * h, -(h**2)]])
    turned = np.array([[1, -1], [-1, 1]])
    bend = np.block([[bend, across], [across.T, turned * bend]])
    pull = np.block([[pull, drawn], [drawn.T, turned * pull]])
    return bending / h**3 * bend + tension / (30.0 * h) * pull
