"""The state of a contact and the walk along its force-separation curve.

Nothing here loops over the whole surface more often than needed: the sites are sorted by height in
bands as the flat comes down, asperities grow locally, and flow touches only its own patch.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from mesoscale.contact import attraction, kernels, state
from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings

PREFACTOR = {"paper": 2.0 / 3.0, "hertz": 4.0 / 3.0}
WIDTH_RATIO = {"paper": 3.0**0.25, "wide": 3.0}


class Row(NamedTuple):
    """The contact at one separation (nm from the plane the heights are measured from)."""

    separation: float
    force: float
    attraction: float
    sites: int
    asperities: int
    sweeps: int


@dataclass
class Path:
    """Rows in the order of falling separation, and what happened on the way.

    Attributes
    ----------
    reached : whether the wanted end was reached, up to a jump of the force.
    load : largest force of an asperity over its yield force.
    full : whether every site has touched.
    """

    rows: list[Row] = field(default_factory=list)
    unconverged: int = 0
    bounds: int = 0
    repeated: int = 0
    reached: bool = True
    load: float = 0.0
    full: bool = False


class State(NamedTuple):
    """What a move led to.

    Attributes
    ----------
    force : repulsive force, nN.
    bounds : asperities whose radius is bounded.
    load : largest force of an asperity over its yield force.
    stuck : whether flow has no end: nowhere left to flow to, or (return mapping) the sweeps ran out.
    """

    force: float
    sites: int
    asperities: int
    bounds: int
    load: float
    sweeps: int
    settled: bool
    stuck: bool


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


def trace(
    contact: Contact,
    steps: int,
    with_flow: bool,
    stop_force: float = np.inf,
    stop_separation: float = -np.inf,
) -> Path:
    """Bring the flat down from first contact, in steps that follow the force.

    Steps aim at force increments of a ``steps``-th of the final force, and at 30 % of the force
    reached so far in the foot of the curve; a step that misses by more than a factor of two is
    undone and repeated smaller. The last step is solved for the requested force (the force can jump
    when asperities merge: then the closer side of the jump is taken). A step in which flow is stuck is
    undone and repeated smaller, too; the path ends where it is stuck within 1 % of the roughness.
    """
    path = Path()
    final = stop_force
    separation = contact.touching_separation
    path.rows.append(Row(separation, 0.0, contact.attraction(separation), 0, 0, 0))
    force = 0.0
    scale = max(contact.rms, 1e-3 * contact.spacing)
    smallest = 1e-7 * scale
    step = scale / 300.0
    limit = -contact.highest - 2.0 * contact.length

    def accept(target: float, moved: State) -> None:
        nonlocal separation, force
        separation, force = target, moved.force
        pull = contact.attraction(target)
        path.rows.append(Row(target, force, pull, moved.sites, moved.asperities, moved.sweeps))
        path.bounds += moved.bounds
        path.unconverged += not moved.settled
        path.load = max(path.load, moved.load)
        path.full |= moved.sites == contact.heights.size

    while separation > stop_separation and force < final * (1.0 - contact.FORCE_TOLERANCE):
        target = max(separation - step, stop_separation)
        if target < limit:
            path.reached = False
            break
        moved = contact.move_to(target, with_flow)
        if moved.stuck:
            contact.back()
            if step <= 0.01 * scale:
                path.reached = False
                break
            path.repeated += 1
            step *= 0.25
            continue
        if moved.force > final * (1.0 + contact.FORCE_TOLERANCE):
            contact.back()
            solve_force(contact, separation, target, force, moved.force, final, with_flow, smallest, accept)
            break
        rise = moved.force - force
        wanted = min(final / steps, max(0.3 * force, 0.02 * final / steps))
        if rise > 2.0 * wanted and step > smallest:
            contact.back()
            path.repeated += 1
            step *= max(0.25, wanted / rise)
            continue
        accept(target, moved)
        wanted = min(final / steps, max(0.3 * force, 0.02 * final / steps))
        # far below first contact, as on a flat surface, the roughness is no measure of a step
        largest = max(scale, 0.1 * (path.rows[0].separation - separation)) / 30.0
        step = min(step * min(2.0, max(0.5, wanted / rise if rise > 0 else 2.0)), largest)
        if contact.AIMS_AT_END and rise > 0 and force + wanted > final:
            step = min(step, (path.rows[-2].separation - separation) * (final - force) / rise)
    return path


def solve_force(
    contact: Contact,
    start: float,
    beyond: float,
    start_force: float,
    beyond_force: float,
    wanted: float,
    with_flow: bool,
    smallest: float,
    accept: Callable[[float, State], None],
) -> None:
    """Bring the flat down to where the force is the wanted one.

    Regula falsi (Illinois) between ``start``, the last separation, and ``beyond``, where the force is too large.
    Trials below the wanted force are steps of the path and handed to ``accept``; those above it are undone. Where
    the force jumps over the wanted one, the closer side is taken, unless flow is stuck there.
    """
    high, low = start, beyond  # force below, above the wanted one
    short, excess = wanted - start_force, beyond_force - wanted
    weight_high = weight_low = 1.0
    last_side = 0
    for trial in range(60):
        if high - low <= smallest:
            break
        share = 0.5
        if trial % 4 < 3 and math.isfinite(excess):
            share = short * weight_high / (short * weight_high + excess * weight_low)
        middle = high + share * (low - high)
        moved = contact.move_to(middle, with_flow)
        reached = abs(moved.force - wanted) <= 0.5 * contact.FORCE_TOLERANCE * wanted and not moved.stuck
        if reached or (moved.force < wanted and not moved.stuck):
            accept(middle, moved)
            high, short = middle, wanted - moved.force
            if reached:
                return
            weight_high, weight_low = 1.0, weight_low * 0.5 if last_side == 1 else weight_low
            last_side = 1
        else:
            contact.back()
            low, excess = middle, math.inf if moved.stuck else moved.force - wanted
            weight_low, weight_high = 1.0, weight_high * 0.5 if last_side == -1 else weight_high
            last_side = -1
    if excess < short:
        accept(low, contact.move_to(low, with_flow))
