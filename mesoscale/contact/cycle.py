"""One closing-opening cycle of a rough contact: the entry point of the mesoscale model."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings

if TYPE_CHECKING:
    from mesoscale.contact.engine import Contact, Row


@dataclass(frozen=True)
class Branch:
    """One branch of a force-separation curve; arrays of one length, in the order they were traversed."""

    separation_nm: np.ndarray  # mean plane to flat
    repulsive_nN: np.ndarray
    attractive_nN: np.ndarray  # negative: attraction
    contact_area_nm2: np.ndarray  # contacting sites x site area
    asperities: np.ndarray
    sweeps: np.ndarray  # flow sweeps of the step that ends here


BRANCH_COLUMNS = {
    "separation_nm": ("nm", "mean separation"),
    "repulsive_nN": ("nN", "repulsive force"),
    "attractive_nN": ("nN", "attractive force (negative)"),
    "contact_area_nm2": ("nm^2", "area of contacting sites"),
    "asperities": ("1", "number of asperities in contact"),
    "sweeps": ("1", "flow sweeps of the step"),
}
"""Unit and long name of each array of a `Branch`, as result files state them."""


@dataclass(frozen=True)
class Cycle:
    """Closing and opening of one surface."""

    closing: Branch
    opening: Branch
    first_contact_nm: float  # separation at which the surface first touches on closing
    last_contact_nm: float  # separation at which it last touches on opening
    flags: dict[str, int | bool | str | float]
    converged: bool  # every step converged and the requested force was reached
    heights: np.ndarray | None = None  # the surface afterwards, nm (only if asked for)


def run_cycle(
    inputs: ContactInputs,
    settings: ContactSettings,
    seed: int,
    max_force_nN: float | None = None,
    heights: np.ndarray | None = None,
    keep_surface: bool = False,
    hold: "Callable[[Contact, Row], list[Row]] | None" = None,
) -> Cycle:
    """Close a rough surface onto a flat up to a force, and open it again.

    Parameters
    ----------
    inputs, settings
        Physical inputs, and model readings and resolution.
    seed
        Noise of the surface: the same seed gives the same noise whatever the inputs and the grid.
    max_force_nN
        Repulsive force at which closing ends; default `settings.max_force_nN`. A plastic contact ends closing at
        0.8 H(L^2) L^2 if this is less, where the whole cell is one contact, and is not converged.
    heights
        (N, N) surface in nm to use instead of a random one, for instance `Cycle.heights` of an
        earlier cycle; it is not changed. Contact is at its minima.
    keep_surface
        Return the surface as it is after the cycle.
    hold
        What happens between closing and opening (`mesoscale.contact.history`): takes the contact and its
        last row, returns the rows that follow at the end of the closing branch.

    Raises
    ------
    InputError
        For a surface that is not square or holds non-finite heights.
    """
    from mesoscale.contact.engine import Contact, trace

    plastic = settings.model == "plastic"
    if heights is None:
        from mesoscale.contact.surface import random_surface

        surface = random_surface(inputs, settings, seed)
    else:
        surface = _checked(heights)
        if plastic:
            surface = surface.copy()
    force = settings.max_force_nN if max_force_nN is None else max_force_nN
    if not (math.isfinite(force) and force > 0):
        raise InputError(f"max_force_nN = {force}: accepted are finite forces > 0 nN")
    contact = Contact(surface, inputs, settings)
    first_contact = contact.touching_separation
    approach = _approach(contact)
    closing = trace(contact, settings.force_steps, plastic, stop_force=min(force, contact.capacity))
    reached = closing.reached and force <= contact.capacity
    if hold is not None:
        closing.rows += hold(contact, closing.rows[-1])
    last = closing.rows[-1]
    changed = contact.changed_sites
    if changed > 0 and last.force > 0:
        contact.adopt_changes()
        departure = _approach(contact)
        path = trace(contact, settings.force_steps, False, last.force, stop_separation=last.separation)
        # the last row of the way down is the state in which closing ended
        opening = [last._replace(sweeps=0), *path.rows[-2::-1]]
    else:  # nothing flowed: the way back is the way there
        departure = approach
        opening = [row._replace(sweeps=0) for row in closing.rows[::-1]]
    return Cycle(
        closing=_branch(contact, [*approach, *closing.rows]),
        opening=_branch(contact, [*opening, *departure[::-1]]),
        first_contact_nm=first_contact + contact.offset,
        last_contact_nm=(opening[-1].separation if last.force > 0 else first_contact) + contact.offset,
        flags={
            "force_reached": reached,
            "force_miss": abs(last.force - force) / force,
            "unconverged_steps": closing.unconverged,
            "largest_load": closing.load,
            "full_contact": closing.full,
            "radius_bound_events": closing.bounds,
            "repeated_steps": closing.repeated,
            "changed_sites": changed,
        },
        converged=reached and closing.unconverged == 0,
        heights=surface if keep_surface else None,
    )


def _checked(heights: np.ndarray) -> np.ndarray:
    heights = np.ascontiguousarray(heights, dtype=float)
    if heights.ndim != 2 or heights.shape[0] != heights.shape[1] or heights.shape[0] < 3:
        raise InputError(f"heights: accepted is a square array of at least 3 x 3 sites, not {heights.shape}")
    if not np.isfinite(heights).all():
        raise InputError("heights: accepted are finite numbers in nm; fill or cut missing data")
    return heights


def _approach(contact: "Contact") -> "list[Row]":
    """Rows before first contact, from afar, where only the attraction acts."""
    from mesoscale.contact.engine import Row

    touch = contact.touching_separation
    gaps = np.geomspace(max(4.0 * contact.rms, 10.0), max(0.01 * contact.rms, 0.01), 20)
    return [Row(touch + gap, 0.0, contact.attraction(touch + gap), 0, 0, 0) for gap in gaps]


def _branch(contact: "Contact", rows: "list[Row]") -> Branch:
    separation, force, attraction, sites, asperities, sweeps = zip(*rows, strict=True)
    return Branch(
        np.array(separation) + contact.offset,
        np.array(force),
        np.array(attraction),
        np.array(sites) * contact.mechanics.site_area,
        np.array(asperities),
        np.array(sweeps),
    )
