"""The contact of a rough surface with a flat where all asperities share one elastic half-space.

The gap g = h + d + u holds the displacement u of a half-space of modulus E* under the pressure p; d
is the separation of the mean planes. Where p = 0 the surfaces are apart (g >= 0), where 0 < p < H
they touch (g = 0), and where p = H, the hardness, the surface yields (g <= 0). Unknown are only the
sites that can touch: a force F raises the surface nowhere by more than F times the depth of the
Green's function, so all sites higher than that are apart.
"""

import math
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from mesoscale.contact.attraction import attracting
from mesoscale.contact.changes import undo
from mesoscale.contact.coupled import clusters, dense, grid, half_space, layers, split, validity
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.contact.pressed import Contact, State
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings


class Kept(NamedTuple):
    """The pressures at one separation, to go back to or on from; as in `CoupledContact`."""

    separation: float
    sites: np.ndarray
    pressure: np.ndarray
    limit: np.ndarray
    field: np.ndarray | None


class CoupledContact(Contact):
    """A surface on an elastic half-space, and its pressures at the current separation."""

    TOLERANCE = 1e-9  # aimed at, residual of the pressures over the largest one
    GRID_TOLERANCE = 5e-7  # the same where the whole grid is transformed: half the time of 1e-9
    SETTLED = 1e-6  # demanded
    # tolerances to which pressures are solved while hardness still changes with the clusters
    COARSER = 100.0
    # Bounds of the sites that a dense matrix holds: over the pixels of a side, and as such, or one
    # to a pixel. Beyond, transforms of the whole grid cost less: pads of 128^2 sites take 0.8 of
    # the time with 4 or 8 per pixel instead of 16, and light loads of 1024^2 0.4 with 1024 sites
    # instead of 256. Rough and smooth, light and heavy, 256^2 to 2048^2, elastic and plastic: half
    # as many take up to 1.7 times as long, twice as many 0.7 to 1.4 times.
    DENSE_PER_PIXEL = 8
    DENSE = 1024
    LONGEST_GUESS = 2.0  # over the last step: so far pressures are taken to go on as in it
    # D0, and largest displacements: sites nearer than both count with their displacement in the
    # attraction, the others without. Errs by at most 1.2 % at a single step (128^2 and 256^2,
    # elastic and plastic, RMS 2 to 15 nm, to 10 MPa); without the second by 30 % on the roughest
    NEAR_CUTOFFS = 12.0
    NEAR_DISPLACEMENTS = 4.0
    # share of the cell: so few sites near liquid count with their displacement. Where it fills
    # more, its edge is far from most contacts, and the others err by at most 0.5 % (128^2 and
    # 256^2, 20 nN to 20 uN, RMS 2 and 5 nm)
    NEAR_LIQUID = 0.1
    # pairs of sites for each of the cell that take as long as a transform there and back
    TRANSFORM_PAIRS = 8
    # pairs of sites that take as long as a mesh, and as a transform in single precision: at all,
    # for each site of the cell, for each displaced, and for each pressed site
    MESH_COSTS = np.array([3e4, 0.3, 8.0, 700.0])
    SINGLE_COSTS = np.array([3e4, 3.5, 1.0, 0.0])
    AIMS_AT_END = True
    ROUNDS = 40
    FALLING_ROUNDS = 10  # from here on hardness may only fall, so that the rounds come to an end

    def __init__(
        self,
        surface: np.ndarray,
        inputs: ContactInputs,
        settings: ContactSettings,
        numerics: Numerics = NUMERICS,
    ):
        super().__init__(surface, inputs, settings, numerics)
        self.e_star = float(inputs.e_star)
        self.hamaker = float(inputs.hamaker)
        self.settings = settings
        self.bodies = settings.bodies
        self.table = half_space.influence(self.n, self.length, self.bodies)
        self.scale = self.length / self.e_star
        self.stiffness = 1.0 / (self.scale * float(self.table[0, 0]))
        # how far 1 nN raises the surface at most, anywhere: it does, because the mean of the
        # displacement is 0
        self.rise = -self.scale * float(self.table.min()) / self.site_area
        self.dense = min(
            self.DENSE_PER_PIXEL * self.n, max(self.DENSE, self.n), self.heights.size - 1
        )
        self.matrix = np.empty((0, 0))
        self.place = np.full(self.heights.size, -1, np.int32)
        self.rank = np.full(self.heights.size, -1, np.int32)  # of the sites in `order`
        self.ranked = 0
        self.mean = self.offset
        self.roughness = validity.roughness(surface, self.length, self.bodies)
        self._forget()

    def _forget(self) -> None:
        self.separation = math.inf
        self.bounded = False
        self.ahead = (0.0, np.empty(0))  # how far the first guess goes on, and the field before
        self.guessed = False  # whether the pressures are still the first guess on a grid
        self.known_height = -math.inf
        self.sorted_known = 0  # of `order`, how many are known
        self.grid: grid.Grid | None = None
        self.place[:] = -1
        self.sites = np.empty(0, np.int32)  # the known sites
        self.pressure = np.empty(0)  # GPa, of the known sites, as all that follows
        self.displacement = np.empty(0)  # nm
        self.limit = np.empty(0)  # GPa
        self.before = self.earlier = self._kept()

    def _kept(self) -> Kept:
        field = None if self.grid is None else self.grid.field
        return Kept(self.separation, self.sites, self.pressure.copy(), self.limit.copy(), field)

    @property
    def capacity(self) -> float:
        """Largest force (nN) to which the contact is followed.

        Full elastic contact: there the separation of the mean planes is 0 and stays so. With a
        hardness, `BEARING_SHARE` of what it carries on the whole cell if this is less.
        """
        full = (1.0 - 1e-6) * self.e_star * self.roughness.flattening * self.length**2
        if not (self.flows or self.capped):
            return full
        area = self.length**2
        return min(full, self.BEARING_SHARE * self.hardness.pressure(area) * area)

    def lift(self) -> None:
        """Leave contact; the surface stays as it is."""
        self._forget()

    def adopt_changes(self) -> None:
        """Leave contact and take the surface as flow has left it for the original one."""
        super().adopt_changes()
        self.rank[:] = -1
        self.ranked = 0
        self.mean = float(self.heights.mean())

    def back(self) -> None:
        """Undo the last move, its flow and its pressures."""
        undo(self.heights, self.changes)
        reused, self.before = self.before, self.earlier
        self.separation, places = reused.separation, self.place[reused.sites]
        self.pressure[:] = 0.0
        self.pressure[places] = reused.pressure
        self.limit[:] = self._fresh_limit
        self.limit[places] = reused.limit
        if self.grid is None:
            dense.multiply(self.matrix, self.sites.size, self.pressure, self.displacement)
        elif reused.field is None:
            self.displacement = self.grid.displace(self.sites, self.pressure)
        else:
            self.grid.field = reused.field
            self.grid.under = (reused.sites, reused.pressure)
            self.displacement = reused.field[self.sites]

    def move_to(self, separation: float, with_flow: bool) -> State:
        """Bring the flat down to a separation; it may be undone by `back` until the next move."""
        self.earlier, self.before = self.before, self._kept()
        self._begin_step()
        self._expect(separation)
        self.separation = separation
        self.bounded = with_flow or self.capped
        if not self.bounded and separation + self.mean <= 0.0:  # no pressure parts the mean planes
            return State(math.inf, self.heights.size, 1, 0, math.inf, 0, False, False)
        rounds, settled = self._solve_as_bounded()
        cluster, count = self._clusters()
        if with_flow:
            clusters.flatten(
                self.heights,
                self.sites,
                separation,
                self.displacement,
                self.pressure,
                self._bounds(),
                self.changes,
            )
        touching = int(np.count_nonzero(cluster >= 0))
        hardness = self._hardness_of(cluster)
        load = 0.0
        if touching and hardness.all():
            load = float((self._traction() / hardness).max())
        return State(self.force, touching, count, 0, load, rounds, settled, False)

    def _expect(self, separation: float) -> None:
        """Take the pressures for those at a separation if they go on as in the last step: a first
        guess.
        """
        before = self.earlier
        share = self._share(separation)
        if share:
            change = self.before.pressure.copy()
            change[self.place[before.sites]] -= before.pressure
            self.pressure += share * change
        if self.grid is not None:
            self.guessed = True
            self.ahead = (0.0, self.grid.field)
            if share and before.field is not None:
                self.ahead = (share, before.field)
            self.displacement = self._expected_field(self.sites)

    def _share(self, separation: float) -> float:
        """How far a first guess goes on as in the last step, over that step; 0 where it does
        not.
        """
        now = self.before
        before = self.earlier
        last = now.separation - before.separation
        same_way = (now.field is None) == (before.field is None)
        if not same_way or not last or not math.isfinite(last):
            return 0.0
        share = (separation - now.separation) / last
        if not 0.0 < share <= self.LONGEST_GUESS:
            return 0.0
        return share

    def _expected_field(self, sites: np.ndarray) -> np.ndarray:
        """Displacement (nm) of some sites by the first guess of the pressures."""
        share, before = self.ahead
        field = self.whole.field[sites]
        if not share:
            return field
        return field + share * (field - before[sites])

    def remarks(self) -> dict[str, float]:
        """What says whether the model holds, for the flags of a cycle (`validity`); the contact as
        it is now.
        """
        cluster, count = self._clusters()
        touching = cluster >= 0
        mean_area = self.site_area * max(int(touching.sum()) / max(count, 1), 1.0)
        hardness = self.hardness.pressure(mean_area)
        plasticity_index = math.inf
        if hardness > 0.0:
            plasticity_index = self.modulus * self.roughness.slope / hardness
        yielded = 0.0
        if count:
            limit = (1.0 - 1e-12) * self._hardness_of(cluster)[touching]
            yielded = float(np.mean(self._traction()[touching] >= limit))
        return {
            "rms_slope": self.roughness.slope,
            "rms_curvature_per_nm": self.roughness.curvature,
            "plasticity_index": plasticity_index,
            "yielded_share": yielded,
            **validity.adhesion_numbers(self.hamaker, self.settings, self.modulus, self.roughness),
        }

    @property
    def modulus(self) -> float:
        """E* (GPa) of waves as short as the contacts are, h''/h': theirs where the bodies have
        layers.
        """
        if not self.bodies or self.roughness.slope == 0.0:
            return self.e_star
        q = self.roughness.curvature / self.roughness.slope
        return self.e_star / float(layers.softness(self.bodies, np.array([q]))[0])

    @property
    def force(self) -> float:
        """Repulsive force, nN."""
        return self._pressed

    @property
    def _pressed(self) -> float:
        """Force of all pressures, nN."""
        return float(self.pressure.sum()) * self.site_area

    def _traction(self) -> np.ndarray:
        """Normal stress (GPa) on the known sites, compression positive."""
        return self.pressure

    def _bounds(self) -> np.ndarray:
        """Largest pressures (GPa) of the known sites."""
        return self.limit

    def _open_gap(self) -> np.ndarray:
        """Gap (nm) of the known sites before the pressures deform the surface."""
        return self.heights[self.sites] + self.separation

    def fields(self) -> tuple[np.ndarray, np.ndarray]:
        """Pressure (GPa) and gap (nm; 0 in contact) of all sites at the current separation, shapes
        (N, N).
        """
        pressure = self.whole.spread(self.sites, self.pressure.copy())
        displacement = self.whole.displacement(pressure)
        gap = np.where(
            pressure > 0.0, 0.0, np.maximum(self.heights + self.separation + displacement, 0.0)
        )
        return pressure.reshape(self.n, self.n), gap.reshape(self.n, self.n)

    def _solve_as_bounded(self) -> tuple[int, bool]:
        """Solve, in rounds where pressures have a limit; their number and whether they settled."""
        if not self.bounded:
            return 0, self._solve()
        return self._solve_rounds()

    def _solve_rounds(self) -> tuple[int, bool]:
        """Solve with the hardness of each cluster until the clusters are those it belongs to.

        A larger cluster is softer and a softer one larger, so the rounds, which start from the
        clusters of the separation before, mostly go one way. Attraction can hold clusters together
        that part once they are as soft as one: then no state has the hardness of its clusters, and
        those that have touched in the last rounds keep the lower one. Returns the rounds and
        whether they settled.
        """
        for rounds in range(1, self.ROUNDS + 1):
            if not self.hardness.constant:
                self._solve(self.COARSER)
                if self._hardens(rounds):
                    continue
            solved = self._solve()
            if not self._hardens(rounds):
                return rounds, solved
        return self.ROUNDS, False

    def _hardens(self, rounds: int) -> bool:
        """Take the hardness of the clusters, after many rounds only a lower one; whether that
        changes any limit.
        """
        caps = self._hardness_of(self._clusters()[0])
        if rounds >= self.FALLING_ROUNDS:
            caps = np.minimum(caps, self.limit)
        touching = self.pressure > 0.0
        if self.hardness.constant or np.array_equal(caps[touching], self.limit[touching]):
            return False
        self.limit = caps
        return True

    def _clusters(self) -> tuple[np.ndarray, int]:
        """Number of the cluster of each known site, -1 where it is apart, and how many there
        are.
        """
        cluster = np.empty(self.sites.size, np.int32)
        count = clusters.label(self.sites, self.place, self.pressure, self.n, cluster)
        return cluster, count

    def _hardness_of(self, cluster: np.ndarray) -> np.ndarray:
        """Hardness (GPa) of the clusters, for each known site; for one apart that of a single
        site.
        """
        # the last for those apart, of cluster -1
        sites = np.append(np.bincount(cluster[cluster >= 0]), 1)
        hardness = self.hardness.pressure(self.site_area * sites)
        return np.broadcast_to(hardness, sites.shape)[cluster]

    def _solve(self, coarser: float = 1.0) -> bool:
        """Find the pressures with the limits at hand, to so many tolerances; True if they
        settled.
        """
        while True:
            self._know(self._pressed)
            gap = self._open_gap()
            limit = self._bounds()
            if self.grid is None:
                cell = (self.sites, self.place, self.n, self.stencil)
                solution = (coarser * self.TOLERANCE, self.pressure, self.displacement)
                _, settled = dense.solve(self.matrix, cell, gap, limit, *solution)
            else:
                solution = (coarser * self.GRID_TOLERANCE, self.pressure, self.displacement)
                _, settled = grid.solve(self.grid, self.sites, self.place, gap, limit, *solution)
            if not settled:
                settled = self._project(gap, limit)
            self.guessed = False
            if self._knows_enough(self._pressed):
                return settled

    def _project(self, gap: np.ndarray, limit: np.ndarray) -> bool:
        """The same where the active sets did not settle."""
        matrix = self.matrix[: self.sites.size, : self.sites.size]
        if self.grid is None:
            norm = float(np.abs(matrix).sum(axis=1).max())
            apply = matrix.__matmul__
        else:
            norm = float(self.grid.compliance.max())
            apply = partial(self.grid.displacement_at, self.sites)
        self.pressure, self.displacement, _, _ = grid.project(
            apply, norm, gap, limit, self.stiffness, self.TOLERANCE, self.pressure
        )
        if self.grid is not None:
            self.displacement = self.grid.displace(self.sites, self.pressure)
        sites = self.sites.size
        worst = dense.residual(gap, self.pressure, self.displacement, limit, self.stiffness, sites)
        return worst <= self.SETTLED

    def _highest(self, force: float) -> float:
        """Original height above which no site can touch under a force."""
        return -self.separation + self.rise * force

    def _knows_enough(self, force: float) -> bool:
        return self.sites.size == self.heights.size or self.known_height >= self._highest(force)

    def _know(self, force: float) -> None:
        """Make all sites known that can touch under a force, and a few more."""
        new = self.sites[:0]
        if not self._knows_enough(force):
            self.known_height = self._highest(1.1 * force) + 1e-3 * self.rms
            self._sort_to(self.known_height)
            count = int(np.searchsorted(self.order_heights, self.known_height))
            new = self.order[self.sorted_known : count]
            self.sorted_known = count
        if new.size:
            self._add(new)

    def _add(self, new: np.ndarray) -> None:
        """Make further sites known; where they are many, for a grid, in the order of the cell."""
        old = self.sites.size
        count = self.sites.size + new.size
        if self.grid is None and count > self.dense:
            self.matrix = self.matrix[:0, :0].copy()  # frees its memory
            self.grid = self.whole
            self.grid.split.forget()
            self.displacement = self.grid.displace(self.sites, self.pressure)
        sites = np.append(self.sites, new)
        pressure = np.append(self.pressure, np.zeros(new.size))
        limit = np.append(self.limit, np.full(new.size, self._fresh_limit))
        displacement = np.zeros(count)
        displacement[:old] = self.displacement
        if self.grid is not None:
            if self.guessed:
                displacement[old:] = self._expected_field(new)
            else:
                self._displace(new, displacement[old:])
        self.place[new] = np.arange(old, count, dtype=np.int32)
        ordered = self.grid is None or self.grid.split.know(sites, self.place)
        order = slice(None) if ordered else np.argsort(sites)
        known = (sites[order], pressure[order], limit[order], displacement[order])
        self.sites, self.pressure, self.limit, self.displacement = known
        self.place[self.sites] = np.arange(count, dtype=np.int32)
        if self.grid is None:
            # memory is touched only as sites come in; the odd length keeps cache lines apart
            if self.matrix.size == 0:
                self.matrix = np.empty((self.dense, self.dense + 8))
            dense.extend(self.matrix, self.table, self.scale, self.sites, old, count, self.n)

    @cached_property
    def stencil(self) -> np.ndarray:
        """`half_space.stiffness_between_neighbours` of this half-space."""
        return half_space.stiffness_between_neighbours(self.table)

    @cached_property
    def whole(self) -> grid.Grid:
        """The half-space of all sites."""
        return grid.Grid(self.n, self.length, self.e_star, self.bodies)

    @property
    def _fresh_limit(self) -> float:
        """Limit of a site that has not touched."""
        return self.hardness.pressure(self.site_area) if self.bounded else math.inf

    def attraction(self, separation: float) -> float:
        """Attractive force in nN, negative (eq. 1), at the current separation or before contact.

        The gap is the deformed one at sites whose undeformed gap is small; the others count
        undeformed, through the histogram (`NEAR_CUTOFFS` states the error).
        """
        law = self.adhesion
        if law is None:
            return 0.0
        if self.grid is not None:
            return law.around(
                self.heights, separation, self.grid.field, self.sites, self.place, self.pressure
            )
        raised = self.rise * self.force + 2.0 * law.bin_width
        moved = self.NEAR_DISPLACEMENTS * self.displacement.max(initial=0.0)
        near = max(self.NEAR_CUTOFFS * law.cutoff, moved, raised)
        far, edge = law.far_edge(near, separation)
        wet, wet_edge = law.far_edge(max(near, law.filled.reach + raised), separation)
        if self.force == 0.0 or law.share_before(wet) > self.NEAR_LIQUID:
            wet, wet_edge = far, edge
        self._sort_to(min(wet_edge + law.bin_width, self.highest))
        count = self.heights.size
        if wet < len(law.moments):
            count = int(np.searchsorted(self.order_heights, wet_edge))
        sites = self.order[:count]
        self._rank(count)
        gap = (self.heights[sites] if self.flows else self.order_heights[:count]) + separation
        if self.force > 0.0:
            gap += self._displacement_of(sites)
        around = (self.sites, self.place, self.pressure)
        weight = attracting(count, self.rank, *around, self.n, law.touching)
        return law.deformed(gap, weight, separation, wet)

    def _rank(self, count: int) -> None:
        """Have the places in `order` known of its first sites."""
        if count > self.ranked:
            self.rank[self.order[self.ranked : count]] = np.arange(
                self.ranked, count, dtype=np.int32
            )
            self.ranked = count

    def _displacement_of(self, sites: np.ndarray) -> np.ndarray:
        """Displacement (nm) of the first sites of `order`; where there are many, to some 1e-3 of
        the largest at those that cannot touch.
        """
        exact = min(self.sites.size, sites.size)
        pressed = self.pressure > 0.0
        pressing = int(np.count_nonzero(pressed))
        amounts = (1.0, self.heights.size, sites.size, pressing)
        meshed = self.MESH_COSTS @ amounts
        transformed = self.SINGLE_COSTS @ amounts
        if sites.size * pressing <= min(meshed, transformed):
            displacement = np.zeros(sites.size)
            self._displace(sites[exact:], displacement[exact:])
        else:
            if meshed < transformed:
                mesh = split.afar(self.n, self.length, self.bodies)
                strain = self.pressure[pressed] / self.e_star
                displacement = mesh.displacement(self.sites[pressed], strain, sites, self.rank)
            else:
                pressure = self.pressure.astype(np.float32)
                displacement = self.whole.displacement_by(self.sites, pressure)[sites]
            # a step that is undone leaves further sites known, and shall leave no other trace
            can_touch = np.searchsorted(self.order_heights, self._highest(self.force))
            exact = min(exact, int(can_touch))
        displacement[:exact] = self.displacement[:exact]
        return displacement

    def _displace(self, targets: np.ndarray, displacement: np.ndarray) -> None:
        """Add the displacements (nm) of other sites by the pressures: of many pairs of sites by a
        transform.
        """
        if (
            targets.size * np.count_nonzero(self.pressure)
            > self.TRANSFORM_PAIRS * self.heights.size
        ):
            displacement += self.whole.displacement_by(self.sites, self.pressure)[targets]
            return
        clusters.displace(
            self.table, self.scale, self.n, self.sites, self.pressure, targets, displacement
        )
