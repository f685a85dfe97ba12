"""A few cells of a pad, closed before the others: they tell how far the pad is to be closed."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.displacement import Closing
from mesoscale.contact.menisci import reach_nm
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs, FilmInputs
from mesoscale.pad.cells import Cell, first_contact_nm, surface_of
from mesoscale.pad.curves import PadCurves, closing_alone
from mesoscale.pad.grid import DEPTHS, PadGrid, far_nm, near_nm, opened_at_loads, usual_step_nm
from mesoscale.settings import ContactSettings
from mesoscale.settings.pad import PILOTS

Array = NDArray[np.float64]

PILOT_STEP = 5.0
"""Pilot cells are closed in so many times the steps of the pad: where the grid ends need not be
known to better than that."""
FEWEST_STEPS = 3
"""Where fewer reach the pressure, all steps are finer: a film of long waves is closed by little of
its RMS height."""
MOST_STEPS = 4000
"""Of the cells that find the range of separations."""
MERGED = 0.25
"""Share of the load from which on repulsion must not fall by this share: by chance it falls by 15 %
at most, where asperities of smooth films merge by 30 to 50 %."""


class SideBySide:
    """Cells under one plane that are brought to one separation after another, all of them together.

    Attributes
    ----------
    cells : the surfaces as they are closed.
    share : weight of each over the area of a cell (1/nm^2), shape (n,).
    first_contact_nm : separation from the film's mean plane at which each first touches (nm), shape
        (n,).
    """

    def __init__(
        self, inputs: ContactInputs, contact: ContactSettings, cells: Sequence[Cell]
    ) -> None:
        surfaces = [surface_of(inputs, contact, cell) for cell in cells]
        self.first_contact_nm = np.array([-float(heights.min()) for heights in surfaces])
        self._planes = [float(heights.mean()) for heights in surfaces]
        self.share = np.array([cell.weight for cell in cells]) / contact.length_nm**2
        self.cells = [Closing(inputs, contact, heights) for heights in surfaces]

    @property
    def net_GPa(self) -> Array:
        """Their mean net pressure at all separations so far, shape (n,)."""
        return np.tensordot(
            self.share, np.array([cell.closing.sum(axis=0) for cell in self.cells]), 1
        )

    def close_to(self, separation_nm: float, attraction: bool = True) -> float:
        """Bring all to a separation from the film's mean plane; their mean repulsion (GPa)."""
        forces = [
            cell.close_to(separation_nm + plane, attraction)
            for cell, plane in zip(self.cells, self._planes, strict=True)
        ]
        return float(self.share @ np.array(forces))


