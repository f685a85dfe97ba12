"""The scene's switch at central inputs on a few pads: what a change of its inputs or of the contact
moves, in volts.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

from mesoscale.answer.points import Point
from mesoscale.contact.numerics import Numerics
from mesoscale.settings import ContactSettings
from mesoscale.studies.contact_accuracy import releases_on_pads
from mesoscale.studies.driver import Array
from workflow.run.pads import load_model, points_of_job

OnPads = Callable[[Point, ContactSettings, Numerics], Array]
"""Release of a switch on a few pads, V, shape (pads,)."""


def central_pads(snakemake: Any) -> tuple[Point, ContactSettings, OnPads] | None:
    """The scene's switch at central inputs, the contact on the grid of its pads, and its release on
    a few pads.

    None where the job reads no pad: the scene has no switch.
    """
    path = snakemake.input.get("model")
    if not path:
        return None
    points, pad = points_of_job(snakemake)
    central = load_model([path], points).central
    releases = partial(releases_on_pads, central.pressed.grid, pad.point_cells)
    return central.point, points.on_grid, releases
