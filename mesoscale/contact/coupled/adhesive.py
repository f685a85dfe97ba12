"""The coupled contact with an attraction that deforms it, and with the jumps that follow.

The stress t on the surface is the pressure p of touching sites less the attraction s(g) of all
sites, and the gap is g = h + d + G t >= 0. Where p > 0 the surfaces touch (g = 0), and t <= H. This
is a minimum of the energy

    E(g) = elastic energy + sum of W(g) a^2, with W' = s.

W is concave, so it lies below its tangent. With s kept from the last gap the energy is a bound on E
that is convex: the repulsive contact under given stresses, which the coupled engine solves. Its
minimum has a lower E than the last gap (a convex-concave procedure, Yuille and Rangarajan,
doi:10.1162/08997660360581958). The iteration therefore ends in a stable state next to the last one.
Where the branch ends it goes on to the next, and the energy between is lost. Anderson's mixing
(doi:10.1145/321296.321305) makes it faster; a mix that raises the energy is left out.
"""

import math
from collections import deque
from typing import NamedTuple

import numpy as np
from numba import njit

from mesoscale.contact.attraction import inverse_cube
from mesoscale.contact.coupled import dense
from mesoscale.contact.coupled.engine import CoupledContact
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.contact.pressed import Row, State
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import advised_grid


class Pulled(NamedTuple):
    """What attraction does at one separation.

    Attributes
    ----------
    pull : (N^2,) attraction of the sites, GPa.
    shift : (N^2,) displacement of the surface by it, nm.
    moved : (N^2,) displacement by all stresses, nm.
    energy : elastic and adhesive, nN nm.
    total : attraction of all sites over the gap that the stresses leave, nN.
    flowing : work against the hardness, part of the energy, nN nm.
    net : force on the flat, nN.
    lost : in jumps so far, nN nm.
    """

    separation: float
    pull: np.ndarray
    shift: np.ndarray
    moved: np.ndarray
    energy: float
    total: float
    flowing: float
    net: float
    lost: float


