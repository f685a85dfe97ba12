"""Closing and opening of one surface by separation, with the opening after every closing asked for.

Surfaces that share one flat have one separation and not one force, so a pad is closed by displacement. Opening
depends on how deep the surface was pressed before: that is the memory of the contact.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.asperity.engine import Contact
from mesoscale.contact.cycle import contact_on
from mesoscale.contact.path import State
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings

Array = NDArray[np.float64]
Positions = NDArray[np.int_]

SMALLEST_STEP = 1e-3
"""Share of a step of separation below which flow that finds no end is given up."""


@dataclass(frozen=True)
class Displacement:
    """Forces of one surface at given separations.

    Attributes
    ----------
    first_contact_nm : separation at which the surface first touches on closing (nm).
    closing : repulsive and attractive force (nN, attraction negative) while closing, shape (2, n).
    opening : the same while opening from each depth, shape (k, 2, n); NaN at separations below the depth.
    settled : whether flow came to rest at every separation.
    """

    first_contact_nm: float
    closing: Array
    opening: Array
    settled: bool


def close_by_separation(
    inputs: ContactInputs, settings: ContactSettings, heights: Array, separations_nm: Array, depths: Positions
) -> Displacement:
    """Close a rough surface to falling separations, and open it again from some of them.

    After an opening the closing goes on from the surface as it was left: an opening is elastic and changes nothing.

    Parameters
    ----------
    heights : (N, N) surface in nm; contact is at its minima. Flow changes it in place.
    separations_nm : separations of the flat from the mean plane of the surface before contact, falling, shape (n,).
    depths : positions in `separations_nm` from which the surface is opened, rising, shape (k,).

    Raises
    ------
    InputError : separations do not fall.
    """
    separations_nm = np.asarray(separations_nm, float)
    if not (np.diff(separations_nm) < 0).all():
        raise InputError("separations_nm: accepted are falling separations in nm, from far to near")
    contact = contact_on(heights, inputs, settings)
    flats = separations_nm - contact.offset
    closing = np.zeros((2, flats.size))
    opening = np.full((len(depths), 2, flats.size), np.nan)
    touching = contact.touching_separation
    settled = True
    changed = 0
    for place, flat in enumerate(flats):
        if flat < touching:
            moved = _bring_down(contact, flats[place - 1] if place else flat, flat)
            settled &= moved.settled and not moved.stuck
            closing[0, place] = moved.force
        closing[1, place] = contact.attraction(flat)
        for number in np.flatnonzero(depths == place):
            opening[number, :, : place + 1] = closing[:, : place + 1]
            changed += contact.changed_sites
            if changed:  # else nothing has flowed yet: the way back is the way there
                opening[number, :, :place] = _way_back(contact, flats[:place])
                contact.move_to(flat, False)
    return Displacement(touching + contact.offset, closing, opening, settled)


def _bring_down(contact: Contact, start: float, target: float) -> State:
    """Move the flat from `start` to `target`, in smaller steps where flow finds no end."""
    moved = contact.move_to(target, contact.flows)
    step = start - target
    smallest = SMALLEST_STEP * step
    while moved.stuck and step > smallest:
        contact.back()
        step *= 0.5
        flat = start - step
        part = contact.move_to(flat, True)
        if part.stuck:
            contact.back()
            continue
        start = flat
        moved = contact.move_to(target, True)
        step = min(2.0 * step, start - target)
    return moved


def _way_back(contact: Contact, flats: Array) -> Array:
    """Repulsion and attraction of the surface as flow has left it, without further flow, shape (2, len(flats))."""
    contact.adopt_changes()
    touching = contact.touching_separation
    forces = np.zeros((2, flats.size))
    for place, flat in enumerate(flats):
        if flat < touching:
            forces[0, place] = contact.move_to(flat, False).force
        forces[1, place] = contact.attraction(flat)
    return forces
