"""A fixed-fixed beam over a dielectric: bending, tension and local loads, by cubic Hermite elements.

The separation s(x) of beam and dielectric is s = rest + u. In balance, for every virtual deflection v,

    int EI u'' v'' + N u' v' dx = int b [p(s) - q(s)] v dx

with p the contact pressure (positive: apart) and q the electrostatic pull. Nodal values are exact for uniform loads.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
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
MIDDLE, LANDING = 0.012, 0.56
"""Shares of half the beam: of the last contact, 3 um of the default, and of what lands when the beam pulls in."""


@dataclass(frozen=True)
class Beam:
    """A clamped beam and its shape at rest.

    Attributes
    ----------
    width_m : width of the electrode.
    bending_N_m2 : EI.
    tension_N : axial force.
    rest_m : separation at rest at the integration points, shape (elements, points).
    sizes_m : lengths of the elements, shape (elements,).
    within : places of the integration points in their elements, from 0 to 1, shape (points,).
    weights_m : length that each integration point stands for, shape (elements, points).
    """

    width_m: float
    bending_N_m2: float
    tension_N: float
    rest_m: Array
    sizes_m: Array
    within: Array
    weights_m: Array

    @property
    def elements(self) -> int:
        """Number of elements."""
        return len(self.rest_m)

    @property
    def length_m(self) -> float:
        """Length of the beam."""
        return float(self.sizes_m.sum())

    @property
    def at_m(self) -> Array:
        """Positions of the integration points along the beam, shape (elements, points)."""
        return (np.cumsum(self.sizes_m) - self.sizes_m)[:, None] + self.sizes_m[:, None] * self.within

    @cached_property
    def mechanics(self) -> tuple[Array, Array, Array]:
        """Hermite's shapes, stiffness of the elements, and weights of the points times the width, for the kernels."""
        shapes = np.array([_shapes(size, self.within) for size in self.sizes_m])
        stiffness = np.array([_stiffness(size, self.bending_N_m2, self.tension_N) for size in self.sizes_m])
        return shapes, stiffness, self.width_m * self.weights_m

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
    size = settings.length_um * 1e-6 / elements
    sizes, weights = np.full(elements, size), np.broadcast_to(0.5 * size * GAUSS[1], (elements, GAUSS[1].size))
    return _beam(settings, sizes, 0.5 * (GAUSS[0] + 1.0), weights)


def lumped_beam(settings: DeviceSettings, lumps: int) -> Beam:
    """The same beam loaded at 2 `lumps` places only: one integration point at the end of each element but the last.

    The places are those of Gauss in parts of the beam. Within `LANDING` of mid-span, which opens last, the density of
    parts is 1 / (x + `MIDDLE`) + 2 / `LANDING` at a share x of half the beam; what remains is one part.
    Their stiffness is exact where there is no tension.

    Raises
    ------
    InputError : see `beam_of`; the number of lumps is not even, or less than 4.
    """
    if lumps < 4 or lumps % 2:
        raise InputError(f"a bending electrode needs an even number of lumps, at least 4, not {lumps}")
    half, share = settings.length_um * 1e-6 / 2.0, np.linspace(0.0, LANDING, 10001)
    until = np.log1p(share / MIDDLE) + 2.0 * share / LANDING
    landing = np.interp(np.linspace(until[-1], 0.0, lumps // 2), until, share)
    ends = half * (1.0 - np.concatenate([[1.0], landing]))
    parts, (gauss, weights) = np.diff(ends)[:, None], np.polynomial.legendre.leggauss(2)
    at = (ends[:-1, None] + 0.5 * parts * (gauss + 1.0)).ravel()
    places = np.concatenate([[0.0], at, 2.0 * half - at[::-1], [2.0 * half]])
    carried = (0.5 * parts * weights).ravel()
    return _beam(settings, np.diff(places), np.ones(1), np.concatenate([carried, carried[::-1], [0.0]])[:, None])


def _beam(settings: DeviceSettings, sizes: Array, within: Array, weights: Array) -> Beam:
    """The beam of the settings on these elements."""
    if touching := settings.touching_at_rest:
        raise InputError(touching)
    width, thickness = settings.width_um * 1e-6, settings.thickness_um * 1e-6
    bending = settings.youngs_modulus_GPa * 1e9 * width * thickness**3 / 12.0
    tension = settings.residual_stress_MPa * 1e6 * (1.0 - settings.poisson_ratio) * width * thickness
    flat = Beam(width, bending, tension, np.zeros(weights.shape), sizes, within, weights)
    shape = settings.shape_at_rest_nm(flat.at_m / (settings.length_um * 1e-6))
    return replace(flat, rest_m=settings.gap_um * 1e-6 + NM * shape)


def _shapes(size: float, x: Array) -> Array:
    """Hermite's shapes on an element of this size at places from 0 to 1, shape (4, points)."""
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
