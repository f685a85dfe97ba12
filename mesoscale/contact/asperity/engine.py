"""A surface and the asperities that touch a flat, at one separation after another, each on its own.

Asperities grow locally, and flow touches only its own patch.
"""

import numpy as np

from mesoscale.contact.asperity import kernels, state
from mesoscale.contact.attraction import Attraction
from mesoscale.contact.changes import undo
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.contact.pressed import Contact, State
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings

PREFACTOR = {"paper": 2.0 / 3.0, "hertz": 4.0 / 3.0}
WIDTH_RATIO = {"paper": 3.0**0.25, "wide": 3.0}


class AsperityContact(Contact):
    """A surface, its contacting sites and its asperities at the current separation."""

    def __init__(
        self,
        surface: np.ndarray,
        inputs: ContactInputs,
        settings: ContactSettings,
        numerics: Numerics = NUMERICS,
    ):
        super().__init__(surface, inputs, settings, numerics)
        reading = settings.reading
        self.mechanics = state.Mechanics(
            PREFACTOR[reading.prefactor] * inputs.e_star,
            self.hardness,
            self.site_area,
            reading.radius == "curvature",
            reading.area == "sites",
        )
        self.rule = state.FlowRule(
            numerics.flow == "increment",
            numerics.flow_increment_nm,
            numerics.flow_width_nm,
            numerics.flow_floor_pixels * self.spacing,
            WIDTH_RATIO[reading.flow_pair],
            self.tolerance,
            numerics.max_sweeps,
        )
        self.asperities = state.no_asperities(self.heights.size)
        self.work = state.workspace(self.heights.size if self.flows else 0)
        self.pointer = 0

    def soften(self, factor: float) -> None:
        """Take this share of the hardness of the fresh material."""
        super().soften(factor)
        self.mechanics = self.mechanics._replace(hardness=self.hardness)

    def move_to(self, separation: float, with_flow: bool) -> State:
        """Bring the flat down to a separation; it may be undone by `back` until the next move."""
        level = -separation
        self._sort_to(level)
        stop = int(np.searchsorted(self.order_heights, level))
        self._begin_step()
        kernels.touch(
            self.asperities,
            self.heights,
            self.n,
            level,
            self.spacing,
            self.order,
            self.pointer,
            stop,
            self.changed,
            self.changes.sites,
            self.changes.used[0],
        )
        self.pointer = stop
        sweeps = 0
        settled = True
        if with_flow:
            sweeps, settled = kernels.settle(
                self.heights,
                self.n,
                self.spacing,
                level,
                self.asperities,
                self.mechanics,
                self.rule,
                self.changes,
                self.work,
            )
        force, sites, asperities, bounds, load = kernels.total_force(
            self.asperities, level, self.mechanics, self.capped
        )
        nowhere = with_flow and sites == self.heights.size and load > 1.0 + self.tolerance
        stuck = nowhere or not (settled or self.rule.fixed)
        return State(force, sites, asperities, bounds, load, sweeps, settled, stuck)

    def back(self) -> None:
        """Undo the last move's flow and lift the flat; the next move finds all contacts anew."""
        undo(self.heights, self.changes)
        self.lift()

    def lift(self) -> None:
        """Leave contact; the surface stays as it is."""
        kernels.clear(self.asperities)
        self.pointer = 0

    def attraction(self, separation: float) -> float:
        """Attractive force in nN, negative (eq. 1); 0 without a pass over anything if A_H = 0."""
        if self.adhesion is None:
            return 0.0
        self.adhesion.take_out(self.changes)
        near_nm = self.adhesion.near_nm - separation + 2.0 * self.adhesion.bin_width
        self._sort_to(min(near_nm, self.highest))
        force = self.adhesion.undeformed(
            self.heights, separation, self.order, self.order_heights, self.changes, self.changed
        )
        if self.adhesion.menisci is None:
            return force
        return force + self._liquid(self.adhesion, separation)

    def _liquid(self, law: Attraction, separation: float) -> float:
        """What liquid adds to the attraction, nN."""
        far, edge = law.far_edge(law.near_nm, separation)
        near = self.order
        if far < len(law.moments):
            near = near[: np.searchsorted(self.order_heights, edge)]
        moved = self.changes.sites[: self.changed_sites]
        gap = self.heights[np.concatenate((near[self.changed[near] == 0], moved))] + separation
        weight = np.ones_like(gap)
        if not law.touching:
            weight = (gap >= 0.0).astype(float)
        return law.liquid(gap, weight, separation, far)
