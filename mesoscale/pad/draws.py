"""Pads at other inputs than the central ones: each draw of the inputs has a few cells of its own.

The uncertainty of the inputs is shared by all cells of a pad; the randomness of the surfaces is not. So a draw is one
set of inputs and of the cut-off D0, and its cells have that set in common. `mesoscale.pad.response` puts a closed form
through all of them. Where places of a film differ, their few cells scatter more than inputs move them: then all draws
have the same surfaces and places (common random numbers), and what these have by themselves is in no ratio to the
central curves.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.inputs.contact import ContactInputs, FilmInputs, contact_of
from mesoscale.inputs.definitions import RMS_SCATTER
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.cells import FIRST_SEED, close_cells, plan_grid
from mesoscale.pad.curves import assemble
from mesoscale.pad.memory import PadLaw, flats_of, law_of
from mesoscale.settings import ContactSettings, PadGridSettings

Array = NDArray[np.float64]

FIRST_DRAW_SEED = FIRST_SEED + 1_000_000
"""Surfaces of the draws differ from those of the central pad."""
HIGHEST_GAP_CUTOFF_NM = 0.3
"""Upper end of a D0 that is no input: a distance of atoms, above Israelachvili's 0.165 nm (docs/pad.md)."""
STEP_RMS = 0.05
"""Step of separation in units of the RMS height: the closed form needs no wells of single cells."""
GRID = PadGridSettings(pilot_cells=2, depths=4)
"""Where places differ, all cells of a draw are pilots: two do not stand for the others."""


@dataclass(frozen=True)
class Draw:
    """One set of inputs.

    Attributes
    ----------
    values : inputs by name, in their units.
    gap_cutoff_nm : D0 of the attraction.
    seeds : surfaces of its cells.
    """

    number: int
    values: dict[str, float]
    gap_cutoff_nm: float
    seeds: range

    def contact_of(self, contact: ContactSettings) -> tuple[ContactInputs, ContactSettings]:
        """Its inputs of a contact, and the settings of the contact with them put in."""
        return contact_of(self.values, contact.model_copy(update={"gap_cutoff_nm": self.gap_cutoff_nm}))


def plan_draws(table: InputTable, contact: ContactSettings, count: int, cells: int) -> list[Draw]:
    """Draws that fill the inputs' distribution evenly: a Latin hypercube over the inputs and D0.

    Where D0 is an input, the draws vary it with the inputs, and `Draw.gap_cutoff_nm` stays at its median.

    Parameters
    ----------
    count, cells : draws, and cells of each.
    """
    from scipy.stats import qmc  # slow to import

    units = qmc.LatinHypercube(len(table.rows) + 1, rng=FIRST_SEED).random(count)
    values = table.transform(units[:, :-1])
    low = contact_of(table.medians(), contact)[1].gap_cutoff_nm
    high = low if "gap_cutoff" in table.names else max(low, HIGHEST_GAP_CUTOFF_NM)
    shared = RMS_SCATTER.name in table.names
    return [
        Draw(
            k,
            dict(zip(table.names, row.tolist(), strict=True)),
            float(low + (high - low) * unit),
            range(first := FIRST_DRAW_SEED + (0 if shared else k * cells), first + cells),
        )
        for k, (row, unit) in enumerate(zip(values, units[:, -1], strict=True))
    ]


def close_draws(
    draws: Sequence[Draw],
    contact: ContactSettings,
    wanted_GPa: Callable[[Array], Array],
    pressed_GPa: Callable[[Array, Array], float],
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[PadLaw]:
    """The mean curves of each draw's cells.

    Parameters
    ----------
    wanted_GPa, pressed_GPa : what `plan_grid` takes of the switch.

    Raises
    ------
    InputError : inputs that the contact does not accept, or cells that never reach the pressure.
    """
    for done, draw in enumerate(draws):
        inputs, settings = draw.contact_of(contact)
        pilots = len(draw.seeds) if isinstance(inputs, FilmInputs) else GRID.pilot_cells
        planned, step = GRID.model_copy(update={"pilot_cells": pilots}), STEP_RMS * inputs.rms
        grid = plan_grid(inputs, settings, planned, wanted_GPa, draw.seeds.start, step, pressed_GPa)
        cells = assemble(grid, list(close_cells(inputs, settings, grid, draw.seeds)), settings.length_nm**2)
        yield law_of(cells, flats_of(inputs, settings))
        if progress:
            progress((done + 1) / len(draws), f"{done + 1} of {len(draws)} draws of the inputs")


def draw_rows(draw: Draw, law: PadLaw) -> Iterator[dict[str, Any]]:
    """Rows of pad/draws/chunk_NNN.csv: the curves of one draw."""
    for depth, branch in ((None, law.closing), *zip(law.depth_nm.tolist(), law.opening, strict=True)):
        for separation, (repulsive, attractive) in zip(law.separation_nm.tolist(), branch.T.tolist(), strict=True):
            if np.isfinite(repulsive):
                yield {
                    "draw": draw.number,
                    "gap_cutoff_nm": draw.gap_cutoff_nm,
                    "depth_nm": depth,
                    "separation_nm": separation,
                    "repulsive_MPa": repulsive * 1e3,
                    "attractive_MPa": attractive * 1e3,
                }


def laws_of_rows(rows: Iterable[Mapping[str, str]], draws: Sequence[Draw], contact: ContactSettings) -> list[PadLaw]:
    """The curves of the draws from the rows of ``pad/draws/``."""
    curves: dict[tuple[int, str], list[tuple[float, float, float]]] = {}
    for row in rows:
        point = float(row["separation_nm"]), float(row["repulsive_MPa"]) / 1e3, float(row["attractive_MPa"]) / 1e3
        curves.setdefault((int(row["draw"]), row["depth_nm"]), []).append(point)
    laws = []
    for draw in draws:
        closing = np.array(curves[draw.number, ""])
        depths = sorted((float(depth) for number, depth in curves if number == draw.number and depth))
        names = {float(depth): depth for number, depth in curves if number == draw.number and depth}
        opening = np.full((len(depths), 2, len(closing)), np.nan)
        for k, depth in enumerate(depths):
            branch = np.array(curves[draw.number, names[depth]])
            opening[k][:, len(closing) - len(branch) :] = branch[:, 1:].T
        laws.append(
            PadLaw(closing[:, 0], closing[:, 1:].T, np.array(depths), opening, flats_of(*draw.contact_of(contact)))
        )
    return laws
