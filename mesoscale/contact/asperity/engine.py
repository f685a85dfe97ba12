"""A surface and the asperities that touch a flat, at one separation after another.

Nothing here loops over the whole surface more often than needed: the sites are sorted by height in
bands as the flat comes down, asperities grow locally, and flow touches only its own patch.
"""

import math

import numpy as np

from mesoscale.contact import attraction, state
from mesoscale.contact.asperity import kernels
from mesoscale.contact.path import State
from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings

PREFACTOR = {"paper": 2.0 / 3.0, "hertz": 4.0 / 3.0}
WIDTH_RATIO = {"paper": 3.0**0.25, "wide": 3.0}


class Contact:
    """A surface, its contacting sites and its asperities at the current separation.

    Parameters
    ----------
    surface
        (N, N) heights in nm; changed in place by flow.
    flattened
        (N, N) sites whose asperities have yielded in earlier cycles, for `unloading_radius: flattened`.
    """

    FORCE_TOLERANCE = 1e-6
    # of H(L^2) L^2, what the cell carries as one contact: beyond, more than three quarters of it touch, asperities
    # that merge carry less than apart, and cycles gain energy (seen at 0.9, not at 0.8: docs/contact.md)
    BEARING_SHARE = 0.8

    # whether the last steps of a path aim at its end: a step beyond may fall back below the largest force where a
    # cluster that grows softens, and be taken for one that fell short; the paper's paths go beyond
    AIMS_AT_END = False

    def __init__(self, surface: np.ndarray, inputs, settings: ContactSettings, flattened: np.ndarray | None = None):
        self.n = surface.shape[0]
        self.heights = surface.reshape(-1)
        self.spacing = settings.length_nm / self.n
        self.length = settings.length_nm
        self.offset = float(self.heights.mean())
        self.lowest = float(self.heights.min())
        self.highest = float(self.heights.max())
        self.rms = math.sqrt(max(float(self.heights @ self.heights) / self.heights.size - self.offset**2, 0.0))
        self.capped = settings.model == "nonlinear"
        self.flows = settings.model == "plastic"
        self.mechanics = state.Mechanics(
            PREFACTOR[settings.prefactor] * inputs.e_star,
            float(inputs.h_macro),
            float(inputs.h_prime),
            self.spacing**2,
            settings.radius == "curvature",
            settings.area == "sites",
            settings.neighbours == 8,
            self.flows and settings.unloading_radius == "flattened",
            settings.merge == "not_less",
        )
        self.rule = state.FlowRule(
            settings.flow == "increment",
            settings.flow_increment_nm,
            settings.flow_width_nm,
            settings.flow_floor_pixels * self.spacing,
            WIDTH_RATIO[settings.flow_pair],
            settings.flow_tolerance if settings.flow == "return" else 0.0,
            settings.max_sweeps,
        )
        self.asperities = state.no_asperities(self.heights.size)
        # a surface that cannot flow needs no record of changes
        self.changes = state.no_changes(self.heights.size if self.flows else 0)
        if flattened is not None and self.mechanics.flattened_radius:
            if flattened.shape != surface.shape:
                raise InputError(f"flattened: accepted is an array of the heights' shape {surface.shape}")
            self.changes.flattened[flattened.reshape(-1)] = -1
        self.changed = self.changes.changed if self.flows else np.zeros(self.n**2, np.uint8)
        self.work = state.workspace(self.heights.size if self.flows else 0)
        self.parts = state.no_parts(self.heights.size if self.mechanics.not_less else 0)
        self.order = np.empty(0, np.int32)
        self.order_heights = np.empty(0)
        self.sorted_to = -np.inf
        self.pointer = 0
        self.attracts = inputs.hamaker > 0
        if self.attracts:
            self.cutoff = settings.gap_cutoff_nm
            self.touching = settings.touching_attracts
            self.rate = attraction.retardation_rate(settings.retardation_nm)
            self.strength = inputs.hamaker * self.spacing**2 / (6.0 * np.pi)
            self.bin_width = max(self.highest - self.lowest, 1e-6 * self.cutoff) / settings.gap_bins
            self.moments = np.zeros((settings.gap_bins, attraction.MOMENTS))
            attraction.bin_heights(self.heights, self.lowest, self.bin_width, self.moments)
            self.taken_out = 0

    @property
    def changed_sites(self) -> int:
        """Sites that flow has moved."""
        return int(self.changes.used[0])

    @property
    def flattened(self) -> np.ndarray | None:
        """(N, N) sites whose asperities have yielded, if the reading asks for them."""
        if not self.mechanics.flattened_radius:
            return None
        return (self.changes.flattened != 0).reshape(self.n, self.n)

    @property
    def capacity(self) -> float:
        """Largest force (nN) for which a plastic contact still consists of asperities; see `BEARING_SHARE`."""
        if not self.flows:
            return np.inf
        area = self.length**2
        return self.BEARING_SHARE * kernels.hardness(area, self.mechanics) * area

    @property
    def touching_separation(self) -> float:
        """Separation of first contact of the surface as it is now."""
        return -float(self.heights.min())

    def remarks(self) -> dict[str, float]:
        """Flags of a cycle that only one mechanics has; the contact as it is now."""
        return {}

    def _sort_to(self, height: float) -> None:
        """Have all unchanged sites below ``height`` sorted by height."""
        band = 0.5 * self.rms
        while self.sorted_to < height:
            start = self.sorted_to if np.isfinite(self.sorted_to) else self.lowest - 1.0
            upper = max(height, max(start, self.lowest) + band)
            if upper >= self.highest:
                upper = np.inf
            sites = np.flatnonzero((self.heights >= self.sorted_to) & (self.heights < upper)).astype(np.int32)
            sites = sites[self.changed[sites] == 0]
            values = self.heights[sites]
            rank = np.argsort(values)
            self.order = np.concatenate((self.order, sites[rank]))
            self.order_heights = np.concatenate((self.order_heights, values[rank]))
            self.sorted_to = upper

    def move_to(self, separation: float, with_flow: bool) -> State:
        """Bring the flat down to a separation; it may be undone by `back` until the next move."""
        level = -separation
        self._sort_to(level)
        stop = int(np.searchsorted(self.order_heights, level))
        self.changes.used[1] = 0
        self.changes.used[2] += 1
        self.changes.used[3] = self.changes.used[0]
        kernels.touch(
            self.asperities,
            self.heights,
            self.n,
            level,
            self.spacing,
            self.mechanics.eight,
            self.order,
            self.pointer,
            stop,
            self.changed,
            self.changes.sites,
            self.changes.used[0],
        )
        self.pointer = stop
        sweeps, settled = 0, True
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
            self.asperities,
            self.heights,
            self.n,
            self.spacing,
            level,
            self.mechanics,
            self.capped,
            self.flows,
            self.changes.flattened,
            self.parts,
        )
        nowhere = with_flow and sites == self.heights.size and load > 1.0 + self.rule.tolerance
        stuck = nowhere or not (settled or self.rule.fixed)
        return State(force, sites, asperities, bounds, load, sweeps, settled, stuck)

    def back(self) -> None:
        """Undo the last move's flow and lift the flat; the next move finds all contacts anew."""
        kernels.undo(self.heights, self.changes)
        if self.mechanics.flattened_radius:
            flattened, step = self.changes.flattened, self.changes.used[2]
            flattened[flattened == step] = 0
        self.lift()

    def lift(self) -> None:
        """Leave contact; the surface stays as it is."""
        kernels.clear(self.asperities)
        self.pointer = 0

    def adopt_changes(self) -> None:
        """Leave contact and take the surface as flow has left it for the original one.

        From then on the sites that have flowed are sorted and binned like all others.
        """
        self.lift()
        count = int(self.changes.used[0])
        sites = self.changes.sites[:count]
        values = self.heights[sites]
        if self.attracts:
            self._take_out_changed()
            attraction.bin_heights(values, self.lowest, self.bin_width, self.moments)
            self.taken_out = 0
        kept = self.changed[self.order] == 0
        order, order_heights = self.order[kept], self.order_heights[kept]
        low = np.flatnonzero(values < self.sorted_to)
        low = low[np.argsort(values[low])]
        places = np.searchsorted(order_heights, values[low])
        self.order = np.insert(order, places, sites[low])
        self.order_heights = np.insert(order_heights, places, values[low])
        self.changed[sites] = 0
        self.changes.used[0] = 0

    def _take_out_changed(self) -> None:
        """Have the histogram hold the unchanged sites only."""
        attraction.take_out(
            self.changes.original, self.taken_out, self.changes.used[0], self.lowest, self.bin_width, self.moments
        )
        self.taken_out = int(self.changes.used[0])

    def attraction(self, separation: float) -> float:
        """Attractive force in nN, negative (eq. 1); 0 without a pass over anything if A_H = 0."""
        if not self.attracts:
            return 0.0
        if self.changes.used[0] > self.taken_out:
            self._take_out_changed()
        near = max(attraction.NEAR_BINS * self.bin_width, 2.0 * self.cutoff)
        self._sort_to(min(near - separation + 2.0 * self.bin_width, self.highest))
        return -self.strength * attraction.inverse_cubes(
            self.heights,
            separation,
            self.cutoff,
            self.touching,
            self.order,
            self.order_heights,
            self.changed,
            self.changes.sites,
            self.changes.used[0],
            self.lowest,
            self.bin_width,
            self.moments,
            self.rate,
        )
