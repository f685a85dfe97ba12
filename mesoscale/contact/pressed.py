"""A surface under a flat that comes down: what both engines have in common.

Nothing here loops over the whole surface more often than needed: the sites are sorted by height in
bands as the flat comes down.
"""

import math
from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np

from mesoscale.contact.attraction import Attraction
from mesoscale.contact.changes import no_changes
from mesoscale.contact.menisci import menisci_of
from mesoscale.contact.numerics import Numerics
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings


class Row(NamedTuple):
    """The contact at one separation (nm from the plane the heights are measured from)."""

    separation: float
    force: float
    attraction: float
    sites: int
    asperities: int
    sweeps: int


class State(NamedTuple):
    """The contact after one step of separation.

    Attributes
    ----------
    force : repulsive force, nN.
    bounds : asperities whose radius is bounded.
    load : largest force of an asperity over its yield force.
    stuck : whether flow has no end: nowhere left to flow to, or (return mapping) the sweeps ran
        out.
    """

    force: float
    sites: int
    asperities: int
    bounds: int
    load: float
    sweeps: int
    settled: bool
    stuck: bool

    def row(self, separation: float, attraction: float) -> Row:
        """The row of this state at its separation, with the attraction there (nN, negative)."""
        return Row(separation, self.force, attraction, self.sites, self.asperities, self.sweeps)


