"""Does a diamond film pull as measured (Thimons et al., 2021)?

Cells of scene `diamond` at central inputs, in four attractions. A ruby sphere of 0.5 mm was
measured to pull off such films with 0.08 to 7.15 mJ/m². It feels some ten square micrometres: cells
of a median place, without the film's scatter of places. This film hardly flows, so the energy of
opening them is the work that a sphere would read.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from evidence.record import load_table
from mesoscale.answer.points import Point, on_pad_grid
from mesoscale.answer.switches import press_pad, surfaces_of
from mesoscale.inputs.table import from_rows
from mesoscale.pad.adhesion import adhesion_of
from mesoscale.settings.inputs import WorkAndRangeSettings
from workflow.run.contact_settings import contact_settings
from workflow.scene import load_scene

FITTED = WorkAndRangeSettings(work_mJ_m2=46.3, range_nm=5.6)
"""What Thimons et al. fitted as the intrinsic attraction."""


def arguments(parser: ArgumentParser) -> None:
    """Finished results of scene `diamond`, and how many pads of how many cells."""
    parser.add_argument("results", type=Path)
    parser.add_argument("--pads", type=int, default=4)
    parser.add_argument("--cells", type=int, default=4)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each attraction, pad and load."""
    scene = load_scene("diamond")
    described = SimpleNamespace(
        input={"topography": given.results / "topography" / "parameters.json"}
    )
    contact = contact_settings(scene.contact.model_dump(mode="json"), described)
    table = from_rows(load_table(given.results / "pad" / "inputs.csv"))
    contact, values = on_pad_grid(contact, table), table.medians() | {"rms_scatter": 0.0}
    fitted = values | {"hamaker": FITTED.hamaker(contact.attraction)}
    attractions = [("hamaker", values, cutoff) for cutoff in (contact.gap_cutoff_nm, 0.3, 1.0)]
    for attraction, inputs, cutoff in (
        *attractions,
        ("fitted", fitted, FITTED.gap_cutoff_nm(contact.attraction)),
    ):
        for number in range(given.pads):
            point = Point(inputs, cutoff, scene.device)
            pad = press_pad(point, contact, given.cells, surfaces_of(number))
            for opened in adhesion_of(pad.curves):
                yield {
                    "attraction": attraction,
                    "gap_cutoff_nm": cutoff,
                    "pad": number,
                    **asdict(opened),
                }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """The energy of a pad by both attractions, from its lowest to its highest."""

    def energy(attraction: str) -> str:
        kept = [
            1e-3 * float(row["energy_uJ_m2"]) for row in rows if row["attraction"] == attraction
        ]
        return f"{min(kept):.2g} to {max(kept):.2g} mJ/m²"

    return {"hamaker": energy("hamaker"), "fitted": energy("fitted")}