class Pilots:
    """Some of the cells of a pad, closed step by step.

    Attributes
    ----------
    separations_nm : from the mean plane of the film, so far, from far to near.
    loads_GPa : largest mean repulsion up to each.
    """

    def __init__(
        self,
        inputs: ContactInputs,
        contact: ContactSettings,
        cells: Sequence[Cell],
        step_nm: float | None = None,
        attraction: bool = True,
    ) -> None:
        """Take all cells of the pad.

        Parameters
        ----------
        step_nm : of the pad's separations in and near contact, at most; None: `usual_step_nm`.
        attraction : whether it is wanted, too; it takes half of the time.
        """
        self._inputs = inputs
        self._contact = contact
        self._cells = cells
        self._attraction = attraction
        self._step_nm = step_nm or usual_step_nm(inputs.rms)
        every = -(-len(cells) // PILOTS)
        chosen = _some_of(cells, every)
        self._closed = SideBySide(inputs, contact, chosen)
        others = [cell for place, cell in enumerate(cells) if place % every]
        others_nm = [first_contact_nm(inputs, contact, cell) for cell in others]
        self._touching_nm = np.append(self._closed.first_contact_nm, others_nm)
        self._start_nm = float(self._closed.first_contact_nm.max())
        self._asked_GPa = 0.0
        self._repulsion_GPa = 0.0
        self.separations_nm: list[float] = []
        self.loads_GPa: list[float] = []

    def close(self) -> None:
        """Bring them one step nearer.

        Raises
        ------
        InputError : they have never carried what was asked for.
        """
        steps = len(self.separations_nm)
        if steps == MOST_STEPS:
            raise InputError(
                f"device: {len(self._closed.cells)} cells closed by"
                f" {self._start_nm - self.separation_nm:g} nm carry {self.loads_GPa[-1] * 1e3:.3g}"
                f" of the {self._asked_GPa * 1e3:.3g} MPa that the switch presses with; lower"
                " hold_voltage_V"
            )
        self.separations_nm.append(self._start_nm - self._step_nm * PILOT_STEP * steps)
        self._repulsion_GPa = self._closed.close_to(self.separation_nm, self._attraction)
        largest_GPa = self.loads_GPa[-1] if self.loads_GPa else 0.0
        self.loads_GPa.append(max(self._repulsion_GPa, largest_GPa))

    @property
    def separation_nm(self) -> float:
        """Where they are."""
        return self.separations_nm[-1]

    def repel(self, pressure_GPa: float) -> bool:
        """Whether their repulsion alone has carried a pressure.

        Raises
        ------
        InputError : their asperities merge before.
        """
        self._asked_GPa = pressure_GPa
        before_GPa = self.loads_GPa[-2] if len(self.loads_GPa) > 1 else 0.0
        fallen = self._repulsion_GPa < (1.0 - MERGED) * before_GPa
        if before_GPa > MERGED * pressure_GPa and fallen:
            raise InputError(
                f"contact.mechanics: cells carry {before_GPa * 1e3:.3g} MPa, but"
                f" {self._repulsion_GPa * 1e3:.3g} MPa closed to {self.separation_nm:.2g} nm, as"
                " asperities merge that count one by one; take mechanics: coupled"
            )
        return self.loads_GPa[-1] >= pressure_GPa

    def carry(self, pressure_GPa: float) -> bool:
        """Whether they carry a pressure where they are, for all their attraction."""
        self._asked_GPa = pressure_GPa
        return bool(self._closed.net_GPa[-1] >= pressure_GPa)

    @property
    def curves(self) -> PadCurves:
        """How the pad closes, as far as they know."""
        separation_nm = np.array(self.separations_nm[::-1])
        return closing_alone(separation_nm, self._closed.net_GPa[::-1])

    @property
    def have_enough_steps(self) -> bool:
        """Whether they were closed by more than a few steps."""
        closed_nm = self._start_nm - self.separation_nm
        return closed_nm > (FEWEST_STEPS - 0.5) * PILOT_STEP * self._step_nm

    def in_finer_steps(self) -> "Pilots":
        """The same cells, not closed yet, in shorter steps."""
        step_nm = self._step_nm / FEWEST_STEPS
        return Pilots(self._inputs, self._contact, self._cells, step_nm, self._attraction)

    def grid(self, depths: int = DEPTHS) -> PadGrid:
        """Separations of the pad that is closed as far as they are, and opened from so many
        depths.
        """
        near = near_nm(
            lowest_nm=self.separation_nm,
            touching_nm=self._touching_nm,
            step_nm=self._step_nm,
            rough_places=isinstance(self._inputs, FilmInputs),
            reach_nm=reach_nm(self._contact.air, self._inputs.hamaker),
        )
        separation_nm = np.concatenate([near, far_nm(float(near[-1]))])[::-1]
        return opened_at_loads(separation_nm, self.separations_nm, self.loads_GPa, depths)


def closed_until(enough: Callable[[Pilots], bool], pilots: Pilots) -> Pilots:
    """Pilots that are not closed yet, closed until it is enough; in finer steps where few are.

    Raises
    ------
    InputError : it never is, or their asperities merge before.
    """
    while True:
        pilots.close()
        while not enough(pilots):
            pilots.close()
        if pilots.have_enough_steps:
            return pilots
        pilots = pilots.in_finer_steps()


def plan_grid(
    inputs: ContactInputs,
    contact: ContactSettings,
    cells: Sequence[Cell],
    pressure_GPa: float,
    step_nm: float | None = None,
    depths: int = DEPTHS,
) -> PadGrid:
    """Separations of a pad that carries a pressure at least, whatever presses it.

    Parameters
    ----------
    pressure_GPa : mean repulsion.
    step_nm : of separation in and near contact, at most; None: `usual_step_nm`.

    Raises
    ------
    InputError : the pilot cells never reach the pressure, or their asperities merge before.
    """
    pilots = Pilots(inputs, contact, cells, step_nm, attraction=False)
    return closed_until(lambda closed: closed.repel(pressure_GPa), pilots).grid(depths)


def _some_of(cells: Sequence[Cell], every: int) -> list[Cell]:
    """Every so many of the cells, as a pad of its own."""
    chosen = cells[::every]
    whole = sum(cell.weight for cell in chosen)
    return [replace(cell, weight=cell.weight / whole) for cell in chosen]