class Contact(ABC):
    """A surface, its sites by rising height, what flow has changed of it, and its attraction.

    Attributes
    ----------
    heights : (N^2,) in nm; contact is at the minima. Flow changes them in place.
    offset : mean of the heights before contact, nm.
    order, order_heights : unchanged sites up to the height `sorted_to`, and their heights in nm.
    unsettled : steps of `away` that did not settle.
    """

    FORCE_TOLERANCE = 1e-6
    # of H(L^2) L^2, what the cell carries as one contact: beyond, more than three quarters of it
    # touch, asperities that merge carry less than apart, and cycles gain energy (seen at 0.9 on
    # 64^2 sites, not at 0.8)
    BEARING_SHARE = 0.8

    # whether opening without flow goes the way of closing, but for the flow; then it is computed as
    # a closing
    REVERSIBLE = True
    # of a path, over the roughness
    SMALLEST_STEP = 1e-7

    # whether the last steps of a path aim at its end: a step beyond may fall back below the largest
    # force where a cluster that grows softens, and be taken for one that fell short; the paper's
    # paths go beyond
    AIMS_AT_END = False

    def __init__(
        self,
        surface: np.ndarray,
        inputs: ContactInputs,
        settings: ContactSettings,
        numerics: Numerics,
    ):
        """Take (N, N) heights in nm."""
        self.n = surface.shape[0]
        self.heights = surface.reshape(-1)
        self.length = settings.length_nm
        self.spacing = settings.length_nm / self.n
        self.site_area = self.spacing**2
        self.offset = float(self.heights.mean())
        self.lowest = float(self.heights.min())
        self.highest = float(self.heights.max())
        square = float(self.heights @ self.heights) / self.heights.size
        self.rms = math.sqrt(max(square - self.offset**2, 0.0))
        self.capped = settings.model == "nonlinear"
        self.flows = settings.model == "plastic"
        self.hardness = self.fresh_hardness = inputs.hardness
        self.tolerance = 0.0
        if numerics.flow == "return":
            self.tolerance = numerics.flow_tolerance
        # a surface that cannot flow needs no record of changes
        if self.flows:
            self.changes = no_changes(self.heights.size)
            self.changed = self.changes.changed
        else:
            self.changes = no_changes(0)
            self.changed = np.zeros(self.n**2, np.uint8)
        self.order = np.empty(0, np.int32)
        self.order_heights = np.empty(0)
        self.sorted_to = -np.inf
        self.unsettled = 0
        self.adhesion: Attraction | None = None
        if inputs.hamaker > 0 or menisci_of(settings.air, inputs.hamaker):
            self.adhesion = Attraction(
                self.heights, self.site_area, inputs.hamaker, settings, numerics
            )

    @abstractmethod
    def move_to(self, separation: float, with_flow: bool) -> State:
        """Bring the flat down to a separation; it may be undone by `back` until the next move."""

    @abstractmethod
    def back(self) -> None:
        """Undo the last move and its flow."""

    @abstractmethod
    def lift(self) -> None:
        """Leave contact; the surface stays as it is."""

    @abstractmethod
    def attraction(self, separation: float) -> float:
        """Attractive force in nN, negative (eq. 1); 0 without a pass over anything if A_H = 0."""

    @property
    def keeps_liquid(self) -> bool:
        """Whether an opening keeps the volume of the liquid."""
        return bool(self.adhesion and self.adhesion.menisci and self.adhesion.menisci.keeps_volume)

    def filled_share(self, separation: float) -> float:
        """Share of the cell that liquid fills at the current separation."""
        self.attraction(separation)
        if self.adhesion is None:
            return 0.0
        return self.adhesion.filled.sites / self.heights.size

    def hold_liquid(self, separation: float | None) -> None:
        """Keep the liquid of this separation from now on, as an opening does; None: no longer."""
        if self.adhesion and self.keeps_liquid:
            self.adhesion.kept = None
            if separation is not None:
                self.attraction(separation)
                self.adhesion.kept = self.adhesion.filled.volume

    @property
    def lost(self) -> float:
        """Energy lost in jumps, nN nm."""
        return 0.0

    def away(self, separation: float) -> Row:
        """The contact where it does not touch."""
        return Row(separation, 0.0, self.attraction(separation), 0, 0, 0)

    def way(self, separation: float) -> list[Row]:
        """The same, after what has to be known of the way there."""
        return [self.away(separation)]

    def opened(self, separations: np.ndarray) -> np.ndarray:
        """Repulsion and attraction (nN) back over separations of a closing, without flow.

        The last separation is the present one, at which the contact is afterwards, too. Shape (2,
        n).
        """
        self.hold_liquid(separations[-1])
        self.adopt_changes()
        touching = self.touching_separation
        forces = np.zeros((2, separations.size))
        for place, separation in enumerate(separations):
            if separation < touching:
                forces[0, place] = self.move_to(separation, False).force
            forces[1, place] = self.attraction(separation)
        self.hold_liquid(None)
        return forces

    @property
    def changed_sites(self) -> int:
        """Sites that flow has moved."""
        return int(self.changes.used[0])

    @property
    def capacity(self) -> float:
        """Largest force (nN) at which a plastic contact is still asperities: `BEARING_SHARE`."""
        area = self.length**2
        if not self.flows:
            return math.inf
        return self.BEARING_SHARE * self.hardness.pressure(area) * area

    @property
    def gaps_apart_nm(self) -> np.ndarray:
        """Gaps beyond first contact, rising, at which a cycle looks at the attraction."""
        reach = self.adhesion.reach_nm if self.adhesion else 0.0
        furthest = max(4.0 * self.rms, 10.0, 1.5 * reach)
        nearest = max(0.01 * self.rms, 0.01)
        return np.geomspace(furthest, nearest, 20)[::-1]

    @property
    def touching_separation(self) -> float:
        """Separation of first contact of the surface as it is now."""
        return -float(self.heights.min())

    def remarks(self) -> dict[str, float]:
        """Flags of a cycle that only one mechanics has; the contact as it is now."""
        return {}

    def soften(self, factor: float) -> None:
        """Take this share of the hardness of the fresh material."""
        self.hardness = self.fresh_hardness.scaled(factor)

    def adopt_changes(self) -> None:
        """Leave contact and take the surface as flow has left it for the original one.

        From then on the sites that have flowed are sorted and binned like all others.
        """
        self.lift()
        count = int(self.changes.used[0])
        sites = self.changes.sites[:count]
        values = self.heights[sites]
        if self.adhesion is not None:
            self.adhesion.adopt(self.changes, values)
        unchanged = self.changed[self.order] == 0
        order = self.order[unchanged]
        order_heights = self.order_heights[unchanged]
        low = np.flatnonzero(values < self.sorted_to)
        low = low[np.argsort(values[low])]
        places = np.searchsorted(order_heights, values[low])
        self.order = np.insert(order, places, sites[low])
        self.order_heights = np.insert(order_heights, places, values[low])
        self.changed[sites] = 0
        self.changes.used[0] = 0

    def _begin_step(self) -> None:
        """Start the record of what the next flow does."""
        self.changes.used[1] = 0
        self.changes.used[2] += 1
        self.changes.used[3] = self.changes.used[0]

    def _sort_to(self, height: float) -> None:
        """Have all unchanged sites below ``height`` sorted by height."""
        band = 0.5 * self.rms
        while self.sorted_to < height:
            start = self.sorted_to if np.isfinite(self.sorted_to) else self.lowest - 1.0
            upper = max(height, max(start, self.lowest) + band)
            if upper >= self.highest:
                upper = np.inf
            inside = (self.heights >= self.sorted_to) & (self.heights < upper)
            sites = np.flatnonzero(inside).astype(np.int32)
            sites = sites[self.changed[sites] == 0]
            values = self.heights[sites]
            rank = np.argsort(values)
            self.order = np.concatenate((self.order, sites[rank]))
            self.order_heights = np.concatenate((self.order_heights, values[rank]))
            self.sorted_to = upper
