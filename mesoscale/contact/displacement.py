"""Closing and opening of one surface by separation, with the opening after every closing asked for.

Surfaces that share one flat have one separation and not one force, so a pad is closed by
displacement. Opening depends on how deep the surface was pressed before: that is the memory of the
contact.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.engines import contact_on
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.contact.pressed import Contact, State
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
    opening : the same while opening from each depth, shape (k, 2, n); NaN at separations below the
        depth.
    settled : whether flow came to rest at every separation.
    """

    first_contact_nm: float
    closing: Array
    opening: Array
    settled: bool

    def at_steps(self, known_nm: Array, asked_nm: Array) -> "Displacement":
        """The same at other separations, between which forces are straight.

        Parameters
        ----------
        known_nm, asked_nm : falling separations, at which the forces are known and asked for.
        """

        def between(forces: Array) -> Array:
            return np.array([np.interp(-asked_nm, -known_nm, row) for row in forces])

        opening = np.array([between(branch) for branch in self.opening])
        return replace(self, closing=between(self.closing), opening=opening)


class Closing:
    """A rough surface that is brought to one separation after another, and may be opened.

    An opening is elastic and changes nothing: closing goes on from the surface as flow has left it.

    Attributes
    ----------
    first_contact_nm : separation at which the surface first touches (nm).
    settled : whether flow came to rest at every separation so far.
    """

    def __init__(
        self,
        inputs: ContactInputs,
        settings: ContactSettings,
        heights: Array,
        numerics: Numerics = NUMERICS,
    ) -> None:
        """Take (N, N) heights in nm, with contact at their minima; flow changes them in place."""
        self._contact = contact_on(heights, inputs, settings, numerics)
        self._touching = self._contact.touching_separation
        self._flats: list[float] = []
        self._forces: list[tuple[float, float]] = []
        self._has_flowed = False
        self.first_contact_nm = self._touching + self._contact.offset
        self.settled = True

    def close_to(self, separation_nm: float, attraction: bool = True) -> float:
        """Bring the flat down to a separation before contact; the repulsive force (nN).

        Parameters
        ----------
        attraction : whether it is wanted, too; it takes half of the time.
        """
        flat = separation_nm - self._contact.offset
        repulsive = 0.0
        if flat < self._touching or not self._contact.REVERSIBLE:
            start = self._flats[-1] if self._flats else flat
            moved = _bring_down(self._contact, start, flat)
            self.settled &= moved.settled and not moved.stuck
            repulsive = moved.force
        self._flats.append(flat)
        attractive = self._contact.attraction(flat) if attraction else np.nan
        self._forces.append((repulsive, attractive))
        return repulsive

    @property
    def closing(self) -> Array:
        """Repulsive and attractive force (nN, attraction negative) so far, shape (2, n)."""
        return np.array(self._forces).T

    def opening(self) -> Array:
        """The same on the way back to the first separation, in the order of closing, (2, n)."""
        forces = self.closing
        self._has_flowed |= self._contact.changed_sites > 0 or not self._contact.REVERSIBLE
        self._has_flowed |= self._contact.keeps_liquid
        if self._has_flowed:  # else the way back is the way there
            opened = self._contact.opened(np.array(self._flats))
            forces[:, :-1] = opened[:, :-1]
            self.settled &= self._contact.unsettled == 0
        return forces


def close_by_separation(
    inputs: ContactInputs,
    settings: ContactSettings,
    heights: Array,
    separations_nm: Array,
    depths: Positions,
    numerics: Numerics = NUMERICS,
) -> Displacement:
    """Close a rough surface to falling separations, and open it again from some of them.

    Parameters
    ----------
    heights : (N, N) surface in nm; contact is at its minima. Flow changes it in place.
    separations_nm : separations of the flat from the mean plane of the surface before contact,
        falling, shape (n,).
    depths : positions in `separations_nm` from which the surface is opened, rising, shape (k,).

    Raises
    ------
    InputError : separations do not fall.
    """
    separations_nm = np.asarray(separations_nm, float)
    if not (np.diff(separations_nm) < 0).all():
        raise InputError("separations_nm: accepted are falling separations in nm, from far to near")
    surface = Closing(inputs, settings, heights, numerics)
    opening = np.full((len(depths), 2, separations_nm.size), np.nan)
    for place, separation in enumerate(separations_nm.tolist()):
        surface.close_to(separation)
        for number in np.flatnonzero(depths == place):
            opening[number, :, : place + 1] = surface.opening()
    return Displacement(surface.first_contact_nm, surface.closing, opening, surface.settled)


def _bring_down(contact: Contact, start: float, target: float) -> State:
    """Move the flat from `start` to `target`, in smaller steps where flow finds no end."""
    moved = contact.move_to(target, contact.flows)
    step = start - target
    smallest = SMALLEST_STEP * step
    while moved.stuck and step > smallest:
        contact.back()
        step *= 0.5
        flat = start - step
        nearer = contact.move_to(flat, True)
        if nearer.stuck:
            contact.back()
            continue
        start = flat
        moved = contact.move_to(target, True)
        step = min(2.0 * step, start - target)
    return moved
