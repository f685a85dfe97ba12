"""An elastic sphere and a flat punch on a half-space, without adhesion.

Units nm, nN, GPa: 1 GPa nm^2 = 1 nN. Every function takes numbers or arrays, which broadcast.
"""

import numpy as np
from numpy.typing import NDArray

Real = float | NDArray[np.float64]


def hertz_force(indentation: Real, radius: Real, e_star: Real) -> Real:
    """Force that presses a sphere in by an approach: F = 4/3 E* sqrt(R) delta^(3/2).

    Parameters
    ----------
    indentation : nm
        Approach of distant points; 0 or less means no contact.
    radius : nm
        Radius of the sphere.
    e_star : GPa
        Combined modulus.

    Returns
    -------
    force : nN

    Source: Johnson, Contact Mechanics (1985), sec. 4.2, doi 10.1017/CBO9781139171731.
    """
    return 4.0 / 3.0 * e_star * np.sqrt(radius) * np.maximum(indentation, 0.0) ** 1.5


def hertz_indentation(force: Real, radius: Real, e_star: Real) -> Real:
    """Approach, nm, of a sphere of a radius (nm) under a force (nN): inverse of `hertz_force`."""
    return (0.75 * force / (e_star * np.sqrt(radius))) ** (2.0 / 3.0)


def hertz_contact_radius(force: Real, radius: Real, e_star: Real) -> Real:
    """Radius of the contact, nm, of a sphere of a radius (nm) under a force (nN): a^3 = 3 F R / (4
    E*).

    Source: Johnson (1985), sec. 4.2, doi 10.1017/CBO9781139171731.
    """
    return np.cbrt(0.75 * force * radius / e_star)


def hertz_pressure(distance: Real, force: Real, radius: Real, e_star: Real) -> Real:
    """Pressure, GPa, at a distance from the axis (nm): p0 sqrt(1 - r^2/a^2) with p0 = 3 F / (2 pi
    a^2); 0 outside.

    Parameters
    ----------
    distance : nm
    force : nN, above 0
    radius : nm
        Radius of the sphere.
    e_star : GPa

    Source: Johnson (1985), sec. 4.2, doi 10.1017/CBO9781139171731.
    """
    contact = hertz_contact_radius(force, radius, e_star)
    highest = 1.5 * force / (np.pi * contact**2)
    return highest * np.sqrt(np.maximum(1.0 - (distance / contact) ** 2, 0.0))


def punch_force(indentation: Real, contact_radius: Real, e_star: Real) -> Real:
    """Force, nN, that presses a rigid flat cylinder of a radius (nm) in by an approach (nm): F = 2
    E* a delta.

    An approach of 0 or less means no contact.

    Source: Sneddon (1965), doi 10.1016/0020-7225(65)90019-4; Johnson (1985), sec. 3.4.
    """
    return 2.0 * e_star * contact_radius * np.maximum(indentation, 0.0)


def punch_pressure(distance: Real, force: Real, contact_radius: Real) -> Real:
    """Pressure, GPa, below a rigid flat cylinder: F / (2 pi a sqrt(a^2 - r^2)); infinite at its
    edge, 0 outside.

    Parameters
    ----------
    distance : nm
        From the axis.
    force : nN
    contact_radius : nm
        Radius of the cylinder.

    Source: Johnson (1985), sec. 3.4, doi 10.1017/CBO9781139171731.
    """
    squared = contact_radius**2 - distance**2
    with np.errstate(divide="ignore"):
        pressure = force / (2.0 * np.pi * contact_radius * np.sqrt(np.maximum(squared, 0.0)))
    return np.where(squared >= 0.0, pressure, 0.0)
