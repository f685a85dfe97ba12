"""Where a flat that comes down meets a surface: sites reached at each of a few separations."""

from dataclasses import dataclass

import numpy as np

from mesoscale.contact.cycle import Cycle
from mesoscale.contact.surface import random_surface
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import NOMINAL_SEED

STEPS = 12
"""Separations from first contact to the deepest closing."""
MOST_PIXELS = 256
"""Side of the pictures; sites are pooled so that none that is reached is lost."""


@dataclass(frozen=True)
class Spots:
    """A surface and the sites that the flat has reached.

    Attributes
    ----------
    towards_flat_nm : heights about the mean plane, positive towards the flat, of every n-th site,
        shape (m, m).
    separation_nm, repulsive_nN, asperities : of the flat at each step, from first contact on, shape
        (k,).
    cut_share : share of the cell's area that the flat has reached, shape (k,).
    step : first step at which any site of a pixel is reached, -1 for never, shape (m, m).
    """

    towards_flat_nm: np.ndarray
    separation_nm: np.ndarray
    repulsive_nN: np.ndarray
    asperities: np.ndarray
    cut_share: np.ndarray
    step: np.ndarray


def spots_under(inputs: ContactInputs, settings: ContactSettings, cycle: Cycle) -> Spots:
    """Sites of the nominal surface that the flat reaches on the closing of `cycle`.

    The surface is cut as it was: flow and elastic displacement, which the force does hold, do not
    change the picture.
    """
    surface = random_surface(inputs, settings, NOMINAL_SEED)
    height = surface.mean() - surface  # contact is at the minima of the heights
    closing = cycle.closing
    touching = np.flatnonzero(closing.repulsive_nN > 0)
    down = closing.separation_nm[touching]
    separations = np.linspace(down[0], down[-1], STEPS)
    nearest = np.abs(down - separations[:, None]).argmin(axis=1)
    chosen = touching[np.unique(nearest)]
    separation = closing.separation_nm[chosen]
    pool = max(1, -(-surface.shape[0] // MOST_PIXELS))
    side = surface.shape[0] // pool
    inside = height[: side * pool, : side * pool]
    highest = inside.reshape(side, pool, side, pool).max(axis=(1, 3))
    reached = highest[..., None] >= separation
    share = (height[..., None] >= separation).mean(axis=(0, 1))
    first = np.where(reached.any(axis=-1), reached.argmax(axis=-1), -1)
    force = closing.repulsive_nN[chosen]
    asperities = closing.asperities[chosen]
    return Spots(inside[::pool, ::pool], separation, force, asperities, share, first)
