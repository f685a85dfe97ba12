"""Electrical resistance of a rough contact, by its incremental stiffness (docs/resistance.md).

Current through the spots of a contact obeys the equations of a small further approach of its two
elastic bodies:

    1 / R = 2 / (E* (rho_1 + rho_2)) dF / d(delta)

for any shape and number of spots (Barber, Proc. R. Soc. A 459 (2003) 53). The approach delta is
that of the mean planes. The further approach is elastic: where asperities flow, its slope is that
of the way back. Contact grows with the force, so that the force is convex in delta, and its slope
lies between those of the chords to both sides.

Spots that are narrow beside the mean free path l of electrons resist more. Of a round spot of
radius a between equal metals (Wexler, Proc. Phys. Soc. 89 (1966) 927), with Holm's resistance first
and Sharvin's last:

    R = gamma(l / a) rho / (2 a) + 4 rho l / (3 pi a^2)

Sharvin's part depends on the area of contact alone, also of many spots. In gamma, a is the radius
of equal, distant spots that together have this area and this resistance of Barber's.

A film's resistance is added as if each spot had one potential, which is the least that spots and
film have together; for one spot that is a film of its own, a twelfth of the spot's own resistance
is missing at most (Holm, Electric Contacts, 1967: 0.27 rho / a at uniform current, 0.25 at one
potential).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.cycle import Branch

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Stiffness:
    """Incremental stiffness of a contact on an elastic way.

    Attributes
    ----------
    force_nN : rising, shape (n,), as all that follows.
    area_nm2 : of contact.
    approach_nm : of the mean planes.
    slope : dF/d(delta), N/m.
    """

    force_nN: Array
    area_nm2: Array
    approach_nm: Array
    slope: Array


def stiffness_of(branch: Branch) -> Stiffness:
    """Stiffness along an opening, or along a closing on which nothing flows.

    The force is straight in the approach while the same sites touch. So where a neighbouring step
    has the same area, the chord to it is the slope; elsewhere that of a parabola through three
    steps stands for it.
    """
    up = np.argsort(branch.separation_nm)[::-1]
    force = branch.repulsive_nN[up]
    approach = -branch.separation_nm[up]
    area = branch.contact_area_nm2[up]
    pressed = (force > 0) & (np.diff(approach, prepend=-np.inf) > 0)
    force = force[pressed]
    approach = approach[pressed]
    area = area[pressed]
    slope = np.gradient(force, approach, edge_order=2)
    chords = np.diff(force) / np.diff(approach)
    same = np.diff(area) == 0
    slope[:-1][same] = chords[same]
    slope[1:][same] = chords[same]
    return Stiffness(force, area, approach, slope)


def diffusive_share(knudsen: Array) -> Array:
    """What Wexler's gamma leaves of Holm's resistance of a spot of radius a; `knudsen` = l / a.

    As Nikolic and Allen (Phys. Rev. B 60 (1999) 3963) fit it to Boltzmann's equation. Electrons
    followed one by one give a resistance that is up to 4 % higher
    (tests/mesoscale/contact/test_resistance.py).
    """
    return (1.0 + 0.83 * knudsen) / (1.0 + 1.33 * knudsen)


def resistance_Ohm(
    slope: Array,
    area_nm2: Array,
    e_star_GPa: float,
    resistivities_nOhm_m: tuple[float, float],
    mean_free_paths_nm: tuple[float, float],
    film_Ohm_um2: float = 0.0,
) -> Array:
    """Resistance (Ohm) of a contact of two bodies and of the film on it.

    Parameters
    ----------
    slope : stiffness, N/m; any shape, as the area.
    resistivities_nOhm_m : of the two bodies; gold 22.
    mean_free_paths_nm : of their electrons; gold 37.7 at 20 C (Gall, J. Appl. Phys. 119 (2016)
        085101); 0: Holm alone.
    film_Ohm_um2 : resistance of a film times its area.
    """
    radius_nm = 2.0 * area_nm2 * e_star_GPa / (np.pi * slope)  # GPa nm^2 over N/m is nm
    ohm: Array = film_Ohm_um2 / (area_nm2 * 1e-6)
    for resistivity, path_nm in zip(resistivities_nOhm_m, mean_free_paths_nm, strict=True):
        # of one body; GPa nOhm m over N/m is Ohm, and so is nOhm m nm over nm^2
        ohm = ohm + diffusive_share(path_nm / radius_nm) * e_star_GPa * resistivity / (2.0 * slope)
        ohm = ohm + 2.0 * resistivity * path_nm / (3.0 * area_nm2)
    return ohm