class AdhesiveContact(CoupledContact):
    """A surface on an elastic half-space that attraction deforms, too, and its stresses at the
    current separation.
    """

    REVERSIBLE = False
    # each step of the iteration solves anew, and needs no other sites for it
    DENSE = 2048
    FORCE_TOLERANCE = 1e-4
    SMALLEST_STEP = 1e-4
    LONGEST_GUESS = math.inf  # but one step is taken at most
    # over the roughness: a step that jumps on the way to a separation is halved down to this
    JUMP_STEP = 3e-3
    STEPS = 500  # of the iteration
    CHANGE = 1e-5  # of the attraction in its last step, over the largest: demanded
    MIXED = 12  # steps that are mixed
    # of D0: pressures that displace no site by more displace only the known ones until the next
    # step. Up to 0.01 no net force of a cycle moves by more than 4e-5 of the pull-off, as at 6e-4
    # (128^2 and 256^2, elastic and plastic)
    UNMOVED = 4e-3
    # of the largest attraction: sites below are not mixed, energies of smaller steps not compared
    MIXED_PULL = 1e-3

    def __init__(
        self,
        surface: np.ndarray,
        inputs: ContactInputs,
        settings: ContactSettings,
        numerics: Numerics = NUMERICS,
    ):
        super().__init__(surface, inputs, settings, numerics)
        self._check_range()
        self.unknown_work = numerics.unknown_work
        law = self.adhesion
        gap = self.heights + self.touching_separation
        # nN nm, roughly
        self.parting = -0.5 * law.cutoff * law.deformed(gap, np.ones_like(gap)) if law else 0.0

    def _check_range(self) -> None:
        """Refuse an attraction that falls off so fast that single sites jump (InputError)."""
        if self.adhesion is None:
            return
        law = self.adhesion
        steepest = 3.0 * self.dispersion / law.cutoff
        # a site that fills must fall by less than the depth of the liquid
        if law.menisci is not None:
            steepest = max(steepest, law.menisci.mean_pull_GPa / law.reach_nm)
        if steepest > self.stiffness:
            pixels = int(np.ceil(self.n * steepest / self.stiffness))
            raise InputError(
                f"contact.mechanics = adhesive: the attraction changes by {steepest:.3g} GPa per"
                f" nm, the grid resolves {self.stiffness:.3g} GPa per nm; take"
                f" {advised_grid(pixels)}a larger contact.gap_cutoff_nm, or mechanics: coupled"
            )

    def _forget(self) -> None:
        super()._forget()
        nothing = np.zeros(self.heights.size, np.float32)
        self.now = self.last = Pulled(math.inf, nothing, nothing, nothing, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.saved = (self.now, self.last)
        self.highest_shift = 0.0  # of the surface by its attraction, nm
        self.undone: Pulled | None = None  # the state of the last step back, where nothing touched

    @property
    def dispersion(self) -> float:
        """Attraction of touching sites across air, GPa."""
        law = self.adhesion
        return (
            self.hamaker / (6.0 * np.pi) * float(inverse_cube(law.cutoff, law.rate)) if law else 0.0
        )

    @property
    def strongest(self) -> float:
        """Attraction of touching sites, GPa."""
        share, laplace = self.liquid_law
        return share * self.dispersion + laplace

    @property
    def liquid_law(self) -> tuple[float, float]:
        """Share of the dispersion that is left across the liquid, and its pull from touch to its
        end, GPa; (1, 0): dry. Sites would not come to rest on the step where films meet.
        """
        menisci = self.adhesion.menisci if self.adhesion else None
        return (menisci.dispersion, menisci.mean_pull_GPa) if menisci else (1.0, 0.0)

    def back(self) -> None:
        """Undo the last move, its flow and its stresses."""
        self.undone = None if self.pressure.any() else self.now
        super().back()
        self.now, self.last = self.saved
        self.displacement = self.now.moved[self.sites].astype(float)

    def move_to(self, separation: float, with_flow: bool) -> State:
        """Bring the flat to a separation; it may be undone by `back` until the next move."""
        self.saved = (self.now, self.last)
        if not (with_flow or self.capped):
            self.limit = np.full(self.limit.size, math.inf)
            self.mean = float(self.heights.mean())
        state = super().move_to(separation, with_flow)
        if state.force < math.inf:
            self._balance(with_flow)
        return state

    def _balance(self, with_flow: bool) -> None:
        """Energy that a step has lost in jumps; what flow takes up is no longer stored."""
        self.now = self.now._replace(net=self.force + self.attraction(self.separation))
        loss, smooth = self._loss(with_flow)
        lost = self.saved[0].lost + (loss if loss > smooth else 0.0)
        self.now = self.now._replace(
            lost=lost, energy=self.now.energy - (self.now.flowing if with_flow else 0.0)
        )

    def _loss(self, with_flow: bool) -> tuple[float, float]:
        """What the energy fell by in the last step beyond the work of its mean force, and how much
        a jump exceeds.

        Both nN nm. Up to a third of abs(F2 - F1) step / 2 may be the curvature of F (a parabola),
        with either sign; beyond half of it the contact has jumped. Flow loses energy by itself, so
        steps that flow tell nothing.
        """
        was = self.saved[0]
        now = self.now
        step = now.separation - was.separation
        if not math.isfinite(step) or (with_flow and now.flowing > 0.0):
            return 0.0, 0.0
        loss = was.energy - now.energy - 0.5 * (was.net + now.net) * step
        return loss, 0.25 * abs((now.net - was.net) * step)

    def _expect(self, separation: float) -> None:
        """Take the attraction, too, and the displacement by all stresses, or those on the way to an
        undone state.
        """
        super()._expect(separation)
        now = self.now
        other = self.last
        share = self._share(separation)
        if self.undone is not None and (towards := self._undone_share(separation)):
            other = self.undone
            share = -towards
        pull = now.pull - other.pull
        moved = now.moved - other.moved
        for change, start in ((pull, now.pull), (moved, now.moved)):
            change *= share
            change += start
        self.last = now
        self.now = now._replace(separation=separation, pull=pull, moved=moved)

    def _share(self, separation: float) -> float:
        return 0.0 if self._undone_share(separation) else min(super()._share(separation), 1.0)

    def _undone_share(self, separation: float) -> float:
        """How far a separation is on the way to an undone state; 0 where there is none, or sites
        touch.
        """
        if self.undone is None or self.before.pressure.any():
            return 0.0
        full_step_nm = self.undone.separation - self.now.separation
        share = (separation - self.now.separation) / (full_step_nm or math.inf)
        return share if 0.0 < share <= 1.0 else 0.0

    @property
    def lost(self) -> float:
        """Energy lost in jumps so far, nN nm."""
        return self.now.lost

    def away(self, separation: float) -> Row:
        """The contact at a separation, where attraction may close it; on the way down it flows."""
        moved = self.move_to(separation, self.flows and separation < self.separation)
        self.unsettled += not moved.settled
        return moved.row(separation, self.attraction(separation))

    def way(self, separation: float) -> list[Row]:
        """The same, in steps whose work is known to `Numerics.unknown_work`, and a jump as far as
        the forces beside it.

        A peak of the force, or a jump amid a step, can leave just the loss that a smooth force has:
        then only the change of the force tells that the step is too long.
        """
        start, unsettled = self.separation, self.unsettled
        row = self.away(separation)
        unknown = max(map(abs, self._loss(self.flows and separation < start)))
        if (
            unknown > self.unknown_work * self.parting
            and abs(separation - start) > self.JUMP_STEP * self.rms
        ):
            self.back()
            self.unsettled = unsettled
            return self.way(0.5 * (start + separation)) + self.way(separation)
        return [row]

    def opened(self, separations: np.ndarray) -> np.ndarray:
        """Repulsion and attraction (nN) on the way back over separations of a closing, shape (2,
        n).

        The last separation is the present one; the contact is as before afterwards.
        """
        saved = self._kept(), (self.now, self.last)
        rows = [self.away(separation) for separation in separations[::-1].tolist()]
        self.before, self.saved = saved
        self.back()
        return np.array([(row.force, row.attraction) for row in rows[::-1]]).T

    @property
    def force(self) -> float:
        """Force of the compressive stresses, nN."""
        return float(np.maximum(self._traction(), 0.0).sum()) * self.site_area

    def attraction(self, separation: float) -> float:
        """Force of the tensile stresses in nN, negative, at the current separation."""
        return self._pressed - self.now.total - self.force

    def fields(self) -> tuple[np.ndarray, np.ndarray]:
        """Stress (GPa, compression positive) and gap (nm) of all sites, shapes (N, N)."""
        shape = (self.n, self.n)
        gap = np.maximum(self.heights + self.separation + self.now.moved, 0.0)
        return (self.whole.spread(self.sites, self.pressure) - self.now.pull).reshape(
            shape
        ), gap.reshape(shape)

    def filled_share(self, separation: float) -> float:
        """Share of the cell that liquid fills at the current separation."""
        reach = self.adhesion.reach_nm if self.adhesion else 0.0
        return float(np.mean(np.maximum(self.heights + separation + self.now.moved, 0.0) < reach))

    def _bent(self, stress: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Displacement (nm) by stresses (GPa), changed in place by what is added to the known
        sites.
        """
        stress[self.sites] += change
        return self.whole.displacement(stress) if stress.any() else stress

    def _traction(self) -> np.ndarray:
        return self.pressure - self.now.pull[self.sites]

    def _bounds(self) -> np.ndarray:
        return self.limit + self.now.pull[self.sites]

    def _open_gap(self) -> np.ndarray:
        return super()._open_gap() + self.now.shift[self.sites]

    def _highest(self, force: float) -> float:
        return super()._highest(force) + self.highest_shift

    def _solve(self, coarser: float = 1.0) -> bool:
        return self._solve_rounds()[1]

    def _solve_rounds(self) -> tuple[int, bool]:
        """Find the stresses; each step of the iteration is a round of hardness, too, until the
        clusters keep theirs.

        The displacement follows from the pressures before and the attraction at hand. What the new
        pressures add is known at the known sites; elsewhere a transform adds it unless it is small.
        """
        law, strongest = self.adhesion, self.strongest
        changes = (self.CHANGE * strongest, self.MIXED_PULL * strongest)
        wanted = safe = self.now.pull
        moved = self.now.moved
        before = self._moved_by_pressure()
        mixed = np.empty(0, int)
        reached = np.zeros(self.heights.size, np.float32)
        steps: deque[tuple[np.ndarray, np.ndarray]] = deque(maxlen=self.MIXED)
        lowest, settled, some, many, rounds = math.inf, False, 0, 0, 1
        for _ in range(self.STEPS):
            pressure = self.pressure.copy()
            sites = self.sites
            shift = moved.copy()
            shift[sites] -= before
            self.now = self.now._replace(pull=wanted, shift=shift)
            self.highest_shift = -float(shift.min())
            settled = super()._solve()
            if self.sites is not sites:  # more can touch: once more, with what moves them
                moved = self._bent(np.negative(wanted, dtype=np.float32), self.pressure)
                before = self.displacement.copy()
                continue
            if (
                np.abs(self.displacement - before).max(initial=0.0)
                > self.UNMOVED * self.settings.gap_cutoff_nm
            ):
                moved += self._bent(np.zeros(moved.size, np.float32), self.pressure - pressure)
            before = self.displacement.copy()
            moved[sites] = shift[sites] + before
            energy = 0.5 * float(self.pressure @ moved[self.sites])
            total = 0.0
            some = 0
            many = 0
            if law is not None:
                walls = (law.least, law.offset, law.rate, law.reach_nm)
                reached = np.empty_like(reached)
                law_of = (self.hamaker, walls, self.liquid_law)
                gained, total, some, many = attract(
                    self.heights, self.separation, moved, wanted, *law_of, changes, reached
                )
                energy += gained
            yielding = self.pressure >= self._bounds()
            overlap = -(self.heights[self.sites] + self.separation + moved[self.sites])[yielding]
            flowing = float(self.limit[yielding] @ overlap)
            energy += flowing + strongest * float(overlap.sum())
            self.now = self.now._replace(
                moved=moved,
                energy=energy * self.site_area,
                flowing=flowing * self.site_area,
                total=total * self.site_area,
            )
            if self.bounded and rounds < self.ROUNDS and self._hardens(rounds):
                rounds = rounds + 1
                lowest = math.inf
            elif not some:
                break
            if wanted is not safe and energy > lowest and many:
                steps.clear()  # a mix that leads astray
                wanted = safe
            else:
                if not steps:
                    mixed = np.flatnonzero(reached > changes[1])
                steps.append((wanted[mixed].astype(float), reached[mixed].astype(float)))
                lowest, wanted = energy, reached
                safe = reached
                if len(steps) > 1:
                    wanted = reached.copy()
                    wanted[mixed] = np.clip(mix(steps), 0.0, strongest)
            moved = self._bent(np.negative(wanted, dtype=np.float32), self.pressure)
        self.displacement = self.now.moved[self.sites].astype(float)
        return rounds, settled and not some and rounds < self.ROUNDS

    def _moved_by_pressure(self) -> np.ndarray:
        """Displacement (nm) of the known sites by the first guess of the pressures."""
        self._know(self._pressed)
        if self.grid is None:
            dense.multiply(self.matrix, self.sites.size, self.pressure, self.displacement)
        return self.displacement.copy()


def mix(steps: deque[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """Where the iteration tends to, from its last steps, pairs of what went in and what came out,
    shape (sites,).
    """
    start, end = (np.array(arrays) for arrays in zip(*steps, strict=True))
    change = end - start
    shares = np.linalg.lstsq(np.diff(change, axis=0).T, change[-1], rcond=1e-8)[0]
    return end[-1] - shares @ np.diff(end, axis=0)


@njit(cache=True, fastmath=dense.FAST, error_model="numpy")
def attract(heights, separation, moved, pull, hamaker, walls, liquid, changes, reached):
    """Attraction (GPa) of the sites of a deformed surface, into `reached`.

    The energy of flats s apart is -A_H / (12 pi s^2 (1 + c s)); within the least distance the
    attraction is constant. Gaps below `reach` hold liquid: a share of that attraction, and a
    pressure (`liquid`).

    Returns
    -------
    Elastic and adhesive energy of the attraction, nN/nm, the sum of `reached`, GPa, and how many
    sites change by more than each of two `changes` from `pull`.
    """
    strength, (least, offset, rate, reach) = hamaker / (6.0 * np.pi), walls
    (share, laplace), outer = liquid, max(reach, least) + offset
    edge = 0.5 * strength / (outer * outer * (1.0 + rate * outer))
    edge += strength * inverse_cube(outer, rate) * max(least - reach, 0.0)
    energy, total, some, many = 0.0, 0.0, 0, 0
    for k in range(moved.size):  # without branches, so that it runs in parallel lanes
        gap = heights[k] + separation + moved[k]
        apart = max(gap, least) + offset
        late = 1.0 / (1.0 + rate * apart)
        parting = 0.5 * strength * late / (apart * apart)
        force = 2.0 * parting / apart * (1.0 + 1.5 * rate * apart) * late
        parting += force * max(least - gap, 0.0)
        wet = gap < reach
        reached[k] = share * force + laplace if wet else force
        energy -= (
            share * parting + (1.0 - share) * edge + laplace * (reach - gap) if wet else parting
        )
        energy -= 0.5 * pull[k] * moved[k]
        total += reached[k]
        some += abs(reached[k] - pull[k]) > changes[0]
        many += abs(reached[k] - pull[k]) > changes[1]
    return energy, total, some, many
