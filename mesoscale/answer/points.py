"""The joint distribution of inputs, D0 and devices as points, each with a pad that is pressed there
and its switch.

Nothing is fitted between points. Each pad has a few cells of its own, so their error averages out
over the points as surfaces common to all would not let it. Half of its cells against the other half
tells the error of a point; one that they leave undecided has more cells."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mesoscale.answer.spread import properties_at, with_properties
from mesoscale.contact.surface import shortest_wave
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs, contact_of
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.cells import plan_grid, sample_cells
from mesoscale.pad.curves import PadCells, press_cells
from mesoscale.pad.memory import Flats, PadLaw, flats_of, law_of
from mesoscale.pad.numerics import PAD
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.switch.electrode import presser, release_or_nan_V, solve_deepened
from mesoscale.switch.numerics import SWITCH
from mesoscale.switch.pressing import pressing, pressure_to_compute

Array = NDArray[np.float64]
Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Point:
    """One switch of the joint distribution.

    Attributes
    ----------
    values : inputs by name.
    gap_cutoff_nm : D0 where it is no input.
    device : settings with its own properties.
    """

    values: dict[str, float]
    gap_cutoff_nm: float
    device: DeviceSettings

    def contact_of(self, contact: ContactSettings) -> tuple[ContactInputs, ContactSettings]:
        """Its inputs of a contact, and the settings of the contact with them put in.

        Raises
        ------
        InputError : inputs that the contact does not accept.
        """
        return contact_of(
            self.values, contact.model_copy(update={"gap_cutoff_nm": self.gap_cutoff_nm})
        )


@dataclass(frozen=True)
class Design:
    """Points that fill the joint distribution.

    Attributes
    ----------
    names : of what is drawn, k of them.
    varies : of each of these, whether it is common to all devices, or of each.
    probability : of each at each point, shape (points, k).
    varying : positions of those that do vary.
    """

    names: tuple[str, ...]
    varies: tuple[str, ...]
    probability: Array
    varying: NDArray[np.int_]
    points: tuple[Point, ...]


def cutoff_range(table: InputTable, contact: ContactSettings) -> tuple[float, float]:
    """D0 (nm) of the scene, and the largest that is drawn; the same where D0 is an input."""
    low = contact_of(table.medians(), contact)[1].gap_cutoff_nm
    return low, low if "gap_cutoff" in table.names else max(low, SWITCH.highest_gap_cutoff_nm)


def central_point(table: InputTable, contact: ContactSettings, settings: DeviceSettings) -> Point:
    """The switch at the medians of the inputs and in the middle of the range of D0."""
    return Point(table.medians(), float(np.mean(cutoff_range(table, contact))), settings)


def plan_points(
    table: InputTable, contact: ContactSettings, settings: DeviceSettings, count: int
) -> Design:
    """Points of a Latin hypercube over inputs, D0 and properties of the device."""
    from scipy.stats import qmc  # slow to import

    device, cutoffs = settings.varied, cutoff_range(table, contact)
    names = [*table.names, "gap_cutoff_nm", *device]
    varies = kinds(table, settings)
    units = qmc.LatinHypercube(len(names), rng=0).random(count)
    values = values_at(units, table, settings, cutoffs)
    points = [point_of(row, table.names, settings) for row in values]
    varying = np.flatnonzero(np.ptp(values, axis=0) > 0) if count else np.arange(0)
    return Design(tuple(names), varies, units, varying, tuple(points))


def kinds(table: InputTable, settings: DeviceSettings) -> tuple[str, ...]:
    """Of inputs, D0 and the `varied` properties of the device: common to all devices, or of
    each.
    """
    of_device = [getattr(settings.spread, name).varies for name in settings.varied]
    return (*(row.varies for row in table.rows), "common", *of_device)


def values_at(
    units: Array, table: InputTable, settings: DeviceSettings, cutoffs_nm: tuple[float, float]
) -> Array:
    """Inputs, D0 (nm) and the `varied` properties of the device at probabilities; both of shape (m,
    k).
    """
    inputs, (low, high) = len(table.rows), cutoffs_nm
    return np.column_stack(
        [
            table.transform(units[:, :inputs]),
            low + (high - low) * units[:, inputs],
            properties_at(settings, units[:, inputs + 1 :]),
        ]
    )


def point_of(row: Array, names: Sequence[str], settings: DeviceSettings) -> Point:
    """The switch of a row of `values_at`."""
    inputs = len(names)
    values = dict(zip(names, row[:inputs].tolist(), strict=True))
    return Point(values, float(row[inputs]), with_properties(settings, row[inputs + 1 :]))


def on_pad_grid(contact: ContactSettings, table: InputTable) -> ContactSettings:
    """The contact on the coarsest of its halved grids that still holds all waves of the inputs.

    The release of `reduced` moves by 0.03 V from 128 to 512 sites a side, at a fiftieth of the time
    (docs/pad.md). Without a cut-off the grid itself is one, and stays."""
    if "q1" in table.names:
        shortest = float(table.rows[table.names.index("q1")].distribution.span()[1])
    elif contact.q1_per_nm is not None:
        shortest = shortest_wave(contact)
    else:
        return contact
    while contact.pixels % 2 == 0:
        half = contact.model_copy(update={"pixels": contact.pixels // 2})
        if half.nyquist_per_nm < shortest:
            break
        contact = half
    return contact


@dataclass(frozen=True)
class Pad:
    """A pad that was pressed at a point."""

    cells: PadCells
    flats: Flats

    @property
    def law(self) -> PadLaw:
        """Its curves."""
        return self._law

    @cached_property
    def _law(self) -> PadLaw:
        return law_of(self.cells, self.flats)

    @property
    def halves(self) -> tuple[PadLaw, PadLaw]:
        """The curves of half of its cells, and of the others."""
        return law_of(self.cells.half(), self.flats), law_of(
            self.cells.half(other=True), self.flats
        )


@dataclass(frozen=True)
class Solved:
    """The switch of a point.

    Attributes
    ----------
    pad : None where it cannot be pressed.
    states : pull_in_V, release_V (0: it sticks), capacitance_fF, deepened; empty where it has no
        answer.
    halves_V : release on either half of the cells; NaN where it cannot carry the switch.
    refused : why it has no answer; empty where it has one.
    """

    point: Point
    pad: Pad | None
    states: dict[str, float]
    halves_V: tuple[float, float]
    refused: str = ""

    @property
    def pressed(self) -> Pad:
        """The pad.

        Raises
        ------
        InputError : it cannot be pressed.
        """
        if self.pad is None:
            raise InputError(self.refused)
        return self.pad

    @property
    def outcome(self) -> str:
        """What the switch does, in words."""
        if self.refused:
            return f"no switch: {self.refused}"
        release = self.states["release_V"]
        opens = f"lets go at {release:.3g} V" if release > 0.0 else "sticks"
        return f"the switch closes at {self.states['pull_in_V']:.3g} V and {opens}"

    @property
    def error_V(self) -> float:
        """Estimated standard error of the release by the number of cells."""
        return 0.5 * abs(self.halves_V[0] - self.halves_V[1])

    @property
    def undecided(self) -> bool:
        """Whether more cells are wanted: the halves disagree by much, or on whether the switch
        sticks, or fail.
        """
        if self.refused:
            return False
        disagree = (self.halves_V[0] == 0.0) != (self.halves_V[1] == 0.0)
        enough = max(
            SWITCH.undecided * self.states["pull_in_V"],
            SWITCH.of_release * self.states["release_V"],
        )
        return disagree or not self.error_V <= enough


def press_pad(
    point: Point,
    contact: ContactSettings,
    cells: int,
    first_seed: int,
    *,
    step_nm: float | None = None,
    depths: int = PAD.depths,
    progress: Progress | None = None,
) -> Pad:
    """The pad of a point, closed as hard as its switch presses, and opened.

    Parameters
    ----------
    step_nm, depths : as `plan_grid` takes them.

    Raises
    ------
    InputError : inputs that the contact does not accept, or cells that never reach the pressure.
    """
    inputs, settings = point.contact_of(contact)
    device, area = pressing(point.device), settings.length_nm**2
    sampled = sample_cells(inputs, cells, first_seed, point.device.pad_um2 * 1e6 / area)
    grid = plan_grid(
        inputs, settings, sampled, pressure_to_compute(device), presser(device), step_nm, depths
    )
    return Pad(press_cells(inputs, settings, grid, sampled, progress), flats_of(inputs, settings))


def solve_point(
    point: Point,
    contact: ContactSettings,
    cells: int,
    first_seed: int,
    progress: Progress | None = None,
) -> Solved:
    """The switch of a point on a pad of so many cells; a point without an answer has the reason."""
    pad = None
    try:
        pad = press_pad(point, contact, cells, first_seed, progress=progress)
        states = solve_deepened(point.device, pad.law)
    except InputError as error:
        return Solved(point, pad, {}, (np.nan, np.nan), str(error))
    first, second = (
        release_or_nan_V(point.device, law, SWITCH.coarse_elements) for law in pad.halves
    )
    return Solved(point, pad, states, (first, second))


def surfaces_of(number: int) -> int:
    """First seed of the surfaces of a point; number 0 is the central one."""
    return PAD.first_seed + SWITCH.seeds * number


def solve_points(
    points: Sequence[tuple[int, Point]], contact: ContactSettings, cells: int
) -> Iterator[Solved]:
    """The switches of points, each with its number; one that is undecided has more cells."""
    for number, point in points:
        solved = solve_point(point, contact, cells, surfaces_of(number))
        if solved.undecided:
            solved = solve_point(point, contact, SWITCH.more_cells * cells, surfaces_of(number))
        yield solved


@dataclass(frozen=True)
class PadModel:
    """Everything that was computed of a pad: content of pad/model.h5.

    Attributes
    ----------
    central : the switch at central inputs.
    design : the points, and what is drawn for them.
    points : the switch at each of them.
    """

    central: Solved
    design: Design
    points: tuple[Solved, ...]

    @property
    def solved(self) -> NDArray[np.int_]:
        """Positions of the points that have an answer."""
        return np.flatnonzero([not point.refused for point in self.points])

    @property
    def refused(self) -> list[str]:
        """Why the others have none."""
        return [point.refused for point in self.points if point.refused]

    def states(self, name: str) -> Array:
        """A state of all solved switches, shape (solved,)."""
        return np.array([self.points[k].states[name] for k in self.solved])
